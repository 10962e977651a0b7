// From measurements to models: level 4.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "srbf/brdf.h"
#include "srbf/metrics.h"
#include "srbf/model.h"
#include "srbf/progress.h"
#include "srbf/result.h"

namespace [[gnu::visibility("default")]] srbf {

/// What a fit minimises over the pairs within θmax. Each objective corresponds to a measure of metrics.h.
enum class Objective {
    raw,  ///< Σ (f−f̂)²
    /// Σ (f cosθl − f̂ cosθl)² cosθv; for a multivariate model plus 0.005 times the cube-root weights, times cosθl
    /// cosθv
    cosine,
    // The next three are second-order approximations in f − f̂, with the mean of the channels in place of each channel:
    log,        ///< Σ (log(1 + f cosθl) − log(1 + f̂ cosθl))² cosθv
    cube_root,  ///< Σ (∛f − ∛f̂)²; where f is below a hundredth of its mean, with the weight at that value
    /// What is seen of a picture: Σ (⁶√(f cosθl + s) − ⁶√(f̂ cosθl + s))² cosθv, s = k_dark_share times the upper
    /// quartile q of f cosθl; as much of Σ (∛(f cosθl + q) − ∛(f̂ cosθl + q))² cosθv and 0.03 of cosine's sum, each
    /// scaled to Σ w |f|² = 1; and for a multivariate model ΔE_ITP of pictures of a sphere. The eye's response to a
    /// display is about the sixth root of its luminance (the exponent 0.159 of the perceptual quantiser, ITU-R BT.2100).
    appearance,
};
inline constexpr Objective k_default_objective = Objective::appearance;
inline constexpr double k_dark_share = 0.07;
std::span<const Objective> objectives();  ///< all objectives
std::string_view name(Objective objective);
std::string_view summary(Objective objective);  ///< what it minimises, a line in ASCII
std::optional<Objective> objective_named(std::string_view text);
/// The measure that an objective minimises and by which its fits are judged.
double Measures::*measure_of(Objective objective);
inline double error_of(const Measures& measures, Objective objective) { return measures.*measure_of(objective); }
/// Default θmax of the fit and of its measures [rad]: 80° for raw and cube-root, 89° for the others.
double default_max_theta(Objective objective);

/// Radiance reflected towards wv under an extended light, as a quadrature: Σ_i weight_i f(wl_i, wv). In uniform light
/// of radiance 1 it is the directional albedo.
struct RadianceObservation {
    Vec3f wv;
    std::vector<Vec3f> wl;
    std::vector<Rgb> f;           ///< [1/sr], ≥ 0
    std::vector<double> weight;   ///< solid angle times cosθl [sr], times the light's radiance
    std::vector<float> spectrum;  ///< of spectral observations: f at each wavelength, ≥ 0
};

/// A pixel of a displayed picture, where 1 is white: Σ_i weight_i f(wl_i, wv), over the directions of its view from
/// `first` on.
struct SeenPixel {
    std::size_t lighting = 0;  ///< index of the picture
    std::size_t first = 0;
    std::vector<float> weight;  ///< solid angle times cosθl, radiance and exposure [sr]
};
/// A point of a surface in pictures under several lights.
struct SeenView {
    Vec3f wv;
    std::vector<Vec3f> wl;  ///< at most k_most_view_directions
    std::vector<Rgb> f;     ///< [1/sr], ≥ 0
    std::vector<SeenPixel> pixels;
};
inline constexpr std::size_t k_most_view_directions = 512;

/// Weighted samples of a BRDF, in an order such that every prefix is a representative subset.
struct Observations {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;          ///< [1/sr], ≥ 0
    std::vector<double> weight;  ///< w ≥ 0; a fit minimises Σ w |f−f̂|², scaled so that Σ w |f|² = 1
    /// Of appearance, for all but the checks, otherwise empty: w ≥ 0 of radiance in pictures by one light, up to a
    /// factor. A fit adds it to `weight` in its last stages.
    std::vector<double> phase_weight;
    std::size_t checks = 0;  ///< the last `checks` pairs are not part of Σ unless a fit exceeds them by far
    Objective objective = Objective::raw;        ///< that the weights are of
    double typical = 0;                          ///< the value of f or f cosθl to which they are relative
    std::vector<RadianceObservation> radiances;  ///< that a fit also matches, from its first perturbation on
    double radiance_error = 0.1;  ///< an error of this share in every radiance costs as much as the loss of the pairs
    std::vector<SeenView> views;  ///< of pictures that a fit also matches, in its last stages
    std::uint64_t masked = 0;     ///< number of sampled pairs where nothing was measured
    std::uint64_t clamped = 0;    ///< number of negative channel values at sampled pairs, set to 0
    std::vector<float> wavelengths;  ///< C [nm] of spectral observations; otherwise empty
    std::vector<float> spectrum;     ///< f at each wavelength: observations × C [1/sr], ≥ 0
};

/// The first `count` observations, without checks and radiances: for short fits.
Observations beginning(const Observations& observations, std::size_t count);

/// Returns an error unless all arrays have the same length, values are finite, weights are ≥ 0 with one of them > 0,
/// and there are at least as many values as `parameters` of the model.
Result<Done> validate(const Observations& observations, std::size_t parameters);

struct ObserveOptions {
    Objective objective = k_default_objective;
    double max_theta = 0;       ///< [rad], in (0, π/2); 0: the objective's default
    std::size_t count = 65536;  ///< maximum number of pairs, 1024..2^24; an eighth of them are guards
    std::uint64_t seed = 0;
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

/// Samples eight times as many pairs as requested from a mixture that covers the features of a BRDF. Of these it
/// chooses half with probability proportional to their share of Σ w |f|² and half uniformly, weighted so that sums over
/// them estimate the objective's integrals over both caps. A pair that is chosen several times becomes one observation.
/// An eighth are guards between θmax and 89.9° with small weights proportional to f cosθl cosθv; they keep the fit at
/// the measurement's order of magnitude where it is not fitted. After these follow the checks: a grid over the whole
/// hemisphere to 89.9°, including its edges, and 32,768 pairs about the mirror direction. Radiances are observed at
/// those of 0, 15, 30, 45, 60, 70, 75, 80 and 85° that lie within θmax, in uniform light: albedos. For appearance 100
/// views of a sphere follow, under four extended and eleven single white lights of which none is one of
/// `standard_lightings`. `f` may be negative (see signed_value) or NaN.
/// Errors: no pair has a value; all values are 0; cancelled.
Result<Observations> observe(const Evaluate& f, const ObserveOptions& options, const ProgressToken& progress = {});

/// Makes `observations` spectral: adds the spectra whose colours they have, with negative values set to 0. `clamped`
/// then counts these instead of those of the colours.
void observe_spectra(Observations& observations, const Channels& spectra);

/// Whether f(Rωl, Rωv) = f(ωl, ωv) for rotations R about the normal, up to rounding or noise, over θ ≤ max_theta [rad].
/// The criterion: the mean squared change of f cosθl cosθv under any rotation is at most 1e-6 of the mean square of f
/// cosθl cosθv; or at most 2 % of it and at most 2.5 times the change under rotation by 15°.
bool is_isotropic(const Evaluate& f, double max_theta);

/// A BRDF at all pairs of n directions (the raw data of Tsai 2009, 12 n² bytes), and at further directions for each of
/// them.
struct RawMatrix {
    Discretise discretise = Discretise::view;  ///< which direction of a pair is the sampled one in `between`
    std::vector<Vec3f> direction;              ///< n: the Fibonacci set of the whole hemisphere
    std::vector<Rgb> f;                        ///< n × n; (wl_l, wv_v) is at v n + l [1/sr], ≥ 0; NaN: not measured
    /// f at a sampled direction and another one sampled from MirrorMixture about it. The directions of the set miss
    /// most of a sharp highlight, and for isotropic data the same part of it in all views.
    struct Between {
        Vec3f direction;
        Rgb f;
        float pdf = 0;  ///< [1/sr]
    };
    std::vector<Between> between;  ///< n × m
    std::uint64_t masked = 0;      ///< number of pairs of the matrix that were not measured
    std::uint64_t clamped = 0;     ///< number of negative channel values in the matrix, set to 0
};

struct TabulateOptions {
    int directions = 1536;                     ///< n, k_least_views..k_most_views
    int between = 512;                         ///< m, 0..k_most_between; 0: only the raw matrix
    Discretise discretise = Discretise::view;  ///< of the model to be fitted
    int threads = 0;                           ///< 0: as many as the machine has; the result does not depend on it
};
inline constexpr std::size_t k_most_between = 4096;

/// Evaluates `f`, which may be negative (see signed_value) or NaN. Errors: options out of range; cancelled.
Result<RawMatrix> tabulate(const Evaluate& f, const TabulateOptions& options = {}, const ProgressToken& progress = {});

/// What searches for lobes.
enum class Device {
    automatic,  ///< today the processor: the search on CUDA has been run in emulation only
    cpu,
    cuda,  ///< the first CUDA device; the rest of a fit remains on the processor
};

struct FitOptions {
    PmForm form = PmForm::extended;
    bool axial = true;  ///< only centres at +z or −z, sufficient for isotropic data
    /// f(ωl,ωv) = f(ωv,ωl) up to rounding: variates in pairs (a, b), (b, a) with the same centre and bandwidth
    bool reciprocal = false;
    int lobes = 8;     ///< J, 1..64
    int variates = 4;  ///< N, 1..8, even for a reciprocal model
    /// Upper bound 1/finest² on bandwidths, and 1/finest [1/rad] on the other weights; 0: the range of 16-bit floats.
    double finest = 0;
    /// form gaussian: true stores a log scale per lobe where β leaves the range of 16-bit floats; false bounds β
    bool log_scale = true;
    /// Number of starts: independent growths of J lobes. The best four are polished, one to three of them finished;
    /// with views, which decide among the better half, one. Default: 20, or 16 for 8 lobes and more.
    std::optional<int> starts = {};
    /// Maximum number of perturbations of a candidate, replacements of the least useful lobe, or every fourth time of
    /// the least useful variate. All starts get a fifth of them, the better half another three tenths, the best quarter
    /// the remaining half; with views the better half gets half of them. Default: 45 for up to 5 lobes, falling to 25
    /// for 8 and more.
    std::optional<int> perturbations = {};
    std::uint64_t seed = 0;  ///< of the random numbers
    int threads = 0;         ///< 0: as many as the machine has; the result does not depend on it
    /// Models that CUDA finds are other ones, of about the same loss: the order of sums differs.
    Device device = Device::automatic;
};
inline constexpr int k_most_fitted_lobes = 64;

enum class StopReason {
    converged,   ///< the last steps predicted a relative decrease below 1e-7, or none lowered the sum
    iterations,  ///< the iteration limit was reached while steps still lowered the sum, possibly by too little to go on
    cancelled,   ///< by the progress token; the model is the best so far
};
std::string_view name(StopReason reason);

struct PmFit {
    PmModel model;      ///< every number rounded to a 16-bit float
    PmModel unrounded;  ///< before rounding
    double loss = 0;    ///< Σ w |f−f̂|² of `model` over the observations, including guards, exceeded checks and
                        ///< radiances
    double unrounded_loss = 0;  ///< loss of `unrounded`
    StopReason stop = StopReason::converged;
};

/// Fits parameterized multivariate SRBFs by separable least squares: for given centres, bandwidths and
/// parameterizations the coefficients solve a non-negative linear problem; Levenberg-Marquardt minimises the remaining
/// residual (Kaufman 1975) over the others. Lobes are grown one by one. With spectral observations the search uses the
/// colours; its best lobes are polished with a coefficient per wavelength. Details: docs/fitting.md.
/// Errors: options out of range, fewer observations than parameters, values that are not finite; CUDA requested without
/// a device or in a build without it.
Result<PmFit> fit_pm(const Observations& observations, const FitOptions& options, const ProgressToken& progress = {});

struct SuFitOptions {
    int lobes = 8;  ///< J, 1..k_most_view_lobes
    Objective objective = k_default_objective;
    double max_theta = 0;  ///< [rad], 1 to 89.9°; 0: the objective's default. Pairs beyond it are guards
    /// Whether lobes have shapes, see `SuModel`; none: for objective appearance.
    std::optional<bool> shaped = {};
    SuInterpolation interpolation = SuInterpolation::rotated;  ///< stored in the model; the fit does not depend on it
    int neighbours = 3;                                        ///< K of plain interpolation, 1..k_most_neighbours
    std::uint64_t seed = 0;                                    ///< of the random numbers
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

struct SuFit {
    SuModel model;      ///< every number rounded to its stored precision
    SuModel unrounded;  ///< before rounding
    int empty = 0;      ///< number of sampled views without data, or black within θmax: their coefficients are 0
    StopReason stop = StopReason::converged;  ///< iterations: some view's last search reached its limit
};

/// Fits scattered univariate SRBFs: for each sampled direction of `matrix`, including those beyond θmax, a sum of J
/// lobes with general centres, by separable least squares as in `fit_pm`. The initial lobes of a view are those of the
/// previous view, rotated to its azimuth; the first of every 32 views starts from soft von Mises-Fisher clusterings.
/// Details: docs/fitting.md.
/// Errors: options out of range; a matrix of another size; a view with data at fewer than J directions within θmax.
Result<SuFit> fit_su(const RawMatrix& matrix, const SuFitOptions& options, const ProgressToken& progress = {});

struct GgxFitOptions {
    int lobes = 1;    ///< 1..k_most_ggx_lobes
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

struct GgxFit {
    GgxModel model;      ///< every number rounded to a 16-bit float
    GgxModel unrounded;  ///< before rounding
    double loss = 0;  ///< Σ w |f−f̂|² over the observations, including guards, before the linear parameters are rounded
    double unrounded_loss = 0;  ///< loss of `unrounded`
};

/// Fits Lambert and GGX. For given roughness all other parameters solve a non-negative linear problem. Roughness is
/// optimised by pattern search, from the best value on a grid of half octaves, evaluated on a subset. Albedos and
/// checks are not used.
/// Errors: options out of range, fewer observations than parameters, values that are not finite; cancelled.
Result<GgxFit> fit_ggx(const Observations& observations, const GgxFitOptions& options,
                       const ProgressToken& progress = {});

}  // namespace srbf
