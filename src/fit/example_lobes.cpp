#include "fit/example_lobes.h"

#include "base/levenberg_marquardt.h"
#include "brdf/values.h"
#include "models/pm/solve/rounding.h"
#include "observe/bound.h"

namespace SRBF_NAMESPACE {
namespace {

/// Over 64 blends of five measurements and 64 GGX materials, more candidates or steps lower no mean error by a tenth.
constexpr std::size_t k_candidates = 4;
constexpr int k_candidate_steps = 4, k_steps_of_best = 8;

/// Lobes with the loss of their best coefficients.
struct Attempt {
    double loss;
    Lobes lobes;
    Stop stop = Stop::iterations;
};

/// f cosθl cosθv of the brightest channel at pairs.
std::vector<double> brightness(const PmModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv) {
    std::vector<Rgb> f(wl.size());
    evaluator(model)(wl, wv, f);
    std::vector<double> bright(f.size());
    for (std::size_t i = 0; i < f.size(); ++i) bright[i] = double(largest_of(f[i])) * bound_cosines(wl[i], wv[i]);
    return bright;
}

}  // namespace

ExampleLobes::ExampleLobes(std::span<const PmModel> examples, const PmFitOptions& options) : options_(options) {
    for (const PmModel& example : examples) {
        const bool is_black =
            std::ranges::all_of(example.coefficient, [](const Rgb& beta) { return !(largest_of(beta) > 0); });
        if (!is_black) starts_.push_back(to_lobes(example, shape_of(options)));
    }
    for (const DirectionPair& pair : horizon_grid()) grid_wl_.push_back(pair.wl), grid_wv_.push_back(pair.wv);
}

ExampleLobes::Fit ExampleLobes::fit(const Observations& samples, const Observations& between) const {
    Observations both = samples;
    both.append(between);
    const Rows rows(both);
    const LobeShape shape = shape_of(options_);
    const auto after_steps = [&](const Lobes& from, int steps) {
        LobeProblem problem(rows, shape, false);
        Eigen::VectorXd x = pack(from);
        if (steps == 0) return Attempt{problem.loss(x), from};
        const auto reached = levenberg_marquardt(problem, x, {.max_iterations = steps});
        return Attempt{reached.loss, unpack(x, shape), reached.stop};
    };
    const auto rounded = [&](const Attempt& attempt) {
        LobeProblem problem(rows, shape, false);
        problem.loss(pack(attempt.lobes));
        const Lobes lobes = round_lobes(problem, attempt.lobes, attempt.loss);
        problem.loss(pack(lobes));
        return to_halves(to_model(problem, lobes), lobes);
    };
    std::vector<Attempt> attempts;
    for (const Lobes& start : starts_) attempts.push_back(after_steps(start, 0));
    std::ranges::stable_sort(attempts, {}, &Attempt::loss);
    const double loss_of_example = attempts.front().loss;
    const Fit example{rounded(attempts.front()), StopReason::iterations};
    if (3 * samples.f.size() < parameter_count(options_)) return example;

    attempts.resize(std::min(attempts.size(), k_candidates));
    for (Attempt& attempt : attempts) attempt = after_steps(attempt.lobes, k_candidate_steps);
    std::ranges::stable_sort(attempts, {}, &Attempt::loss);
    std::vector<double> limit = brightness(example.model, grid_wl_, grid_wv_);
    const double largest = largest_measured(samples);
    for (double& bright : limit) bright = k_most_excess * std::max(bright, largest);
    for (const Attempt& attempt : attempts) {
        const Attempt last = after_steps(attempt.lobes, k_steps_of_best);
        if (!(last.loss < loss_of_example)) continue;
        PmModel model = rounded(last);
        const std::vector<double> bright = brightness(model, grid_wl_, grid_wv_);
        if (std::ranges::equal(bright, limit, std::less_equal()))
            return {std::move(model), last.stop == Stop::iterations ? StopReason::iterations : StopReason::converged};
    }
    return example;
}

}  // namespace srbf
