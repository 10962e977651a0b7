
#include "base/errors.h"
#include "base/half.h"
#include "base/least_squares.h"
#include "base/parallel.h"
#include "models/ggx/ggx_functions.h"
#include "models/ggx/ggx_kind.h"
#include "observe/pair_weights.h"
#include "observe/surface_problem.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr std::size_t k_solved_rows = 16384;  ///< pairs for which initial models are solved
constexpr double k_least_log = -10;           ///< log2 of k_least_roughness
/// The number of times that weights adapt to the errors of the best initial model. With one, or with eight, errors of
/// pictures of one material in five are 1 to 3 % larger.
constexpr int k_initial_rounds = 2;

/// log2 of the roughness of each lobe.
using LogRoughness = std::vector<double>;

/// The roughness of all lobes on a grid of half octaves from `least_log` on. The first of two lobes is the narrower one.
std::vector<LogRoughness> roughness_grid(int lobes, double least_log) {
    std::vector<double> octaves{least_log};
    for (double x = k_least_log; x <= 0; x += 0.5)
        if (x > least_log) octaves.push_back(x);
    std::vector<LogRoughness> grid;
    for (std::size_t i = 0; i < octaves.size(); ++i) {
        if (lobes == 1) grid.push_back({octaves[i]});
        for (std::size_t k = i + 1; lobes == 2 && k < octaves.size(); ++k) grid.push_back({octaves[i], octaves[k]});
    }
    return grid;
}

/// A model with its Σ w |f − f̂|².
using GgxCandidate = SurfaceCandidate<GgxModel>;

/// The best model of this roughness for the first pairs. It is linear in kd and F0_i of each channel and in F90_i of all
/// channels, whose factors are the same for every channel:
///   1/π,  D G / (4 cosθl cosθv) (1 − s),  D G / (4 cosθl cosθv) s,  s = (1 − l·h)⁵.
GgxCandidate solved(const Observations& observations, std::size_t most_rows, const LogRoughness& log_alpha) {
    using K = Kernel<float>;
    const std::size_t L = log_alpha.size();
    const auto terms = Eigen::Index(1 + 2 * L), n = Eigen::Index(3 + 4 * L);
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(terms + 3, terms + 3);
    Eigen::VectorXd t(terms + 3);
    t[0] = 1 / k_pi;
    for (std::size_t row = 0; row < std::min(observations.fitted_count(), most_rows); ++row) {
        const Vec3f wl = observations.wl[row], wv = observations.wv[row];
        const auto s = double(K::schlick_weight(wl, wv));
        for (std::size_t i = 0; i < L; ++i) {
            const auto facets = double(K::ggx_facets(wl, wv, float(elementary::exp2(log_alpha[i]))));
            t.segment(Eigen::Index(1 + 2 * i), 2) << facets * (1 - s), facets * s;
        }
        const Rgb& f = observations.f[row];
        t.tail(3) << double(f.r), double(f.g), double(f.b);
        sums += observations.weight[row] * t * t.transpose();
    }
    // Unknowns: kd of R, G, B; then for each lobe F0 of R, G, B and F90.
    const auto f0_index = [](std::size_t i, int c) { return Eigen::Index(3 + 4 * i) + c; };
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    for (int c = 0; c < 3; ++c) {
        std::vector<Eigen::Index> unknown{c};
        for (std::size_t i = 0; i < L; ++i) unknown.insert(unknown.end(), {f0_index(i, c), f0_index(i, 3)});
        g(unknown) += sums.block(0, terms + c, terms, 1);
        G(unknown, unknown) += sums.topLeftCorner(terms, terms);
    }
    const auto unbounded = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
    const Eigen::VectorXd x = bounded_least_squares(G, g, unbounded);
    GgxCandidate solution{{{float(x[0]), float(x[1]), float(x[2])}, {}},
                          sums.diagonal().tail(3).sum() - 2 * g.dot(x) + x.dot(G * x)};
    for (std::size_t i = 0; i < L; ++i) {
        const Eigen::Index f0 = f0_index(i, 0);
        solution.model.lobes.push_back({float(elementary::exp2(log_alpha[i])),
                                        {float(x[f0]), float(x[f0 + 1]), float(x[f0 + 2])},
                                        float(x[f0 + 3])});
    }
    return solution;
}

/// The solutions for each roughness of the grid, in order of their loss.
std::vector<GgxCandidate> solved(const Observations& observations, std::span<const LogRoughness> grid, int threads) {
    std::vector<GgxCandidate> all(grid.size());
    parallel_for(grid.size(), threads, [&](std::size_t i) { all[i] = solved(observations, k_solved_rows, grid[i]); });
    std::ranges::stable_sort(all, {}, &GgxCandidate::loss);
    return all;
}

/// Variables of a search: roots of coefficients, and log2 of the roughness as a share of its range.
struct GgxVariables {
    double least_log;
    std::size_t lobes;
    bool is_grey;  ///< pictures see channels differently: those of grey data have the mean root

    GgxModel model(const Eigen::VectorXd& x) const {
        const auto square = [&](Eigen::Index i) { return float(x[i] * x[i]); };
        const auto colour = [&](Eigen::Index i) {
            if (!is_grey) return Rgb{square(i), square(i + 1), square(i + 2)};
            const double mean = (x[i] + x[i + 1] + x[i + 2]) / 3;
            return Rgb{float(mean * mean), float(mean * mean), float(mean * mean)};
        };
        GgxModel model{colour(0), {}};
        for (Eigen::Index i = 3; i < x.size(); i += 5)
            model.lobes.push_back({float(elementary::exp2(least_log * (1 - x[i]))), colour(i + 1), square(i + 4)});
        return model;
    }
    Eigen::VectorXd x_of(const GgxModel& model) const {
        std::vector<double> x;
        const auto add_roots = [&](const Rgb& colour) {
            for (int c = 0; c < 3; ++c) x.push_back(std::sqrt(double(colour[c])));
        };
        add_roots(model.diffuse);
        for (const GgxModel::Lobe& lobe : model.lobes) {
            x.push_back(std::clamp(1 - elementary::log2(double(lobe.roughness)) / least_log, 0.0, 1.0));
            add_roots(lobe.f0);
            x.push_back(std::sqrt(double(lobe.f90)));
        }
        return Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size()));
    }
    Eigen::VectorXd most() const {
        Eigen::VectorXd most = Eigen::VectorXd::Constant(Eigen::Index(3 + 5 * lobes), 100);
        for (std::size_t lobe = 0; lobe < lobes; ++lobe) most[Eigen::Index(3 + 5 * lobe)] = 1;
        return most;
    }
};

/// The share of pairs in the loss, for the model that is solved for pairs; about that of the default fit. Without pairs
/// the RMS of radiance is up to twice as large.
constexpr double k_pair_share = 0.3;

constexpr SurfaceRound k_pixel_rounds[] = {{210, 8, 0}, {24, 4, 12}, {6, 1, 40}};
/// Initial models are solved for pairs, so that the best of them need few steps.
constexpr SurfaceRound k_pair_rounds[] = {{2, 1, 20}};

}  // namespace

Result<Fitted<GgxModel>> Kind<GgxModel>::fit(const Observations& observations, const GgxRequest& request,
                                             const FitConditions& conditions, const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = validate(observations, std::size_t(3 + 5 * request.lobes)); !valid) return valid.error();
    if (request.lobes < 1 || request.lobes > k_most_ggx_lobes)
        return Error{"fit", {}, "number of lobes", "1 or 2", std::to_string(request.lobes), ErrorCode::argument};
    // Below α = 1/2, so that the grid has values for two lobes.
    const double least_log =
        std::clamp(elementary::log2(std::max(observations.least_roughness, 1e-9)), k_least_log, -1.0);
    const std::vector<LogRoughness> grid = roughness_grid(request.lobes, least_log);
    const GgxVariables variables{least_log, std::size_t(request.lobes), observations.is_grey()};
    const auto variables_of = [&](const GgxModel&) { return variables; };
    if (!progress.report("scanning roughness", 0)) return cancelled_error("fit");
    Observations weighed = observations;
    std::vector<GgxCandidate> candidates = solved(weighed, grid, conditions.threads);
    const bool adapts_weights = traits(observations.objective).response;
    const auto weigh_by = [&](const GgxModel& model) {
        weighed.weight = observations.weight;
        weigh_large_errors(weighed, evaluator(model), k_most_facet_change);
    };
    for (int i = 0; i < k_initial_rounds && adapts_weights; ++i) {
        weigh_by(candidates[0].model);
        candidates = solved(weighed, grid, conditions.threads);
    }
    const Evaluate initial = evaluator(GgxModel(candidates[0].model));
    const auto data = [&](std::size_t n) {
        SurfaceData made(weighed, n);
        if (!observations.views.empty()) made.add_pairs(weighed, n, initial, k_pair_share);
        return made;
    };
    const bool is_by_pairs = observations.views.empty();
    double done = 0.4;
    for (const SurfaceRound& round : is_by_pairs ? std::span<const SurfaceRound>(k_pair_rounds) : k_pixel_rounds) {
        if (!progress.report("searching parameters", done += 0.15)) return cancelled_error("fit");
        lower(candidates, round, data(round.n), variables_of, conditions.threads);
    }
    candidates.resize(1);
    for (int i = 0; i < k_facet_rounds && adapts_weights && is_by_pairs; ++i) {
        weigh_by(candidates[0].model);
        lower(candidates, k_pair_rounds[0], data(1), variables_of, conditions.threads);
    }
    const SurfaceData all = data(1);
    Fitted<GgxModel> fit{{}, candidates[0].model};
    fit.model = rounded(fit.unrounded);
    if (is_by_pairs) {  // coefficients adapt to the rounded roughness
        const auto adapted = [&](const GgxModel& model) {
            LogRoughness log_alpha;
            for (const GgxModel::Lobe& lobe : model.lobes)
                log_alpha.push_back(elementary::log2(double(lobe.roughness)));
            return solved(weighed, weighed.f.size(), log_alpha).model;
        };
        fit.unrounded = adapted(fit.unrounded);
        fit.model = rounded(adapted(fit.model));
    }
    SurfaceProblem problem(all, variables);
    fit.loss = problem.loss(fit.model), fit.unrounded_loss = problem.loss(fit.unrounded);
    return fit;
}

}  // namespace srbf
