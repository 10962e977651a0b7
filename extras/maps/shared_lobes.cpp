#include "extras/maps/shared_lobes.h"

#include <algorithm>

#include "base/levenberg_marquardt.h"
#include "base/parallel.h"
#include "extras/maps/material_coefficients.h"
#include "models/pm/search/search.h"
#include "models/pm/search/subsets.h"
#include "models/pm/solve/rounding.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {
namespace {

/// Number of groups in which lobes are added, of steps after each group, and of steps after the last.
constexpr int k_basis_groups = 16, k_group_steps = 4, k_last_basis_steps = 16;
/// Rounds in which active lobes are chosen and all lobes follow, and the steps of each round.
constexpr int k_refinements = 3, k_refinement_steps = 6;

void optimise(SharedProblem& problem, Eigen::VectorXd& x, int steps) {
    levenberg_marquardt(problem, x, {.max_iterations = steps, .adapts_to_bounds = true});
}

/// Finds the lobes that materials with these rows share.
Lobes search_for_lobes(std::span<SharedRows> materials, const BasisOptions& options, Reporter& reporter) {
    const LobeShape shape = shape_of(lobe_options(options));
    std::mt19937_64 random = generator(options.seed, 0, 0);
    Lobes lobes = initial_parameterizations(shape, 0, random);
    SharedProblem problem(materials, shape);
    const int group = std::max(1, options.lobes / k_basis_groups);
    while (lobes.count() < options.lobes && !reporter.cancelled()) {
        const int end = std::min(lobes.count() + group, options.lobes), begin = lobes.count();
        while (lobes.count() < end) {
            problem.loss(pack(lobes));
            if (lobes.count() == begin) problem.weigh();
            const auto additions = random_candidates(random, lobes);
            lobes = with_lobe(std::move(lobes), problem.best_addition(additions));
            if (options.active > 0) problem.offer(std::size_t(lobes.count()) - 1);
        }
        Eigen::VectorXd x = pack(lobes);
        if (options.active > 0 && lobes.count() > options.active) {
            problem.loss(x);
            problem.activate(std::size_t(options.active));
        }
        optimise(problem, x, end < options.lobes ? k_group_steps : k_last_basis_steps);
        lobes = unpack(x, shape);
        reporter.advance("searching for shared lobes", double(end - begin));
    }
    return lobes;
}

/// Lets lobes follow all terms of the materials' objectives, where each material is a sum of its active lobes.
Lobes refine(Lobes lobes, std::size_t count, const ObservationsOf& observations, const BasisOptions& options,
             Reporter& reporter) {
    for (int round = 0; round < k_refinements && !reporter.cancelled(); ++round) {
        std::vector<SharedRows> materials(count);
        parallel_for(count, [&](std::size_t t) {
            if (const auto observed = observations(t)) materials[t] = material_of(*observed, lobes, options);
        });
        std::erase_if(materials, [](const SharedRows& material) { return !material.rows; });
        if (materials.empty()) break;
        SharedProblem problem(materials, lobes.shape);
        Eigen::VectorXd x = pack(lobes);
        problem.loss(x);
        problem.weigh();
        optimise(problem, x, k_refinement_steps);
        lobes = unpack(x, lobes.shape);
        reporter.advance("refining the shared lobes", double(count) / k_refinements);
    }
    return lobes;
}

/// The lobes with their stored precision.
Lobes rounded(const Lobes& lobes, const Rows& any_rows) {
    LobeProblem problem(any_rows, lobes.shape, false);
    problem.loss(pack(lobes));
    return to_lobes(to_halves(to_model(problem, lobes), lobes), lobes.shape);
}

/// The lobes as a model with coefficients and scales 1.
PmModel basis_model(const Lobes& lobes) {
    const auto N = std::size_t(lobes.shape.variates), J = std::size_t(lobes.count()),
               C = std::size_t(lobes.shape.components());
    PmModel model;
    model.form = lobes.shape.form, model.axial = lobes.shape.axial, model.lobes = int(J), model.variates = int(N);
    model.coefficient.assign(J, {1, 1, 1}), model.log_scale.assign(J, 0);
    for (std::size_t j = 0; j < J; ++j) {
        const auto weights = lobes.weights_of(int(j));
        for (std::size_t n = 0; n < N; ++n) {
            const Vec3d p = vector_of(weights, lobes.shape, int(n));
            const double bandwidth = elementary::hypot(p.x, p.y, p.z);
            model.bandwidth.push_back(float(bandwidth));
            model.centre.push_back(bandwidth > 0
                                       ? Vec3f{float(p.x / bandwidth), float(p.y / bandwidth), float(p.z / bandwidth)}
                                       : Vec3f{0, 0, 1});
        }
        for (std::size_t k = N * C; k < weights.size(); ++k) model.exponent.push_back(float(weights[k]));
    }
    for (const double angle : lobes.angle) model.parameterization.push_back(rounded_direction(angle));
    return rounded(model);
}

}  // namespace

SharedRows rows_for_search(const Observations& observations) {
    return {std::make_unique<Rows>(Subsets(observations).rows(Pairs::search, {}))};
}

PmModel find_shared_lobes(std::span<SharedRows> rows, const ObservationsOf& observations, const BasisOptions& options,
                          Reporter& reporter) {
    Lobes lobes;
    on_threads(options.threads, [&] {
        lobes = search_for_lobes(rows, options, reporter);
        if (observations) lobes = refine(std::move(lobes), rows.size(), observations, options, reporter);
        lobes = rounded(lobes, *rows[0].rows);
    });
    return basis_model(lobes);
}

}  // namespace srbf
