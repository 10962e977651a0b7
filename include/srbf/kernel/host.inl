// kernel.glsl as the body of a struct, without an include guard. kernel.h includes it once for plain numbers, and
// SIMD code once per instruction set. `Triple<Real>` is the Vec3 of the including namespace.
#ifndef SRBF_FN
#define SRBF_FN static
#endif
template <typename Real_, typename Model, typename ByView = SuModel> struct Formulas {
    using Real = Real_;
    using Vec3 = Triple<Real_>;
    using Bool = decltype(Real_() < Real_());
    using Pm = const Model&;

    // Exponents of a PmModel are to base e; these functions convert them. Any other model type provides the numbers
    // that kernel.glsl expects under the same names without the prefix pm_.
    static constexpr bool is_plain = std::is_same_v<Model, PmModel>;
    static constexpr double k_bits = 1.4426950408889634;
    static std::size_t place(Pm pm, int j, int n) { return std::size_t(j * pm.variates + n); }

    static int pm_lobes(Pm pm) { return pm.lobes; }
    static int pm_variates(Pm pm) { return pm.variates; }
    static int pm_features(Pm pm) { return features(pm.form); }
    static bool pm_axial(Pm pm) { return pm.axial; }
    static constexpr bool pm_reciprocal(Pm pm) {
        if constexpr (requires { Model::is_reciprocal; })
            return Model::is_reciprocal;
        else
            return is_reciprocal(pm.form);
    }
    static auto pm_weight_l(Pm pm, int n) {
        if constexpr (is_plain)
            return pm.parameterization[std::size_t(n)].a;
        else
            return pm.weight_l(n);
    }
    static auto pm_weight_v(Pm pm, int n) {
        if constexpr (is_plain)
            return pm.parameterization[std::size_t(n)].b;
        else
            return pm.weight_v(n);
    }
    static auto pm_log2_scale(Pm pm, int j) {
        if constexpr (is_plain)
            return k_bits * double(pm.log_scale[std::size_t(j)]);
        else
            return pm.log2_scale(j);
    }
    static auto pm_log2_falloff(Pm pm, int j, int n) {
        if constexpr (is_plain)
            return 0.5 * k_bits * double(pm.bandwidth[place(pm, j, n)]);
        else
            return pm.log2_falloff(j, n);
    }
    static auto pm_exponent(Pm pm, int j, int k) {
        if constexpr (is_plain)
            return k_bits * double(pm.exponent[std::size_t(j * pm_features(pm) + k)]);
        else
            return pm.exponent(j, k);
    }
    static bool pm_down(Pm pm, int j, int n) {
        if constexpr (is_plain)
            return pm.centre[place(pm, j, n)].z < 0;
        else
            return pm.down(j, n);
    }
    static Vec3 pm_centre(Pm pm, int j, int n) {
        if constexpr (is_plain)
            return triple(pm.centre[place(pm, j, n)]);
        else
            return triple(pm.centre(j, n));
    }
    static Vec3 pm_coefficient(Pm pm, int j) {
        if constexpr (is_plain) {
            const auto& coefficient = pm.coefficient[std::size_t(j)];
            return Vec3(Real(coefficient.r), Real(coefficient.g), Real(coefficient.b));
        } else {
            return triple(pm.coefficient(j));
        }
    }

    using Su = const ByView&;
    using SuNearest = const std::array<std::uint16_t, 8>&;

    static int su_lobes(Su su) { return su.lobes; }
    static int su_views(Su su) { return int(su.direction.size()); }
    static Vec3 su_direction(Su su, int view) { return triple(su.direction[std::size_t(view)]); }
    static Vec3 su_centre(Su su, int view, int j) { return triple(su.centre[std::size_t(view * su.lobes + j)]); }
    static float su_bandwidth(Su su, int view, int j) { return su.bandwidth[std::size_t(view * su.lobes + j)]; }
    static Vec3 su_coefficient(Su su, int view, int j) {
        const auto& coefficient = su.coefficient[std::size_t(view * su.lobes + j)];
        return Vec3(Real(coefficient.r), Real(coefficient.g), Real(coefficient.b));
    }
    static int su_nearest(SuNearest nearest, int k) { return nearest[std::size_t(k)]; }

    template <typename Vector> static Vec3 triple(const Vector& w) { return Vec3(Real(w.x), Real(w.y), Real(w.z)); }

#include "srbf/kernel.glsl"
};
#undef SRBF_FN
