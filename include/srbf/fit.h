// Fits of measurements with measured errors, in one call.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"
#include "srbf/progress.h"

SRBF_BEGIN

/// A size that was tried.
struct Trial {
    int lobes = 0;
    std::size_t bytes = 0;
    double error = 0;  ///< mean ΔE_ITP for a table; for samples the held-out error that the objective minimises
};

/// The model to fit, and how.
struct FitRequest {
    AnyRequest model;
    Objective objective = k_default_objective;
    std::optional<double> max_theta = {};  ///< θmax of the fit and of all errors [rad]; none: the objective's default
    bool spectral = false;                 ///< a coefficient for each wavelength of the measurement; PM only
    std::uint64_t seed = 0;                ///< seed of the random numbers
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it

    double theta() const { return max_theta.value_or(default_max_theta(objective)); }  ///< [rad]
};

/// Noise of a measurement in the darker half of all pairs of directions.
struct Noise {
    Rgb deviation{};  ///< standard deviation [1/sr]
    Rgb level{};      ///< median value [1/sr]
    /// Fraction of pairs with a negative value but a positive local mean; maximum over channels.
    double negative = 0;
};

/// A fitted model with its errors and statistics.
struct FitOutcome {
    Model model;  ///< the stored model; its provenance has options of the fit, and errors once they are measured
    std::optional<StopReason> stop;  ///< why an iterative fit stopped
    double max_theta = 0;            ///< [rad]
    double fit_seconds = 0;          ///< without the measurement of errors, which includes cross-validation
    std::uint64_t masked = 0;        ///< number of evaluated pairs where nothing was measured
    std::uint64_t clamped = 0;       ///< number of negative channel values among them; set to 0 unless they are noise
    double largest_albedo = 1;  ///< largest albedo of the observations in a channel, at views up to 80°; at least 1
    /// The noise of a table. If more than 30 % of pairs are negative (`Noise::negative`), the fit keeps negative
    /// values, as noise about a mean.
    std::optional<Noise> noise;
    /// The bytes of the data as 32-bit floats: at all pairs of 1536 directions (SU: of the sampled ones), or at the
    /// samples.
    std::uint64_t raw_bytes = 0;
    /// SU: the number of sampled directions without data.
    std::optional<int> empty_directions;
    /// Scattered samples: the number of samples within θmax.
    std::optional<std::uint64_t> samples;
    /// Scattered samples: the fits to all folds but one.
    std::vector<Model> without_fold;
    std::vector<Trial> path;  ///< sizes that were tried, ascending
    bool reached = true;      ///< whether the requested ΔE_ITP was reached
    /// Errors of `model` against the measurement; empty until they are measured. For scattered samples `matrix` covers
    /// the samples themselves, `heldout` is the 5-fold cross-validated error, and albedo and pictures are compared with
    /// the samples, gaps filled.
    std::optional<Comparison> errors;
    /// Picture error between the measurement f(wl, wv) and f(wv, wl); a reciprocal fit differs from one of them by
    /// at least half of it. Empty if the measurement is reciprocal.
    std::optional<Appearance> exchanged_errors;
    /// Picture error of a reciprocal `model` against the mean that it was fitted to.
    std::optional<Appearance> against_mean;
    /// Picture error of `model` against a noisy measurement that was smoothed.
    std::optional<Appearance> against_smoothed;
};

/// Fits one BRDF repeatedly. It keeps the observations, so that later fits start at once. Not thread-safe. All members
/// return the errors of the stages of a fit, and one with the code `cancelled`.
class Fitter {
  public:
    /// Keeps a reference to `measured`, which must outlive it.
    explicit Fitter(const Measured& measured);
    explicit Fitter(Measured&&) = delete;
    /// A BRDF as a function, treated like a table: NaN counts as not measured, negative values as 0 unless they are
    /// noise.
    explicit Fitter(Evaluate f);
    Fitter(Fitter&&) noexcept;
    Fitter& operator=(Fitter&&) noexcept;
    ~Fitter();

    /// Fits the requested model. For scattered samples this also measures the errors. Returns an error for a two-sided
    /// measurement; `measure` takes its front reflection.
    Result<FitOutcome> fit(const FitRequest& request, const ProgressToken& progress = {});
    /// A first multivariate model. For a table a search of a few tens of milliseconds finds it. For samples it is the
    /// fit to all of them, without cross-validation. If no number of lobes is requested, it has `FormRow::lobes`.
    Result<FitOutcome> draft(const FitRequest& request, const ProgressToken& progress = {});
    /// Measures the errors of `outcome` and adds them to its provenance.
    Result<Done> measure(FitOutcome& outcome, const FitRequest& request, const ProgressToken& progress = {}) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Fits a measurement and measures the errors of the model: everything that `srbf fit` does between reading and
/// writing. Returns an error for a two-sided measurement, which `fit_bsdf` fits.
Result<FitOutcome> fit(const Measured& measured, const FitRequest& request, const ProgressToken& progress = {});
/// Fits a BRDF as a function.
Result<FitOutcome> fit(Evaluate f, const FitRequest& request, const ProgressToken& progress = {});

/// A noisy table smoothed to its noise, as fits see it (docs/notes/noise.md). Keeps a reference to `measured`, which
/// must be isotropic. Returns an error if it is not a table of one BRDF or not noisy, or if it is cancelled.
Result<Evaluate> smoothed_to_noise(const Measured& measured, int threads = 0, const ProgressToken& progress = {});

/// Light that leaves a surface for a direction of the incident light.
struct Hemispherical {
    double theta = 0;     ///< polar angle of the incident light [rad]
    double phi = 0;       ///< its azimuth in the part's frame [rad]
    double measured = 0;  ///< Σ over outgoing directions of f cosθ dω, with the beam; green [1]
    double fitted = 0;
};

/// The fit of a part.
struct PartFit {
    Part part = Part::reflection_front;
    std::optional<Part> answered_by;  ///< the part whose model it uses; none: it has a model of its own
    bool black = false;               ///< all values are 0
    FitOutcome outcome;               ///< fit of the part's own model; a fit of patches has no errors of pictures
    /// Σ w (f − f̂)² / Σ w f², without beams: at pairs of directions within 80°, w both cosines,
    /// unless the table is fitted in a way of its own.
    double squared_error_ratio = 0;
    std::vector<Hemispherical> hemispherical;
};

struct BsdfOutcome {
    Model model;
    std::vector<PartFit> parts;
    double fit_seconds = 0;
    /// The largest Σ of reflection and transmission of an angle of incidence, measured and fitted.
    double max_measured = 0, max_fitted = 0;
};

/// Fits the parts of a two-sided measurement. A part that equals its counterpart, with a squared error ratio of at most
/// 1e-4, uses its model. A part is fitted like the measurement of a BRDF; patches are fitted to their sums. Beams are
/// kept as they are. Returns an error if `fit` does, and for a measurement of one side.
Result<BsdfOutcome> fit_bsdf(const Measured& measured, const FitRequest& request, const ProgressToken& progress = {});

/// Fits a BSDF that is given as functions in the parts' frames, null for parts that are 0.
Result<BsdfOutcome> fit_bsdf(const std::array<Evaluate, k_parts>& parts, const FitRequest& request,
                             const ProgressToken& progress = {});

SRBF_END
