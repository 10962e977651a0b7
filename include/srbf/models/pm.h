// The parameterized multivariate model.
#pragma once
#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/models/exponent_terms.h"

SRBF_BEGIN

/// The parameterization of a variate, ψ(wl, wv) = normalize(a wl + b wv), with (a, b) finite and not (0, 0).
struct Parameterization {
    float a = 1, b = 1;
    friend bool operator==(const Parameterization&, const Parameterization&) = default;
};

/// Parameterized multivariate SRBFs (Tsai 2009, section 7.2), with the further terms κ_jk x_k of exponent_terms.h:
///   g(wl,wv) = Σ_j β_j e^{s_j} Π_n G(ψ_n(wl,wv)·ξ_jn | λ_jn) Π_k e^{κ_jk x_k(wl,wv)} [1/sr],
///   ρ(wl,wv) = g(wl,wv), or (g(wl,wv) + g(wv,wl)) / 2 in the form reciprocal.
/// Evaluated by `pm_value` of kernel.glsl. The members hold the symbols of the formula; `write_model` describes the
/// file encoding. A spectral model has β_j at C wavelengths; its R, G, B follow from these (brdf/colour.h). One of them
/// may be negative; ρ is 0 where the sum is.
struct PmModel {
    PmForm form = PmForm::gaussian;
    bool axial = true;                               ///< every centre is +z or −z, for isotropic data
    int lobes = 0;                                   ///< J, 1..k_max_lobes
    int variates = 0;                                ///< N, 1..k_max_variates
    std::vector<Rgb> coefficient;                    ///< J: β_j ≥ 0; in a spectral model the colours of its spectra
    std::vector<float> wavelength;                   ///< C [nm], increasing, of a spectral model; otherwise empty
    std::vector<float> spectrum;                     ///< J × C: β_j ≥ 0 at the wavelengths
    std::vector<float> log_scale;                    ///< J: s_j; stored only if one of them is not 0
    std::vector<Vec3f> centre;                       ///< J × N: ξ_jn, unit vectors
    std::vector<float> bandwidth;                    ///< J × N: λ_jn ≥ 0
    std::vector<Parameterization> parameterization;  ///< N
    std::vector<float> exponent;                     ///< J × F: κ_jk
    friend bool operator==(const PmModel&, const PmModel&) = default;
};
inline constexpr int k_max_lobes = 1024;
inline constexpr int k_max_variates = 8;
inline constexpr int k_max_fitted_lobes = 64;
/// Bounds of the length of a search as a multiple of the default.
inline constexpr double k_min_effort = 0.01, k_max_effort = 50;
inline constexpr std::size_t k_max_wavelengths = 4096;

/// J, the number of lobes of a multivariate model, 1..k_max_fitted_lobes.
struct LobeCount {
    int lobes = row_of(k_default_form).lobes;
};
/// Chooses J. For a table it is the first of 2, 3, 4, 6, 9, 12, 16 and 24 for which pictures of a sphere have at most
/// this mean ΔE_ITP (metrics.h) against the fitted function, or else 24. For samples it is the fewest of 2 to 12 lobes
/// whose cross-validated error is within 3 % of the least, or, if their gaps are filled, the most that the samples
/// determine.
struct AutomaticLobes {
    std::optional<double> delta_e = {};  ///< (0, 100], of a table; none: k_default_delta_e
};
inline constexpr double k_default_delta_e = 2;
using PmSize = std::variant<LobeCount, AutomaticLobes>;

/// A parameterized multivariate model (PM).
struct PmRequest {
    using Model = PmModel;
    static constexpr std::string_view k_name = "pm";
    static constexpr std::string_view k_about = "parameterized multivariate SRBFs, one sum of lobes for the whole BRDF";
    /// The form of a lobe. If it is not set, a table is fitted by `reciprocal`, and samples, light that passes through
    /// a surface and patches of directions by `extended`. A reciprocal form is fitted to the mean of the signals that
    /// reached the instrument, (cosθv f(ωl, ωv) + cosθl f(ωv, ωl)) / (cosθv + cosθl).
    std::optional<PmForm> form = {};
    std::optional<int> variates = {};  ///< N, 1..k_max_variates; none: `FormRow::variates`
    std::optional<PmSize> size = {};   ///< none: `FormRow::lobes` for a table, automatic for samples
    std::optional<bool> axial = {};    ///< none: axial if the measurement is isotropic
    /// Limit on the directional albedo of a channel; infinity: there is none. None: 1 in a reciprocal form, infinity in
    /// others.
    std::optional<double> albedo_limit = {};
    /// The length of the search for lobes as a multiple of the default, k_min_effort..k_max_effort.
    double effort = 1;
};

/// ρ(wl, wv) in single precision; 0 below the horizon.
Rgb value(const PmModel& model, Vec3f wl, Vec3f wv);

/// f[i] = value(model, wl[i], wv[i]), see `evaluate` of a `Model` (model.h).
void evaluate(const PmModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// `model` as an `Evaluate`. It keeps a reference to `model`.
Evaluate evaluator(const PmModel& model);

inline bool is_isotropic(const PmModel& model) { return model.axial; }
void exchange(PmModel& model);

/// Size of the stored numbers, two bytes each.
std::size_t payload_bytes(const PmModel& model);
constexpr std::size_t auxiliary_bytes(const PmModel&) { return 0; }
/// `model` with every number rounded to its stored precision: read_model(write_model(model)).
PmModel rounded(const PmModel& model);

SRBF_END
