// Selection of a model by bytes or by visible error.
#include "errors/measures.h"

#include "brdf/channels.h"
#include "fit/choose.h"
#include "models.h"
#include "srbf/metrics.h"

namespace srbf::choose_test {
namespace {

/// Data of two lobes of form horizon, which fit into 40 bytes.
class Choose : public testing::Test {
  protected:
    Choose() {
        truth_.form = PmForm::horizon;
        truth_.lobes = 2, truth_.variates = 1;
        truth_.coefficient = {{0.8f, 0.5f, 0.4f}, {0.1f, 0.2f, 0.3f}};
        truth_.log_scale = {0, 0};
        truth_.centre = {{0, 0, 1}, {0, 0, 1}};
        truth_.bandwidth = {40, 2};
        truth_.parameterization = {{1, 1}};
        truth_.exponent = {0.5f, 0.2f};
        observed_ = *observe(evaluator(truth_), {.objective = Objective::raw, .count = 16384});
        options_.starts = 4, options_.perturbations = 3;
    }
    double error(const PmModel& model) const {
        const Evaluate others[] = {evaluator(model)};
        return measure_heldout(rgb_channels(evaluator(truth_)), rgb_channels(others), {80 * k_degree, 0}, 20000)[0]
            .squared_error_ratio;
    }
    Result<Chosen> choose(const SizeGoal& goal) const {
        return choose_pm(observed_, options_, goal, [&](const PmModel& model, bool) { return error(model); });
    }

    PmModel truth_;
    Observations observed_;
    PmFitOptions options_;
};

TEST_F(Choose, TheBudgetIsKeptAndUsed) {
    double last = 1;
    for (const std::size_t bytes : {14u, 24u, 40u}) {
        const auto chosen = choose(ByteBudget{bytes});
        ASSERT_TRUE(chosen.ok());
        EXPECT_LE(payload_bytes(chosen->fit.model), bytes);
        const double now = error(chosen->fit.model);
        EXPECT_LE(now, last);
        last = now;
        // It is the best of the full fits.
        for (const Trial& step : chosen->path) {
            if (step.whole && step.bytes <= bytes) {
                EXPECT_GE(step.error, now * 0.999);
            }
        }
    }
    EXPECT_LT(last, 1e-4);
}

TEST_F(Choose, TheSmallestModelThatReachesATargetIsTaken) {
    const auto chosen = choose(TargetDeltaE{1e-3});
    ASSERT_TRUE(chosen.ok());
    EXPECT_TRUE(chosen->reached);
    EXPECT_LE(error(chosen->fit.model), 1e-3);
    EXPECT_LE(payload_bytes(chosen->fit.model), payload_bytes(truth_));
    for (const Trial& step : chosen->path) {
        if (step.whole && step.error <= 1e-3) {
            EXPECT_GE(step.bytes, payload_bytes(chosen->fit.model));
        }
    }
}

TEST_F(Choose, ThePathIsInOrderAndEachModelStandsOnce) {
    const auto chosen = choose(ByteBudget{40});
    ASSERT_TRUE(chosen.ok());
    EXPECT_GT(chosen->path.size(), 6u);
    for (std::size_t i = 1; i < chosen->path.size(); ++i) {
        const Trial &a = chosen->path[i - 1], &b = chosen->path[i];
        EXPECT_LE(a.bytes, b.bytes);
        EXPECT_FALSE(a.form == b.form && a.lobes == b.lobes && a.variates == b.variates && a.axial == b.axial);
    }
}

TEST_F(Choose, ACancelledSearchIsAnErrorOrWhatItHad) {
    const auto judge = [&](const PmModel& model, bool) { return error(model); };
    for (const SizeGoal& goal : {SizeGoal{ByteBudget{40}}, SizeGoal{TargetDeltaE{1e-3}}})
        for (const int calls : {0, 1, 2}) {
            int called = 0;
            const auto chosen =
                choose_pm(observed_, options_, goal, judge, [&](const Progress&) { return called++ < calls; });
            EXPECT_LE(called, calls + 1) << "called again after cancellation";
            if (chosen) {
                EXPECT_GT(chosen->fit.model.lobes, 0);
            } else {
                EXPECT_NE(message(chosen.error()).find("cancelled"), std::string::npos);
            }
        }
}

TEST_F(Choose, TooFewBytesAreAnError) { EXPECT_FALSE(choose(ByteBudget{8}).ok()); }

}  // namespace
}  // namespace srbf::choose_test
