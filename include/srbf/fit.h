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

namespace srbf {

/// What a fit minimises over the pairs within θmax; each is a measure of metrics.h.
enum class Objective {
    raw,  ///< Σ (f−f̂)²
    cosine,  ///< Σ (f cosθl − f̂ cosθl)² cosθv; and, of a multivariate model, 0.005 of the cube root's, times cosθl cosθv
    // These two to second order in f − f̂, with the mean of the channels in place of each:
    log,        ///< Σ (log(1 + f cosθl) − log(1 + f̂ cosθl))² cosθv
    cube_root,  ///< Σ (∛f − ∛f̂)², below a hundredth of the mean f as there
};
std::span<const Objective> objectives();  ///< all of them
std::string_view name(Objective objective);
std::optional<Objective> objective_named(std::string_view text);
/// The measure that an objective minimises, and by which its fits are judged.
double Measures::*measure_of(Objective objective);
inline double error_of(const Measures& measures, Objective objective) { return measures.*measure_of(objective); }
/// The cap of the fit and of its measures where none is asked for [rad]: 80° for raw and cube-root, 89° for cosine and log.
double default_max_theta(Objective objective);

/// A directional albedo as a sum: Σ_i weight_i f(wl_i, wv).
struct AlbedoObservation {
    Vec3f wv;
    std::vector<Vec3f> wl;
    std::vector<Rgb> f;           ///< [1/sr], ≥ 0
    std::vector<double> weight;   ///< solid angle times cosθl [sr]
    std::vector<float> spectrum;  ///< of spectral observations: f at each wavelength, ≥ 0
};

/// Weighted samples of a BRDF, in an order of which every beginning is a sample of the whole.
struct Observations {
    std::vector<Vec3f> wl, wv;
    std::vector<Rgb> f;          ///< [1/sr], ≥ 0
    std::vector<double> weight;  ///< w ≥ 0; a fit minimises Σ w |f−f̂|², scaled so that Σ w |f|² = 1
    std::size_t checks = 0;      ///< the last so many are no part of Σ: a fit that exceeds them by far takes them in
    double root_mean = 0;        ///< the mean f that cube-root weights are relative to; 0: they are another objective's
    std::vector<AlbedoObservation> albedo;  ///< what a fit keeps as well, from its first kick on
    std::uint64_t masked = 0;               ///< pairs drawn where nothing was measured
    std::uint64_t clamped = 0;              ///< negative channel values of those drawn, set to 0
    std::vector<float> wavelengths;         ///< C [nm] of spectral observations; else empty
    std::vector<float> spectrum;            ///< f at each of them: observations × C [1/sr], ≥ 0
};

/// The first `count` of them, without checks and albedo: what a fit in short looks at.
Observations beginning(const Observations& observations, std::size_t count);

/// An error where the observations are no arrays of one length, of finite values and weights of at least 0, one of them above 0; or where
/// their values are fewer than a model's `parameters`.
Result<Done> check(const Observations& observations, std::size_t parameters);

struct ObserveOptions {
    Objective objective = Objective::cosine;
    double max_theta = 0;       ///< [rad], in (0, π/2); 0: the objective's default
    std::size_t count = 65536;  ///< pairs at most, 1024..2^24; an eighth of them are guards
    std::uint64_t seed = 0;
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

/// Draws pairs from a mixture that finds a BRDF's features, eight times as many as are asked for, and of these chooses half by their share of
/// Σ w |f|², half alike, weighted so that sums over them estimate the objective's integrals over both caps; one that is chosen several
/// times is one observation. An eighth are guards between θmax and 89.9°, weighted little and by
/// f cosθl cosθv, which hold the fit to the measurement's order of magnitude where it is not asked to follow
/// it. Behind them stand the checks: a grid over the whole hemisphere to 89.9° with its edges, and 32,768 pairs about the mirror
/// direction. Albedo is observed at 0, 15, 30, 45, 60, 70, 75, 80 and 85° as far as they are within θmax. `f` may be
/// negative (see signed_value) or NaN. Errors: no pair has a value; all values are 0; cancelled.
Result<Observations> observe(const Evaluate& f, const ObserveOptions& options, const ProgressToken& progress = {});

/// Makes `observations` spectral: adds the spectra of which they have the colours, negative values set to 0, which `clamped` then counts in place
/// of those of colours.
void observe_spectra(Observations& observations, const Channels& spectra);

/// Whether f(Rωl, Rωv) = f(ωl, ωv) for rotations R about the normal, up to rounding or noise, over θ ≤ max_theta [rad]: the mean square of what any
/// rotation changes in f cosθl cosθv is at most 1e-6 of that of f cosθl cosθv itself; or 2 % of it, and no more than 2.5 times what 15° change.
bool is_isotropic(const Evaluate& f, double max_theta);

/// A BRDF at all pairs of n directions, the source's raw data of 12 n² bytes, and at further directions about each of them.
struct RawMatrix {
    Discretise discretise = Discretise::view;  ///< which of the directions is the sampled one in `between`
    std::vector<Vec3f> direction;              ///< n: the Fibonacci set of the whole hemisphere
    std::vector<Rgb> f;  ///< n × n, that of (wl_l, wv_v) at v n + l [1/sr], ≥ 0; NaN: not measured
    /// f of a sampled direction and one drawn from MirrorMixture about it. The set's directions miss most of a sharp highlight, and for
    /// isotropic data the same part of it in all views.
    struct Between {
        Vec3f direction;
        Rgb f;
        float pdf = 0;  ///< [1/sr]
    };
    std::vector<Between> between;  ///< n × m
    std::uint64_t masked = 0;      ///< pairs of the matrix that were not measured
    std::uint64_t clamped = 0;     ///< negative channel values there, set to 0
};

struct TabulateOptions {
    int directions = 1536;                     ///< n, k_least_views..k_most_views
    int between = 512;                         ///< m, 0..k_most_between; 0: the source's raw data alone
    Discretise discretise = Discretise::view;  ///< of the model that will be fitted
    int threads = 0;                           ///< 0: as many as the machine has; the result does not depend on it
};
inline constexpr std::size_t k_most_between = 4096;

/// Looks `f` up; it may be negative (see signed_value) or NaN. Errors: options out of range; cancelled.
Result<RawMatrix> tabulate(const Evaluate& f, const TabulateOptions& options = {}, const ProgressToken& progress = {});

struct FitOptions {
    PmForm form = PmForm::extended;
    bool axial = true;  ///< centres at +z or −z alone, which is all that isotropic data need
    bool reciprocal =
        false;  ///< f(ωl,ωv) = f(ωv,ωl) up to rounding: variates in pairs (a, b) and (b, a) of one centre and bandwidth
    int lobes = 8;     ///< J, 1..64
    int variates = 4;  ///< N, 1..8, even for a reciprocal model
    /// Bound on bandwidths, 1/finest², and on what is no bandwidth, 1/finest [1/rad]; 0: what halves hold.
    double finest = 0;
    bool log_scale = true;  ///< form gaussian: store a log scale a lobe where a half cannot hold β; false: bound β
    /// Independent growths; the best four are polished, one to three finished. Without a number 20, 16 for 8 lobes and more.
    std::optional<int> starts = {};
    /// Attempts of the best to replace the lobe that matters least, every fourth the variate that does: a fifth of all starts, three tenths of the better half of them, the
    /// other half of the best quarter. Without a number 45 for up to 5 lobes, 25 for 8 and more.
    std::optional<int> kicks = {};
    std::uint64_t seed = 0;  ///< of the random lobes
    int threads = 0;         ///< 0: as many as the machine has; the result does not depend on it
};
inline constexpr int k_most_fitted_lobes = 64;

enum class StopReason {
    converged,   ///< the last steps predicted a relative decrease below 1e-7, or found none that lowers
                 ///< the sum
    iterations,  ///< they still lowered it when they ended, maybe by less than pays
    cancelled,   ///< by the progress token: the model is the best so far
};
std::string_view name(StopReason reason);

struct PmFit {
    PmModel model;      ///< every number a half
    PmModel unrounded;  ///< before rounding
    double loss = 0;  ///< Σ w |f−f̂|² over the observations, guards, exceeded checks and albedo among them, of `model`
    double unrounded_loss = 0;  ///< the same of `unrounded`
    StopReason stop = StopReason::converged;
};

/// Fits parameterized multivariate SRBFs by separable least squares: for any centres,
/// bandwidths and parameterizations the coefficients follow from a non-negative linear problem; the others by
/// Levenberg-Marquardt on what remains (Kaufman 1975), from lobes grown one by one. Docs: docs/fitting.md.
/// Of spectral observations the search looks at the colours; its best lobes are polished with a coefficient for each wavelength.
/// Errors: options out of range, fewer observations than parameters, values that are not finite.
Result<PmFit> fit_pm(const Observations& observations, const FitOptions& options, const ProgressToken& progress = {});

struct SuFitOptions {
    int lobes = 8;  ///< J, 1..k_most_view_lobes
    Objective objective = Objective::cosine;
    double max_theta = 0;  ///< [rad], 1 to 89.9°, 0: the objective's default; pairs beyond it are guards
    SuInterpolation interpolation = SuInterpolation::rotated;  ///< of the model; the fit does not depend on it
    int neighbours = 3;                                        ///< K of plain interpolation, 1..k_most_neighbours
    std::uint64_t seed = 0;                                    ///< of the random lobes
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

struct SuFit {
    SuModel model;      ///< every number as a file holds it
    SuModel unrounded;  ///< before rounding
    int empty = 0;      ///< sampled views without data, or black within θmax: their coefficients are 0
    StopReason stop = StopReason::converged;  ///< iterations: some view's last search did all of its
};

/// Fits scattered univariate SRBFs: for each sampled direction of `matrix`, those beyond θmax too, a sum of J lobes with any
/// centres, by separable least squares as in `fit_pm`. A view starts from the lobes of the one before it, rotated to its
/// azimuth, the first of every 32 from soft von Mises-Fisher clusterings. Docs: docs/fitting.md.
/// Errors: options out of range, a matrix of other size; a view with data at fewer than J directions within θmax.
Result<SuFit> fit_su(const RawMatrix& matrix, const SuFitOptions& options, const ProgressToken& progress = {});

struct GgxFitOptions {
    int lobes = 1;    ///< 1..k_most_ggx_lobes
    int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

struct GgxFit {
    GgxModel model;      ///< every number a half
    GgxModel unrounded;  ///< before rounding
    double loss = 0;  ///< Σ w |f−f̂|² over the observations, guards among them, before the linear numbers are rounded
    double unrounded_loss = 0;  ///< the same of `unrounded`
};

/// Fits Lambert and GGX: for any roughness all else follows from a non-negative linear problem; roughness, from a grid of half octaves
/// that holds the least sum of a sample, by pattern search. No albedo and no checks are asked for.
/// Errors: options out of range, fewer observations than parameters, values that are not finite; cancelled.
Result<GgxFit> fit_ggx(const Observations& observations, const GgxFitOptions& options,
                       const ProgressToken& progress = {});

}  // namespace srbf
