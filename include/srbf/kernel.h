// kernel.glsl as C++, for example `Kernel<float>::gaussian(...)`.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "srbf/elementary.h"
#include "srbf/vec.h"

SRBF_BEGIN

struct PmModel;
struct SuModel;

namespace kernel {

// The built-in functions of GLSL that kernel.glsl uses, for floating-point numbers. Other number types (in tests, in
// SIMD code) provide their own, found by argument-dependent lookup.
template <typename Real>
concept Number = std::is_floating_point_v<Real>;
template <Number Real> inline Real exp(Real x) { return elementary::exp(x); }
template <Number Real> inline Real exp2(Real x) { return elementary::exp2(x); }
template <Number Real> inline Real log(Real x) { return elementary::log(x); }
template <Number Real> inline Real sqrt(Real x) { return std::sqrt(x); }
template <Number Real> inline Real inversesqrt(Real x) { return 1 / std::sqrt(x); }
template <Number Real> inline Real cos(Real x) { return elementary::cos(x); }
template <Number Real> inline Real sin(Real x) { return elementary::sin(x); }
template <Number Real> inline Real min(Real a, Real b) { return std::min(a, b); }
template <Number Real> inline Real max(Real a, Real b) { return std::max(a, b); }
template <Number Real> inline Real select(bool condition, Real a, Real b) { return condition ? a : b; }

template <typename Real> using Triple = srbf::Vec3<Real>;
#include "srbf/kernel/host.inl"

}  // namespace kernel

/// The functions of kernel.glsl as static members, for Real = float, double or any type with their arithmetic.
template <typename Real> using Kernel = kernel::Formulas<Real, PmModel>;

SRBF_END
