#include "base/errors.h"
#include "base/half.h"
#include "base/least_squares.h"
#include "base/parallel.h"
#include "models/ggx/ggx_kind.h"
#include "observe/pair_weights.h"
#include "observe/surface_problem.h"
#include "srbf/elementary.h"
#include "srbf/kernel.h"

namespace SRBF_NAMESPACE {
namespace {

// For given roughness the model is linear in kd and F0_i of each channel and in F90_i of all channels. At an
// observation their factors are
//   1/π,  D G / (4 cosθl cosθv) (1 − s),  D G / (4 cosθl cosθv) s,  s = (1 − l·h)⁵,
// the same for every channel, so that one small matrix of moments is sufficient.
constexpr std::size_t k_block_rows = 4096;     ///< rows that a thread processes together
constexpr std::size_t k_scanned_rows = 16384;  ///< rows on which the grid of roughness is scanned

/// log2 of the roughness of each lobe.
using LogRoughness = std::vector<double>;

class GgxProblem {
  public:
    GgxProblem(const Observations& observations, std::size_t rows, int threads)
        : observations_(observations), rows_(std::min(rows, observations.fitted_count())), threads_(threads) {
        grazing_ = column([](Vec3f wl, Vec3f wv) { return Kernel<float>::schlick_weight(wl, wv); });
    }

    double loss(const LogRoughness& log_alpha) { return solve(log_alpha).loss; }

    struct Solution {
        GgxModel model;
        double loss = 0;  ///< Σ w |f−f̂|²
    };
    Solution solve(const LogRoughness& log_alpha) {
        const Eigen::MatrixXd sums = moments(log_alpha);
        const auto L = log_alpha.size();
        const auto terms = Eigen::Index(1 + 2 * L);
        const auto n = Eigen::Index(3 + 4 * L);
        // Unknowns: kd of R, G, B; then for each lobe F0 of R, G, B and F90.
        const auto f0_index = [](std::size_t i, int c) { return Eigen::Index(3 + 4 * i) + c; };
        const auto f90_index = [](std::size_t i) { return Eigen::Index(6 + 4 * i); };
        Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n);
        Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
        for (int c = 0; c < 3; ++c) {
            std::vector<Eigen::Index> unknown{c};
            for (std::size_t i = 0; i < L; ++i) unknown.push_back(f0_index(i, c)), unknown.push_back(f90_index(i));
            g(unknown) += sums.block(0, terms + c, terms, 1);
            G(unknown, unknown) += sums.topLeftCorner(terms, terms);
        }
        const auto unbounded = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
        const Eigen::VectorXd x = bounded_least_squares(G, g, unbounded);
        Solution solution{{}, sums.diagonal().tail(3).sum() - 2 * g.dot(x) + x.dot(G * x)};
        solution.model.diffuse = {float(x[0]), float(x[1]), float(x[2])};
        for (std::size_t i = 0; i < L; ++i)
            solution.model.lobes.push_back(
                {float(elementary::exp2(log_alpha[i])),
                 {float(x[f0_index(i, 0)]), float(x[f0_index(i, 1)]), float(x[f0_index(i, 2)])},
                 float(x[f90_index(i)])});
        return solution;
    }

  private:
    template <typename Value> std::vector<float> column(const Value& value) const {
        std::vector<float> values(rows_);
        parallel_for_chunks(rows_, k_block_rows, threads_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t row = begin; row < end; ++row)
                values[row] = value(observations_.wl[row], observations_.wv[row]);
        });
        return values;
    }
    /// D G / (4 cosθl cosθv) of each row.
    const std::vector<float>& facets(double log_alpha) {
        const auto entry = std::min(std::ranges::find(facets_, log_alpha, &CachedColumn::log_alpha), facets_.end() - 1);
        std::rotate(facets_.begin(), entry, entry + 1);
        if (facets_[0].log_alpha != log_alpha) {
            const auto alpha = float(elementary::exp2(log_alpha));
            facets_[0] = {log_alpha,
                          column([=](Vec3f wl, Vec3f wv) { return Kernel<float>::ggx_facets(wl, wv, alpha); })};
        }
        return facets_[0].values;
    }

    /// The inner products of the model's terms and of f's channels R, G, B, weighted by w.
    Eigen::MatrixXd moments(const LogRoughness& log_alpha) {
        const Eigen::Index terms = 1 + 2 * Eigen::Index(log_alpha.size());
        std::array<const float*, k_max_ggx_lobes> lobe_facets{};
        for (std::size_t i = 0; i < log_alpha.size(); ++i) lobe_facets[i] = facets(log_alpha[i]).data();
        std::vector<Eigen::MatrixXd> parts(chunk_count(rows_, k_block_rows));
        parallel_for_chunks(rows_, k_block_rows, threads_, [&](std::size_t begin, std::size_t end) {
            Eigen::MatrixXd columns(terms + 3, Eigen::Index(end - begin));
            for (std::size_t row = begin; row < end; ++row) {
                auto t = columns.col(Eigen::Index(row - begin));
                t[0] = 1 / k_pi;
                for (std::size_t i = 0; i < log_alpha.size(); ++i) {
                    const auto factor = double(lobe_facets[i][row]), s = double(grazing_[row]);
                    t.segment(Eigen::Index(1 + 2 * i), 2) << factor * (1 - s), factor * s;
                }
                const Rgb& f = observations_.f[row];
                t.tail(3) << double(f.r), double(f.g), double(f.b);
                t *= std::sqrt(observations_.weight[row]);
            }
            parts[begin / k_block_rows] = columns * columns.transpose();
        });
        Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(terms + 3, terms + 3);
        for (const Eigen::MatrixXd& part : parts) sums += part;
        return sums;
    }

    const Observations& observations_;
    std::size_t rows_;
    int threads_;
    std::vector<float> grazing_;  ///< s of each row
    struct CachedColumn {
        double log_alpha = 1;  ///< 1 for an unused entry, since roughness is at most 1
        std::vector<float> values;
    };
    std::array<CachedColumn, 4>
        facets_;  ///< a cache of the last values of roughness, of which a search changes one at a time
};

constexpr double k_min_log = -10;  ///< log2 of k_min_roughness

/// The roughness of all lobes on a grid of half octaves from `min_log` on. The first of two lobes is the narrower
/// one.
std::vector<LogRoughness> roughness_grid(int lobes, double min_log) {
    std::vector<double> octaves{min_log};
    for (double x = k_min_log; x <= 0; x += 0.5)
        if (x > min_log) octaves.push_back(x);
    std::vector<LogRoughness> grid;
    for (std::size_t i = 0; i < octaves.size(); ++i) {
        if (lobes == 1) grid.push_back({octaves[i]});
        for (std::size_t k = i + 1; lobes == 2 && k < octaves.size(); ++k) grid.push_back({octaves[i], octaves[k]});
    }
    return grid;
}

/// The best roughness of the grid. Empty if no loss is finite.
LogRoughness scan(GgxProblem& problem, int lobes, double min_log) {
    LogRoughness best;
    double min = std::numeric_limits<double>::infinity();
    for (const LogRoughness& log_alpha : roughness_grid(lobes, min_log))
        if (const double loss = problem.loss(log_alpha); loss < min) min = loss, best = log_alpha;
    return best;
}

/// Moves to the neighbour that lowers the loss, or else halves the step (Hooke & Jeeves 1961).
void refine(GgxProblem& problem, LogRoughness& log_alpha, double min_log) {
    double min = problem.loss(log_alpha);
    for (double step = 0.25; step > 1e-4; step /= 2)
        for (bool lowered = true; lowered;) {
            lowered = false;
            for (double& x : log_alpha)
                for (const double next : {x - step, x + step}) {
                    const double previous = x;
                    x = std::clamp(next, min_log, 0.0);
                    const double loss = problem.loss(log_alpha);
                    if (loss < min)
                        min = loss, lowered = true;
                    else
                        x = previous;
                }
        }
}

/// Variables of a search by pictures: roots of coefficients, and log2 of the roughness as a fraction of its range.
struct GgxVariables {
    double min_log;
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
            model.lobes.push_back({float(elementary::exp2(min_log * (1 - x[i]))), colour(i + 1), square(i + 4)});
        return model;
    }
    Eigen::VectorXd x_of(const GgxModel& model) const {
        std::vector<double> x;
        const auto add_roots = [&](const Rgb& colour) {
            for (int c = 0; c < 3; ++c) x.push_back(std::sqrt(double(colour[c])));
        };
        add_roots(model.diffuse);
        for (const GgxModel::Lobe& lobe : model.lobes) {
            x.push_back(std::clamp(1 - elementary::log2(double(lobe.roughness)) / min_log, 0.0, 1.0));
            add_roots(lobe.f0);
            x.push_back(std::sqrt(double(lobe.f90)));
        }
        return Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size()));
    }
    Eigen::VectorXd max() const {
        Eigen::VectorXd max = Eigen::VectorXd::Constant(Eigen::Index(3 + 5 * lobes), 100);
        for (std::size_t lobe = 0; lobe < lobes; ++lobe) max[Eigen::Index(3 + 5 * lobe)] = 1;
        return max;
    }
};

/// The loss of the pairs relative to the loss of the pixels, at the model that is solved for pairs; about the same as
/// in the default fit. Without pairs the RMS of radiance is up to twice as large.
constexpr double k_pair_fraction = 0.3;

/// The model with the least loss of pixels and pairs, starting from `solved`, the best model by pairs, and from the
/// best by pairs at each roughness of the grid.
Result<Fitted<GgxModel>> fit_pixels(const Observations& observations, GgxProblem& pairs, const GgxModel& solved,
                                    double min_log, int threads, const ProgressToken& progress) {
    const GgxVariables variables{min_log, solved.lobes.size(), observations.is_grey()};
    std::vector<SurfaceCandidate<GgxModel>> candidates{{solved}};
    for (const LogRoughness& log_alpha : roughness_grid(int(solved.lobes.size()), min_log))
        candidates.push_back({pairs.solve(log_alpha).model});
    const auto variables_of = [&](const GgxModel&) { return variables; };
    double done = 0.5;
    std::optional<SurfaceData> data;
    for (const SurfaceRound& round : {SurfaceRound{candidates.size(), 8, 0}, {24, 4, 12}, {6, 1, 40}}) {
        if (!progress.report("fitting pixels", done)) return cancelled_error("fit");
        data.emplace(observations, round.subsampling)
            .add_pairs(observations, round.subsampling, evaluator(solved), k_pair_fraction);
        refine_candidates(candidates, round, *data, variables_of, threads);
        done += 0.15;
    }
    SurfaceProblem problem(*data, variables);
    const auto& [best, loss] = candidates[0];
    const GgxModel model = rounded(best);
    return Fitted<GgxModel>{model, best, problem.loss(model), loss};
}

}  // namespace

Result<Fitted<GgxModel>> Kind<GgxModel>::fit(const Observations& observations, const GgxRequest& request,
                                             const FitConditions& conditions, const ProgressToken& progress) {
    const StandardArithmetic mode;
    if (const auto valid = validate(observations, std::size_t(3 + 5 * request.lobes)); !valid) return valid.error();
    if (request.lobes < 1 || request.lobes > k_max_ggx_lobes)
        return argument_error("fit", "number of lobes", "1 or 2", std::to_string(request.lobes));
    Observations weighed = observations;
    GgxProblem sample(weighed, k_scanned_rows, conditions.threads), all(weighed, weighed.f.size(), conditions.threads);
    // Below α = 1/2, so that the grid has values for two lobes.
    const double min_log = std::clamp(elementary::log2(std::max(observations.min_roughness, 1e-9)), k_min_log, -1.0);
    if (!progress.report("scanning roughness", 0)) return cancelled_error("fit");
    LogRoughness log_alpha = scan(sample, request.lobes, min_log);
    if (!progress.report("refining roughness", 0.2)) return cancelled_error("fit");
    refine(all, log_alpha, min_log);
    for (int round = 0; round < k_facet_rounds && traits(observations.objective).response; ++round) {
        const GgxModel model = all.solve(log_alpha).model;
        weighed.weight = observations.weight;
        weigh_large_errors(weighed, evaluator(model), k_max_facet_change);
        if (!progress.report("refining roughness", 0.3 + 0.2 * round / k_facet_rounds)) return cancelled_error("fit");
        if (round == 0) log_alpha = scan(sample, request.lobes, min_log);
        refine(all, log_alpha, min_log);
    }
    if (log_alpha.empty()) return Error{"fit", {}, "loss of every roughness", "a finite number", "none"};
    if (!observations.views.empty())
        return fit_pixels(weighed, sample, all.solve(log_alpha).model, min_log, conditions.threads, progress);
    Fitted<GgxModel> fit;
    auto [unrounded, unrounded_loss] = all.solve(log_alpha);
    fit.unrounded = std::move(unrounded);
    fit.unrounded_loss = unrounded_loss;
    // Rounds roughness, then solves for the other parameters again.
    for (double& x : log_alpha) x = elementary::log2(double(round_to_half(float(elementary::exp2(x)))));
    auto [model, loss] = all.solve(log_alpha);
    fit.model = rounded(model);
    fit.loss = loss;
    return fit;
}

}  // namespace
