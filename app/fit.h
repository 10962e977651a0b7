// What `srbf fit` is asked for, what it finds, and how that is told.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/report.h"
#include "render/image.h"
#include "srbf/choose.h"
#include "srbf/fit.h"
#include "srbf/fit_samples.h"

namespace srbf {

/// The command line.
struct FitRequest {
    std::string input, output, preview, json;
    std::string model = "pm", form = std::string(name(FitOptions{}.form)), objective_name = "cosine";
    std::string discretise = std::string(name(Discretise{})), interpolation = std::string(name(SuInterpolation{})),
                with_index;
    std::string channels = "rgb";
    int axial = 0;  // 1: axial lobes, -1: general ones, 0: as the measurement asks for
    bool no_scale = false, reciprocal = false;
    double max_theta = 0;  // [degrees], 0: the objective's default
    int lobes = 0;         // 0: the model's default, of samples by cross-validation
    bool lobes_auto = false;
    int variates = FitOptions{}.variates, threads = 0;
    int directions = TabulateOptions{}.directions, between = TabulateOptions{}.between;
    int neighbours = SuFitOptions{}.neighbours;
    std::uint64_t seed = 0;
    double target_error = 0;  // 0: none
    std::size_t budget = 0;   // 0: none

    bool spectral() const { return channels == "spectral"; }
    Objective objective() const { return *objective_named(objective_name); }
    double theta() const { return max_theta > 0 ? max_theta : default_max_theta(objective()) / k_degree; }  // [degrees]
};

/// What the fit and its judgement found.
struct Outcome {
    Model model, unrounded;
    std::optional<StopReason> stop;
    double load_seconds = 0, fit_seconds = 0, max_theta = 0;  // [s], [s], [degrees]
    std::uint64_t masked = 0, clamped = 0, raw_bytes = 0;
    int empty = 0;                         // sampled directions without data
    std::optional<std::uint64_t> samples;  // of scattered input: how many are within max_theta
    std::vector<Step> path;                // of models that were tried
    bool reached = true;                   // the error or the bytes that were asked for
    std::optional<bool> filled;            // of pm fitted to samples: whether with what is interpolated between them
    Comparison rounded, unrounded_too;
    Image8 picture;  // empty: none was asked for
};

/// Fits, judges, draws. `progress` counts all of that; returning false cancels a fit of a table.
Result<Outcome> fit(const FitRequest& request, const Measured& measured, const ProgressCallback& progress = {});

Json report_of(const FitRequest& request, const Measured& measured, const Outcome& outcome);
/// The story that travels with the model: nothing in it depends on the machine or the time.
std::map<std::string, std::string> provenance_of(const FitRequest& request, const Outcome& outcome);
Result<Done> print_report(const FitRequest& request, const Measured& measured, const Outcome& outcome);

}  // namespace srbf
