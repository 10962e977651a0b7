// The functions of srbf that srbf_pbrt.h needs, in plain types: for C++17, in which pbrt-v4 is compiled, and for C++20.
#pragma once
#include <string>

namespace srbf_plain {

/// A model or a measurement, ready for a renderer. It is never freed, as pbrt's own measured BRDFs.
struct Brdf;
/// Null if the file cannot be read; `error` then says why in one line. `exchanged` exchanges light and viewer. It takes
/// about 100 ms of processor time, and for an anisotropic model 400 ms. A file that was opened before, by the same name
/// and with the same `exchanged`, is not read again. Any number of threads may call it; one file is prepared at a time.
const Brdf* open(const std::string& file, bool exchanged, std::string& error);

// Unit vectors in the local frame: wl points to the light, wv to the viewer. Any number of threads may call these.

/// f_r [1/sr] in linear sRGB, without the cosine; 0 where a measurement has no value.
void value(const Brdf& brdf, const float wl[3], const float wv[3], float f[3]);
/// Samples wl and f from numbers in [0, 1), and returns the density [1/sr]: 0 if the sample has no direction.
float sample(const Brdf& brdf, const float wv[3], float uc, const float u[2], float wl[3], float f[3]);
float pdf(const Brdf& brdf, const float wl[3], const float wv[3]);
/// The albedo of a view, green.
float albedo(const Brdf& brdf, float cos_v);

}  // namespace srbf_plain
