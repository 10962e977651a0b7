// A model of reflection and transmission, front and back.
#pragma once
#include <cstddef>
#include <span>

#include "srbf/bsdf.h"

namespace [[gnu::visibility("default")]] srbf {

struct Model;

/// A BSDF: a model for each part, in the frame of that part (bsdf.h), none of them a BSDF itself, and its beams.
struct BsdfModel {
    Parts<Model> part;
    Beams beam;
};
/// f(wl, wv) on either side, without the beams.
Rgb value(const BsdfModel& model, Vec3f wl, Vec3f wv);
/// f[i] = value(model, wl[i], wv[i]), see `evaluate` of a `Model` (model.h).
void evaluate(const BsdfModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);

/// Isotropy, and the exchange of light and viewer, as of a `Model` (model.h).
bool is_isotropic(const BsdfModel& model);
void exchange(BsdfModel& model);

std::size_t payload_bytes(const BsdfModel& model);
std::size_t payload_bytes(const Beam& beam);
std::size_t auxiliary_bytes(const BsdfModel& model);

}  // namespace srbf
