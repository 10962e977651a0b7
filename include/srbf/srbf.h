// The core on one page: load, fit, prepare, value, sample, pdf, albedo, save, export. The other headers declare the
// details: fit.h requests and errors of fits, model.h and measured.h the data, prepared.h BRDFs of your own.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "srbf/handles.h"
#include "srbf/result.h"
#include "srbf/vec.h"

SRBF_BEGIN

// Two types hold the arguments and results of functions: a LoadedBrdf is a measurement or a fitted model, as it was
// read, and a PreparedBrdf is a BRDF ready for a renderer. Copies of either share their content, which `content` of
// load.h returns for a LoadedBrdf. Both may be members that are assigned later. Until then a PreparedBrdf is black,
// with the density 0, and a LoadedBrdf has no content: a function that reads it ends the program with a line and
// abort().

// ---- Files ----

/// Reads a measurement of any format or a model file, recognised by its content. Returns an error if the file is
/// unreadable, of no known format or malformed.
Result<LoadedBrdf> load(const std::string& path);
/// f(wv, wl) in place of f(wl, wv). The `measured` of pbrt and of Mitsuba takes the first direction of an RGL file for
/// the viewer, and so agrees with the exchanged file.
LoadedBrdf exchanged(const LoadedBrdf& brdf);

/// A model with its size and its error.
struct FittedBrdf {
    LoadedBrdf model;
    std::size_t bytes = 0;  ///< size of the model's numbers in bytes, without the file's header
    double delta_e = 0;     ///< mean ΔE_ITP of pictures of a sphere against the measurement; 1 is just noticeable
};
/// Fits the model that `srbf fit` fits without options, in about three seconds on two cores, half of them for the
/// error. The `fit` of fit.h takes options: the size of the model, the objective, threads, progress and others. Returns
/// an error if `measured` is a model or a two-sided measurement, or has no value above 0.
Result<FittedBrdf> fit(const LoadedBrdf& measured);

/// Writes a model file, or leaves the previous file. Returns an error if `model` is a measurement, or if the file
/// cannot be written.
Result<Done> save(const LoadedBrdf& model, const std::string& path);

/// The functions of a model in "glsl", "hlsl", "wgsl", "msl" or "c": a text that stands alone, with NAME_brdf(wl, wv)
/// for an identifier `name`. A program that calls it also links srbf::shader. Returns an error if `model` is a
/// measurement, or if there is no such language.
Result<std::string> shading_code(const LoadedBrdf& model, const std::string& name, std::string_view language);

// ---- Evaluation and sampling ----

// Directions are unit vectors in the local frame, which debug builds assert, and point away from the surface: wl to the
// light, wv to the viewer. The frame's +z axis is the shading normal. Its +x axis matters to anisotropic BRDFs alone:
// it is the tangent from which their data count azimuths. Colours are linear sRGB. Several threads may call all
// functions of a PreparedBrdf at once, and no result depends on whether the processor flushes subnormal numbers to 0.
// prepared.h prepares any other BRDF, too.

/// A sampled direction to the light.
struct LightSample {
    Vec3f wl;    ///< unit vector with wl.z > 0 if pdf > 0; otherwise there is no direction, and wl must not be used
    Rgb weight;  ///< f cosθl / pdf, or 0 where pdf is 0 or f is NaN: its mean over samples is the directional albedo
    float pdf = 0;  ///< [1/sr]; 0: the sample has no direction, and counts with the weight 0
};

/// Prepares a model or a measurement, and the front alone of a surface with two sides. Also computes a density to
/// sample by, in about 50 ms of processor time for an isotropic model and 400 ms for an anisotropic one. `threads`:
/// number of threads; 0: all of the machine, which is also the most. The result does not depend on it. `prepare` of
/// prepared.h takes results of load_model and load_measured, and further options.
PreparedBrdf prepare(const LoadedBrdf& brdf, int threads = 0);

/// f_r(wl, wv) [1/sr], without the cosine. For a model it differs from `value` of model.h, which reports and files use,
/// by at most 1e-4 of that value or 1e-6 of its peak, whichever is larger. It is never negative, and 0 if wl.z or wv.z
/// is 0, negative or subnormal. It is NaN in all three channels where a measurement has no value, which a renderer must
/// take for 0; `sample`, `pdf` and `albedo` count it as 0.
inline Rgb value(const PreparedBrdf& brdf, const Vec3f& wl, const Vec3f& wv) { return brdf.at(wl, wv); }
/// f_r at pairs of directions. The program ends with a line and abort() if the spans differ in length.
void evaluate(const PreparedBrdf& brdf, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);

/// Samples a direction to the light from independent numbers, uniform in [0,1): a point u, which may be stratified, and
/// the selector of a lobe. The `pdf` of the result is 0 if wv.z ≤ 0, and if the sample has no direction. Otherwise it
/// equals `pdf(brdf, wl, wv)` in every bit, and `weight` is `value(brdf, wl, wv)` wl.z / pdf up to two roundings, which
/// are at most 1.2e-7 of it.
LightSample sample(const PreparedBrdf& brdf, Vec3f wv, Vec2f u, float selector);
/// The density of `sample` [1/sr]: 0 if wl.z ≤ 0 or wv.z ≤ 0.
float pdf(const PreparedBrdf& brdf, Vec3f wl, Vec3f wv);
/// The results of `value` and `pdf` for a pair, as multiple importance sampling needs them, in the time of both calls.
struct ValuePdf {
    Rgb value;      ///< f_r [1/sr], or NaN where a measurement has no value, as `value` returns
    float pdf = 0;  ///< [1/sr]
};
ValuePdf value_pdf(const PreparedBrdf& brdf, const Vec3f& wl, const Vec3f& wv);

/// Directional albedo ∫ f(wl, wv) cosθl dωl for cosθv in (0, 1], averaged over azimuths. For a view-by-view model with
/// sampled views it is interpolated, as the model is, from the integrals of the lobes: within 1 % or 0.002. For any
/// other BRDF it is interpolated between 129 view angles: up to 85° within 1 % or 0.002 for fits of measured materials
/// and tables, with larger errors beyond, for narrow highlights and for scattered samples (docs/sampling.md). The first
/// call computes these angles in about 0.3 s, and other threads that call `albedo` wait for it. A cosine of 0, below it
/// or NaN gives 0; above 1 counts as 1.
Rgb albedo(const PreparedBrdf& brdf, float cos_v);

SRBF_END
