// Fitted BRDFs, and their file: level 3.
#pragma once
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/ggx.h"
#include "srbf/result.h"
#include "srbf/su.h"
#include "srbf/terms.h"

namespace srbf {

/// ψ(wl, wv) = normalize(a wl + b wv), a variate's parameterization; (a, b) finite and not (0, 0).
struct Parameterization {
    float a = 1, b = 1;
    friend bool operator==(const Parameterization&, const Parameterization&) = default;
};

/// Parameterized multivariate SRBFs (Tsai 2009, section 7.2), with the further terms κ_jk x_k of terms.h:
///   ρ(wl,wv) = Σ_j β_j e^{s_j} Π_n G(ψ_n(wl,wv)·ξ_jn | λ_jn) Π_k e^{κ_jk x_k(wl,wv)} [1/sr],
/// evaluated by kernel.glsl's pm_value. Members are as the formula takes them; the file's encoding is in `write_model`.
/// A spectral model has β_j at C wavelengths; its R, G, B follow from these (colour.h), one of them maybe negative: ρ is 0 where the sum is.
struct PmModel {
    PmForm form = PmForm::gaussian;
    bool axial = true;                               ///< every centre is +z or −z, as befits isotropic data
    int lobes = 0;                                   ///< J, 1..k_most_lobes
    int variates = 0;                                ///< N, 1..k_most_variates
    std::vector<Rgb> coefficient;                    ///< J: β_j ≥ 0; of a spectral model `colours` of its spectra
    std::vector<float> wavelength;                   ///< C [nm], increasing, of a spectral model; else empty
    std::vector<float> spectrum;                     ///< J × C: β_j ≥ 0 at these
    std::vector<float> log_scale;                    ///< J: s_j; stored only where one of them is not 0
    std::vector<Vec3f> centre;                       ///< J × N: ξ_jn, unit vectors
    std::vector<float> bandwidth;                    ///< J × N: λ_jn ≥ 0
    std::vector<Parameterization> parameterization;  ///< N
    std::vector<float> exponent;                     ///< J × F: κ_jk
    friend bool operator==(const PmModel&, const PmModel&) = default;
};
inline constexpr int k_most_lobes = 1024;
inline constexpr int k_most_variates = 8;
inline constexpr std::size_t k_most_wavelengths = 4096;
/// The colour of each of the spectra, which stand one after the other: `to_rgb`.
std::vector<Rgb> colours(std::span<const float> spectra, std::span<const float> wavelengths);

/// ρ(wl, wv) in float; 0 below the horizon.
Rgb value(const PmModel& model, Vec3f wl, Vec3f wv);

/// A model as a file holds it, with the story of how it was made.
struct Model {
    std::variant<PmModel, SuModel, GgxModel> model;
    std::map<std::string, std::string> provenance;  ///< source file, options, errors, version
};
Rgb value(const Model& model, Vec3f wl, Vec3f wv);

/// f[i] = value(model, wl[i], wv[i]) for spans of one length, in SIMD as wide as the machine has it: within 1e-4 of
/// `value` or 1e-6 of the model's peak.
void evaluate(const PmModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
void evaluate(const Model& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// The same as a function. It refers to `model`.
Evaluate evaluator(const PmModel& model);
Evaluate evaluator(const Model& model);

/// The wavelengths [nm] of a spectral model; else empty.
std::span<const float> wavelengths(const Model& model);
/// ρ at the wavelengths of a spectral model, three by three as `evaluate` has R, G, B. It refers to `model`.
Channels spectra(const PmModel& model);
Channels spectra(const PmModel&&) = delete;
/// The wavelengths of a spectral model, R, G, B of another one. It refers to `model`.
Channels channels(const Model& model);
Channels channels(const Model&&) = delete;

/// Bytes of a model's numbers as stored, and of what else it looks up at run time.
std::size_t payload_bytes(const Model& model);
std::size_t auxiliary_bytes(const Model& model);

/// Whether f(ωl, ωv) = f(ωv, ωl) by construction, up to rounding: each variate (a, b) with a ≠ b has another one, (b, a), of the same centres
/// and bandwidths in all lobes.
bool is_reciprocal(const PmModel& model);
/// Whether a log scale is stored: the form has further features, or some s_j is not 0 as a half.
bool has_log_scale(const PmModel& model);
/// Bytes of a model's numbers as stored, two each, and of one of such a kind.
std::size_t payload_bytes(const PmModel& model);
constexpr std::size_t payload_bytes(PmForm form, bool axial, bool log_scale, int lobes, int variates,
                                    int channels = 3) {
    const int of_lobe = channels + (axial ? 1 : 3) * variates + int(log_scale) + features(form);
    return 2 * std::size_t(lobes * of_lobe + 2 * variates);
}
constexpr std::size_t auxiliary_bytes(const PmModel&) { return 0; }
/// `model` with every number rounded to what a file holds: read_model(write_model(model)).
PmModel rounded(const PmModel& model);

/// The model file: a safetensors container (8-byte little-endian length, JSON header, data) with F16 tensors
/// `coefficient` [J,3], `bandwidth` [J,N], `parameterization` [N,2], where needed `log_scale` [J] and
/// `exponent` [J,F], and for general lobes `centre` [J,N,2] (θ, φ in radians). Axial lobes have no `centre`: the sign of the bandwidth
/// chooses +z or −z. A spectral model has `coefficient` [J,C] and the metadata `wavelengths` [nm], parted by blanks. A view-by-view model has `coefficient` [n,J,3], `bandwidth` [n,J] and `centre` [n,J,2], a centre's (θ, φ) less
/// those of its view's mirror direction; and where it has an index texture that as `aux.index`, U16 [6,s,s,8] or [s,s,8], and
/// `aux.directions` [n,4], the sampled directions and a 0. A model of Lambert and GGX has `diffuse` [3], and for its L lobes `roughness` [L],
/// `facing` [L,3] and `grazing` [L].
std::vector<std::byte> write_model(const Model& model);
/// Errors: not such a file; tensors missing, of other type or shape, overlapping or leaving gaps; numbers
/// that are not finite or out of range; `wrong_kind`: a measurement. `source` is for errors alone.
Result<Model> read_model(std::span<const std::byte> bytes, const std::string& source);

Result<Done> save_model(const Model& model, const std::string& path);
Result<Model> load_model(const std::string& path);

}  // namespace srbf
