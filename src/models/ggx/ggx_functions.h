// Lambert and GGX as any kind of model: the functions of a `Model` (model.h).
#pragma once
#include <cstddef>
#include <span>

#include "srbf/models/ggx.h"

SRBF_BEGIN

void evaluate(const GgxModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
inline bool is_isotropic(const GgxModel&) { return true; }
inline void exchange(GgxModel&) {}  // reciprocal
inline std::size_t payload_bytes(const GgxModel& model) { return 2 * (3 + 5 * model.lobes.size()); }
constexpr std::size_t auxiliary_bytes(const GgxModel&) { return 0; }
GgxModel rounded(const GgxModel& model);

SRBF_END
