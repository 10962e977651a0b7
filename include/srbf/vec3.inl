// Vec3 and its operators, without include guard. vec.h includes them in namespace srbf; SIMD code includes them once
// per instruction set, since a template defined outside of a target's region cannot be inlined into it.

/// A vector of three components, named as in GLSL. `Real` is float, double, or any type with their arithmetic (a SIMD
/// batch, a dual number).
template <typename Real> struct Vec3 {
    Real x, y, z;
    constexpr Vec3() : x(), y(), z() {}  // not defaulted, so that it belongs to the SIMD target
    constexpr Vec3(Real x_, Real y_, Real z_) : x(x_), y(y_), z(z_) {}
};

template <typename Real> constexpr Vec3<Real> operator+(Vec3<Real> a, Vec3<Real> b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename Real> constexpr Vec3<Real> operator-(Vec3<Real> a, Vec3<Real> b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename Real> constexpr Vec3<Real> operator*(Real s, Vec3<Real> a) { return {s * a.x, s * a.y, s * a.z}; }
template <typename Real> constexpr Real dot(Vec3<Real> a, Vec3<Real> b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <typename Real> constexpr Vec3<Real> cross(Vec3<Real> a, Vec3<Real> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename Real> Vec3<Real> normalize(Vec3<Real> a) {
    using std::sqrt;
    return (Real(1) / sqrt(dot(a, a))) * a;
}
