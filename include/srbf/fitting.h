// From a measurement to a model whose errors are known, in one call: level 5.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "srbf/choose.h"
#include "srbf/fit.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"
#include "srbf/progress.h"

namespace srbf {

/// J, the number of lobes of a multivariate model, 1..k_most_fitted_lobes.
struct LobeCount {
    int lobes = FitOptions{}.lobes;
};
/// The J of `k_tried_lobes` with the least product of bytes and held-out error; of samples the fewest lobes whose
/// cross-validated error is within 3 % of the least.
struct AutomaticLobes {};
/// A goal is looked for among all forms and sizes; of samples among the J of `k_tried_lobes` in the requested form.
using PmSize = std::variant<LobeCount, AutomaticLobes, SizeGoal>;
inline constexpr int k_tried_lobes[] = {2, 3, 4, 6, 9, 12};

/// A parameterized multivariate model (PM).
struct PmRequest {
    PmForm form = FitOptions{}.form;
    int variates = FitOptions{}.variates;  ///< N, 1..k_most_variates
    std::optional<PmSize> size = {};       ///< none: 8 lobes for a table, automatic for samples
    std::optional<bool> axial = {};        ///< none: axial if the measurement is isotropic
    bool reciprocal = false;
    bool log_scale = true;  ///< as in FitOptions
};
/// A view-by-view model (SU).
struct SuRequest {
    int lobes = SuFitOptions{}.lobes;  ///< J of each sampled direction, 1..k_most_view_lobes
    Discretise discretise = TabulateOptions{}.discretise;
    int directions = TabulateOptions{}.directions;
    int between = TabulateOptions{}.between;
    SuInterpolation interpolation = SuFitOptions{}.interpolation;
    int neighbours = SuFitOptions{}.neighbours;
    std::optional<DirectionMap> index = {};  ///< with a texture that names the samples nearest to each direction
};
/// Lambert and GGX.
struct GgxRequest {
    int lobes = GgxFitOptions{}.lobes;  ///< 1..k_most_ggx_lobes
};

/// What is fitted, and how.
struct FitRequest {
    std::variant<PmRequest, SuRequest, GgxRequest> model;
    Objective objective = Objective::cosine;
    std::optional<double> max_theta = {};  ///< θmax of the fit and of all errors [rad]; none: the objective's default
    bool spectral = false;                 ///< a coefficient for each wavelength of the measurement; PM alone
    std::uint64_t seed = 0;                ///< of the random choices
    int threads = 0;                       ///< 0: as many as the machine has; the outcome does not depend on it

    double theta() const { return max_theta.value_or(default_max_theta(objective)); }  ///< [rad]
};

/// A fitted model, and what is known of it.
struct FitOutcome {
    Model
        model;  ///< every number as a file holds it; with provenance: objective, max_theta, seed, and errors once measured
    Model unrounded;                 ///< before rounding
    std::optional<StopReason> stop;  ///< of an iterative fit
    double max_theta = 0;            ///< [rad]
    double fit_seconds = 0;          ///< without measuring the errors, which cross-validation is part of
    std::uint64_t masked = 0;        ///< pairs looked up where nothing was measured
    std::uint64_t clamped = 0;       ///< negative values among them, set to 0
    std::uint64_t raw_bytes =
        0;                     ///< of f at all pairs of 1536 (SU: the sampled) directions, or at the samples, in floats
    int empty_directions = 0;  ///< of SU: sampled directions without data
    std::optional<std::uint64_t> samples;  ///< of a measurement of samples: how many are within θmax
    std::optional<bool> filled;            ///< likewise, PM: whether the fit follows values interpolated between them
    std::vector<Step> path;                ///< models that were tried, where the size was to be chosen
    bool reached = true;                   ///< the requested error or bytes
    /// Errors of `model` and `unrounded` against the measurement; none before they are measured. Of samples `matrix` is at the
    /// samples themselves, `heldout` is 5-fold cross-validated, and albedo is against interpolated samples.
    std::optional<Comparison> errors, unrounded_errors;
};

/// Fits one BRDF as often as asked, and keeps what it has observed of it, so that the next fit starts at once. One thread uses
/// it at a time. Errors of all members: those of the stages (fit.h, choose.h, fit_samples.h), and `cancelled`.
class Fitter {
  public:
    /// It refers to `measured`, which must outlive it.
    explicit Fitter(const Measured& measured);
    explicit Fitter(Measured&&) = delete;
    /// A BRDF as a function, fitted like a table; negative values count as 0, NaN as not measured.
    explicit Fitter(Evaluate f);
    Fitter(Fitter&&) noexcept;
    Fitter& operator=(Fitter&&) noexcept;
    ~Fitter();

    /// The fit that is asked for; of samples its errors are measured with it.
    Result<FitOutcome> fit(const FitRequest& request, const ProgressToken& progress = {});
    /// A quick fit of a few tens of milliseconds to a second, to look at until `fit` is done: the higher the draft,
    /// 0..k_drafts−1, the finer. PM with a number of lobes (or 8) alone.
    Result<FitOutcome> draft(const FitRequest& request, int draft, const ProgressToken& progress = {});
    static constexpr int k_drafts = 2;
    /// Measures the errors of an outcome, and adds them to its provenance.
    Result<Done> measure(FitOutcome& outcome, const FitRequest& request, const ProgressToken& progress = {}) const;

  private:
    class Work;
    std::unique_ptr<Work> work_;
};

/// Fits a measurement and measures the errors of what was found: all that `srbf fit` does between reading and writing.
Result<FitOutcome> fit(const Measured& measured, const FitRequest& request, const ProgressToken& progress = {});
/// The same of a BRDF as a function.
Result<FitOutcome> fit(Evaluate f, const FitRequest& request, const ProgressToken& progress = {});

/// The directions of the matrix on which a model is measured: a view-by-view model's own, else the Fibonacci set of
/// k_matrix_directions within θmax [rad].
std::vector<Vec3f> matrix_directions(const Model& model, double theta_max);

}  // namespace srbf
