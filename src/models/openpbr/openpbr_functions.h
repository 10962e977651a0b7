// Surfaces as any kind of model: the functions of a `Model` (model.h).
#pragma once
#include <cstddef>
#include <span>

#include "srbf/models/openpbr.h"

SRBF_BEGIN

void evaluate(const OpenPbrModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
inline bool is_isotropic(const OpenPbrModel& model) { return model.specular_roughness_anisotropy == 0; }
inline void exchange(OpenPbrModel& model) { model.is_exchanged = !model.is_exchanged; }
std::size_t payload_bytes(const OpenPbrModel& model);
constexpr std::size_t auxiliary_bytes(const OpenPbrModel&) { return 0; }
OpenPbrModel rounded(const OpenPbrModel& model);

SRBF_END
