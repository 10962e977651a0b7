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

const Rows& rows() {
    static const Rows all(*observe(evaluator(tilted()), {Objective::raw, 0, 4096, 7}));
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

TEST(Search, GrowsWhatMadeTheData) {
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

TEST(Search, RandomExponentsAreOfTheRangeOfTheirTerms) {
    std::mt19937_64 random(3);
    const Lobes none{{k_forms.back(), 2}, {0, 0}, {}};
    std::vector<std::vector<double>> drawn(k_terms.size());
    for (int i = 0; i < 4000; ++i) {
        const std::vector<double> weight = random_lobe(random, none);
        for (std::size_t k = 0; k < k_terms.size(); ++k) drawn[k].push_back(weight[2 + k]);
    }
    for (std::size_t k = 0; k < k_terms.size(); ++k) {
        const auto [least, most] = std::minmax_element(drawn[k].begin(), drawn[k].end());
        const ExponentTerm& term = k_terms[k];
        EXPECT_GE(*least, std::max(term.least, term.is_sharp ? -100.0 : -10.0)) << term.symbol;
        EXPECT_LE(*least, 0.9 * std::max(term.least, term.is_sharp ? -100.0 : -10.0)) << term.symbol;
        EXPECT_LE(*most, std::min(term.most, term.is_sharp ? 6e4 : 10.0)) << term.symbol;
        EXPECT_GE(*most, 0.9 * std::min(term.most, term.is_sharp ? 6e4 : 10.0)) << term.symbol;
        EXPECT_GE(std::count(drawn[k].begin(), drawn[k].end(), 0.0), 1000) << term.symbol;
    }
}

TEST(Search, ShortFitsHaveNoMoreStartsAndPerturbations) {
    PmFitOptions options = options_of(0);
    EXPECT_EQ(starts_of(quick_options(options, 4, 8)), 4);
    EXPECT_EQ(perturbations_of(quick_options(options, 4, 8)), 8);
    options.starts = 2, options.perturbations = 0;
    EXPECT_EQ(starts_of(quick_options(options, 4, 8)), 2);
    EXPECT_EQ(perturbations_of(quick_options(options, 4, 8)), 0);
}

}  // namespace
}  // namespace srbf::search_test
