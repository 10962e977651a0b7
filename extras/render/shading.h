// shading.glsl as C++.
#pragma once
#include "srbf/kernel.h"
#include "srbf/vec.h"

namespace SRBF_NAMESPACE {
namespace kernel {

template <Number Real> inline Real pow(Real x, Real y) { return std::pow(x, y); }

template <typename Real_> struct ShadingFormulas {
    using Real = Real_;
    using Vec3 = Triple<Real_>;
    using Bool = bool;
#define SRBF_FN static
#include "extras/render/shading.glsl"
#undef SRBF_FN
};

}  // namespace kernel

/// The functions of shading.glsl as static members.
template <typename Real> using Shading = kernel::ShadingFormulas<Real>;

}  // namespace
