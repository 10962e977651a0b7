// Comparison of search strategies for lobes at equal time: the squared error ratio on the first 4096 observations, on
// one thread.
//   alternating: one lobe's weights or the angles at a time, the others fixed, from random lobes (as in Tsai 2009)
//   joint:       all of them together, from random lobes
//   grown:       lobes added one by one
//   replaced:    grown, then the least useful lobe is replaced repeatedly
//   usage: optimisers FILE...
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <functional>

#include "fit/search.h"
#include "least_squares.h"
#include "srbf/measured.h"

namespace srbf {
namespace {

constexpr double k_log_peak_limit = 300;
const ProgressCallback k_no_callback;

/// A problem in which only some variables may change.
struct Part {
    LobeProblem& whole;
    Eigen::Index first, count;
    double loss(const Eigen::VectorXd& x) { return whole.loss(x); }
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
        Eigen::MatrixXd all_H;
        Eigen::VectorXd all_g;
        whole.linearise(x, all_H, all_g);
        H = Eigen::MatrixXd::Zero(x.size(), x.size());
        g = Eigen::VectorXd::Zero(x.size());
        H.block(first, first, count, count) = all_H.block(first, first, count, count);
        g.segment(first, count) = all_g.segment(first, count);
    }
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const { return whole.lower(x); }
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const { return whole.upper(x); }
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const { return whole.longest_step(x); }
};

/// Calls attempt(0), attempt(1), ..., each of which returns a loss and stops when `expired`; reports the best after 0.5
/// and 5 s.
struct Race {
    using Clock = std::chrono::steady_clock;
    Clock::time_point start = Clock::now();
    double at_half = std::numeric_limits<double>::infinity(), best = at_half;
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start).count(); }
    bool expired() const { return seconds() > 5; }
    void take(double loss) {
        if (seconds() <= 0.5) at_half = std::min(at_half, loss);
        if (!expired()) best = std::min(best, loss);
    }
};

Eigen::VectorXd random_start(const FitOptions& options, int attempt) {
    std::mt19937_64 random = generator(options.seed, attempt, 3);
    Lobes lobes = without_lobes(shape_of(options), attempt, random);
    for (int j = 0; j < options.lobes; ++j) {
        const std::vector<double> lobe = random_lobe(random, lobes);
        lobes.weight.insert(lobes.weight.end(), lobe.begin(), lobe.end());
    }
    return LobeProblem::pack(lobes);
}

using Way = std::function<void(const Rows&, const FitOptions&, Race&, int attempt)>;

void alternating(const Rows& rows, const FitOptions& options, Race& race, int attempt) {
    LobeProblem problem(rows, shape_of(options), false, k_log_peak_limit);
    Eigen::VectorXd x = random_start(options, attempt);
    const Eigen::Index N = options.variates, W = shape_of(options).width();
    double before = std::numeric_limits<double>::infinity();
    for (int sweep = 0; sweep < 200 && !race.expired(); ++sweep) {
        LevenbergMarquardtOptions steps;
        steps.max_iterations = 2;
        double loss = 0;
        for (int j = -1; j < options.lobes; ++j) {
            Part part{problem, j < 0 ? 0 : N + j * W, j < 0 ? N : W};
            loss = levenberg_marquardt(part, x, steps).loss;
            race.take(loss);
        }
        if (loss > before * (1 - 1e-4)) break;
        before = loss;
    }
}

void joint(const Rows& rows, const FitOptions& options, Race& race, int attempt) {
    LobeProblem problem(rows, shape_of(options), false, k_log_peak_limit);
    Eigen::VectorXd x = random_start(options, attempt);
    LevenbergMarquardtOptions steps;
    steps.max_iterations = 10;
    for (int i = 0; i < 10 && !race.expired(); ++i) {
        const auto summary = levenberg_marquardt(problem, x, steps);
        race.take(summary.loss);
        if (summary.stop != Stop::iterations) break;
    }
}

void grown(const Rows& rows, const FitOptions& options, Race& race, int attempt) {
    Reporter quiet(k_no_callback, 1);
    race.take(grow(rows, options, k_log_peak_limit, attempt, quiet).loss);
}

void replaced(const Rows& rows, const FitOptions& options, Race& race, int attempt) {
    Reporter quiet(k_no_callback, 1);
    Candidate candidate = grow(rows, options, k_log_peak_limit, attempt, quiet);
    race.take(candidate.loss);
    for (int perturbation = 1; perturbation <= options.perturbations && !race.expired(); ++perturbation) {
        improve(rows, options, k_log_peak_limit, perturbation, candidate, quiet);
        race.take(candidate.loss);
    }
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    using namespace srbf;
    const std::pair<const char*, Way> ways[] = {
        {"alternating", alternating}, {"joint", joint}, {"grown", grown}, {"replaced", replaced}};
    fmt::print("| raw error, % after 0.5 s / 5 s | form |");
    for (const auto& [name, way] : ways) fmt::print(" {} |", name);
    fmt::print("\n|---|---|---|---|---|---|\n");
    for (int i = 1; i < argc; ++i) {
        const auto measured = load_measured(argv[i]);
        if (!measured) return fmt::print(stderr, "{}\n", message(measured.error())), 1;
        const auto observations = observe(signed_evaluator(*measured), {.objective = Objective::raw});
        if (!observations) return fmt::print(stderr, "{}\n", message(observations.error())), 1;
        const Rows rows(beginning(*observations, 4096));
        for (const PmForm form : {PmForm::gaussian, PmForm::extended}) {
            FitOptions options;
            options.form = form;
            fmt::print("| {} | {} |", std::filesystem::path(argv[i]).stem().string(), name(form));
            for (const auto& [label, way] : ways) {
                Race race;
                for (int attempt = 0; !race.expired(); ++attempt) way(rows, options, race, attempt);
                fmt::print(" {:.3g} / {:.3g} |", 100 * race.at_half, 100 * race.best);
            }
            fmt::print("\n");
        }
    }
}
