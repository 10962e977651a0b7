// The functions of a `Model` (model.h) for BSDFs: values for directions on either side, without the beams.
#pragma once
#include "srbf/model.h"

SRBF_BEGIN

void evaluate(const BsdfModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
bool is_isotropic(const BsdfModel& model);
void exchange(BsdfModel& model);
std::size_t payload_bytes(const BsdfModel& model);
std::size_t payload_bytes(const Beam& beam);
std::size_t auxiliary_bytes(const BsdfModel& model);

SRBF_END
