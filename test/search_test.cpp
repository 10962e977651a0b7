// The search for lobes: growth and perturbations.
#include "models/pm/search/search.h"

#include "models.h"
#include "observe/observations.h"
#include "properties.h"

namespace srbf::search_test {
namespace {

/// A broad lobe and one with an edge, for a ψ far from half vector, light and view.
PmModel tilted() {
    PmModel model;
    model.lobes = model.variates = 2;
    for (const double angle : {k_pi / 4, 0.68 * k_pi})
        model.parameterization.push_back({float(elementary::cos(angle)), float(elementary::sin(angle))});
    model.coefficient = {{1, 0.5f, 0.2f}, {0.1f, 0.3f, 0.4f}};
    model.log_scale = {0, 0};
    model.centre = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, -1}};
    model.bandwidth = {60, 3, 2, 300};
    return model;
}

const PackedObservations& rows() {
    static const PackedObservations all(*observe(evaluator(tilted()), {Objective::raw, 0, 4096, 7}));
    return all;
}

PmFitOptions options_of(std::uint64_t seed) {
    PmFitOptions options;
    options.form = PmForm::gaussian;
    options.lobes = options.variates = 2;
    options.seed = seed;
    return options;
}

Candidate improved(Candidate candidate, const PmFitOptions& options, int perturbations) {
    Reporter reporter({}, 1);
    LobeProblem problem(rows(), shape_of(options), false);
    perturb(problem, options, perturbations, candidate, reporter);
    return candidate;
}

TEST(Search, PerturbationsFindAParameterizationThatStepsDoNotReach) {
    const Candidate beside{.lobes = {{PmForm::gaussian, 2}, {k_pi / 4, 0.1}, {60, 3, 2, -300}}};
    int found = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Candidate before = improved(beside, options_of(seed), 3), after = improved(before, options_of(seed), 32);
        EXPECT_EQ(after.perturbations, 32);
        EXPECT_LE(after.loss, before.loss * (1 + 1e-6));
        EXPECT_GE(before.loss, 0.01) << "perturbations of lobes alone";
        found += after.loss <= 1e-6;
    }
    EXPECT_GE(found, 8);
}

TEST(Search, RecoversTheModelThatMadeTheData) {
    int found = 0;
    for (int start = 0; start < 10; ++start) {
        Reporter reporter({}, 1);
        Candidate candidate{.start = start};
        LobeProblem problem(rows(), shape_of(options_of(3)), false);
        grow(problem, options_of(3), candidate, reporter);
        EXPECT_EQ(candidate.lobes.count(), 2);
        found += improved(candidate, options_of(3), 16).loss <= 1e-6;
    }
    EXPECT_GE(found, 8);
}

}  // namespace
}  // namespace srbf::search_test
