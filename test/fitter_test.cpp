// Fits with measured errors in one call: results, cancellation, errors.
#include "srbf/fit.h"

#include <set>
#include <thread>

#include "brdf/directions.h"
#include "brdf_functions.h"
#include "measured_files.h"
#include "models.h"
#include "observe/excess.h"
#include "observe/observations.h"
#include "observe/pairs.h"
#include "properties.h"

namespace srbf::fitter_test {
namespace {

FitRequest pm(PmSize size, int variates = 2) {
    return {.model = PmRequest{.variates = variates, .size = size, .effort = 0.1}, .objective = Objective::raw};
}
FitRequest su(int directions) { return {.model = SuRequest{.lobes = 2, .directions = directions}}; }
FitRequest ggx() { return {.model = GgxRequest{.lobes = 1}, .objective = Objective::cosine}; }

/// Samples of a smooth BRDF on a grid.
Measured samples() {
    ScatteredSamples scattered;
    scattered.isotropic = true;
    for (int l = 0; l < 8; ++l)
        for (int v = 0; v < 8; ++v)
            for (int p = 0; p < 7; ++p) {
                const Vec3f wl = direction_at(10 * l, 30 * p), wv = direction_at(10 * v, 0);
                const float f = 0.2f + 0.1f * wl.z * wv.z;
                scattered.wl.push_back(wl), scattered.wv.push_back(wv), scattered.colour.push_back({f, f / 2, f / 4});
            }
    make_index(scattered);
    return {"samples", "CSV", 0, std::move(scattered)};
}

// ---- Defaults ----

struct RecordedErrors {
    const char* name;
    double delta_e, rms, albedo_error;  // 1.1 times the errors of version 0.1, which a failure prints
};

/// The fit with default options, which is made once.
const FitOutcome& default_fit(const std::string& name) {
    static std::map<std::string, Result<FitOutcome>> made;
    const auto entry = made.find(name);
    return *(entry != made.end() ? entry : made.emplace(name, fit(bundled(name), {})).first)->second;
}

class DefaultFit : public testing::TestWithParam<RecordedErrors> {
  public:
    static const FitOutcome& outcome() { return default_fit(GetParam().name); }
};

TEST_P(DefaultFit, StaysWithinItsRecordedErrors) {
    EXPECT_EQ(payload_bytes(outcome().model), 210u);
    EXPECT_LE(outcome().errors->appearance.mean.delta_e, GetParam().delta_e);
    EXPECT_LE(outcome().errors->appearance.mean.rms, GetParam().rms);
    EXPECT_EQ(outcome().model.provenance.at("objective"), "appearance");
    EXPECT_EQ(outcome().model.provenance.at("max_theta"), "89");
}

/// The error of albedos, which no fit minimises, stays within its bound, too.
TEST_P(DefaultFit, StaysWithinItsRecordedErrorsOfAlbedo) {
    EXPECT_LE(outcome().errors->albedo_error, GetParam().albedo_error);
}

TEST_P(DefaultFit, IsBoundedToTheHorizon) {
    const Measured& measured = bundled(GetParam().name);
    // f cosθl cosθv exceeds the largest measured value by at most a factor everywhere, including close to the horizon.
    const auto largest = [](const auto& brdf, double max, double step, double azimuth) {
        float peak = 0;
        for (double l = 0; l <= max; l += step)
            for (double v = 0; v <= max; v += step)
                for (double p = azimuth; p <= 180; p += 5) {
                    const Vec3f wl = direction_at(l, p), wv = direction_at(v, 0);
                    const Rgb f = value(brdf, wl, wv);
                    if (is_finite(f)) peak = std::max(peak, std::max({f.r, f.g, f.b}) * wl.z * wv.z);
                }
        return peak;
    };
    const float bound = float(k_max_excess) * largest(measured, 89, 0.5, 180);  // where highlights are
    EXPECT_LE(largest(outcome().model, 90 - 1e-9, 2.5, 0), bound);
    for (const double theta : {89.0, 89.5, 89.9, 89.99, 89.999})
        for (double p = 0; p <= 180; p += 1) {
            const Vec3f wl = direction_at(theta, p), wv = direction_at(theta, 0);
            const Rgb f = value(outcome().model, wl, wv);
            ASSERT_TRUE(is_finite(f));
            const float cosine = std::max(wl.z, float(k_grazing_cosine));
            ASSERT_LE(std::max({f.r, f.g, f.b}) * cosine * cosine, bound) << theta << ' ' << p;
        }
}

TEST_P(DefaultFit, ReflectsTheMeasuredLightAtGrazingAngles) {
    const Measured& measured = bundled(GetParam().name);
    for (const double cosine : {1.0, 0.5, 0.1, 0.03, 0.01, 0.002}) {
        const double theta = std::acos(cosine);
        const Rgb expected = albedo(reciprocal_mean(evaluator(measured)), theta, k_pi / 2),
                  found = albedo(evaluator(outcome().model), theta, k_pi / 2);
        EXPECT_LE(largest_of(found), 1.003) << cosine;
        EXPECT_RGB_WITHIN(found, expected, 0.04) << cosine;
    }
}

INSTANTIATE_TEST_SUITE_P(Bundled, DefaultFit,
                         testing::Values(RecordedErrors{"cc_ibiza_sunset_rgb", 6.13, 0.1233, 0.1527},
                                         RecordedErrors{"paper_white_rgb", 1.43, 0.0916, 0.0104}),
                         [](const auto& test) { return std::string(test.param.name); });

/// Fits of the film with more lobes, and view by view, stay within their bounds.
TEST(Fitter, LargerModelsStayWithinTheirRecordedErrors) {
    const Measured& measured = bundled("cc_ibiza_sunset_rgb");
    const struct {
        FitRequest request;
        std::size_t bytes;
        double delta_e, rms;  // 1.1 times the errors of version 0.1, which a failure prints
    } expected[] = {
        {{.model = PmRequest{.form = PmForm::extended, .size = LobeCount{12}, .effort = 0.34}}, 304, 4.70, 0.1042},
        {{.model = SuRequest{.lobes = 5, .directions = 384}}, 23040, 6.25, 0.0851}};
    for (const auto& row : expected) {
        const auto outcome = checked(fit(measured, row.request));
        EXPECT_EQ(payload_bytes(outcome->model), row.bytes);
        EXPECT_LE(outcome->errors->appearance.mean.delta_e, row.delta_e);
        EXPECT_LE(outcome->errors->appearance.mean.rms, row.rms);
    }
}

// ---- A call and its stages ----

TEST(Fitter, EqualsItsStagesCalledSeparately) {
    const Measured& measured = bundled("paper_white_rgb");
    const FitRequest request = pm(LobeCount{1});
    const auto at_once = checked(fit(measured, request));
    Fitter fitter(measured);
    // Neither a draft nor an earlier fit changes the result of a later one.
    ASSERT_TRUE(fitter.draft(request));
    ASSERT_TRUE(fitter.fit(pm(LobeCount{1}, 1), {}));
    auto outcome = checked(fitter.fit(request));
    EXPECT_FALSE(outcome->errors);
    ASSERT_TRUE(fitter.measure(*outcome, request));
    EXPECT_EQ(write_model(outcome->model), write_model(at_once->model));
    EXPECT_EQ(outcome->errors->heldout.squared_error_ratio, at_once->errors->heldout.squared_error_ratio);
    // The same BRDF as a function has the same fit.
    const auto function_fit = checked(fit(signed_evaluator(measured), request));
    EXPECT_EQ(std::get<PmModel>(function_fit->model.model), std::get<PmModel>(at_once->model.model));
}

TEST(Fitter, SamplesAreCrossValidated) {
    const Measured measured = samples();
    FitRequest request = pm(LobeCount{1}, 1);
    const auto outcome = checked(fit(measured, request));
    EXPECT_EQ(outcome->samples, 8u * 8u * 7u);
    EXPECT_LT(outcome->errors->heldout.squared_error_ratio, 0.01);
    // The errors of a draft are not measured.
    Fitter fitter(measured);
    auto draft = checked(fitter.draft(request));
    EXPECT_FALSE(draft->errors);
    EXPECT_TRUE(fitter.measure(*draft, request));
}

// ---- Progress and cancellation ----

/// Runs each kind of fit with its measurement of errors.
TEST(Fitter, ProgressNeverDecreasesAndCancelsInEveryStage) {
    const Measured table = bundled("paper_white_rgb"), scattered = samples();
    struct Case {
        const char* name;
        const Measured* measured;
        FitRequest request;
    };
    const Case cases[] = {
        {"pm", &table, pm(LobeCount{1})},
        {"su", &table, su(32)},
        {"ggx", &table, ggx()},
        {"a target", &table, pm(AutomaticLobes{6}, 1)},
        {"auto", &scattered, pm(LobeCount{1}, 1)},
    };
    std::set<std::string> cancelled_in;
    for (const Case& fit_case : cases) {
        std::set<std::string> stages;
        double last = 0;
        const auto complete = fit(*fit_case.measured, fit_case.request, [&](const Progress& now) {
            EXPECT_GE(now.fraction, last) << fit_case.name;
            EXPECT_LE(now.fraction, 1) << fit_case.name;
            EXPECT_FALSE(now.stage.empty());
            last = now.fraction;
            stages.emplace(now.stage);
            return true;
        });
        ASSERT_TRUE(complete) << fit_case.name << ": " << message(complete.error());
        EXPECT_WITHIN(last, 1, 1e-9) << fit_case.name;
        EXPECT_EQ(complete->model.model.index(), fit_case.request.model.index());
        ASSERT_TRUE(complete->errors);
        EXPECT_GT(complete->errors->heldout.pairs, 0u) << fit_case.name;
        EXPECT_LT(error_of(complete->errors->heldout, fit_case.request.objective), 0.5) << fit_case.name;
        EXPECT_GT(complete->raw_bytes, 0u) << fit_case.name;
        EXPECT_GE(stages.size(), 2u) << fit_case.name;
        for (const std::string& stage : stages) {
            if (!cancelled_in.insert(stage).second) continue;
            int later = 0;
            bool cancelled = false;
            const auto outcome = fit(*fit_case.measured, fit_case.request, [&](const Progress& now) {
                later += cancelled;
                cancelled = cancelled || now.stage == stage;
                return !cancelled;
            });
            ASSERT_FALSE(outcome) << fit_case.name << " went on after it was cancelled while " << stage;
            EXPECT_EQ(outcome.error().code, ErrorCode::cancelled) << fit_case.name << ", " << stage;
            EXPECT_EQ(later, 0) << fit_case.name << ", " << stage << ": called again once it has cancelled";
        }
    }
}

TEST(Fitter, ATokenCancelsFromAnotherThread) {
    const Measured& table = bundled("paper_white_rgb");
    const ProgressToken token([](const Progress&) { return true; });
    std::thread other([&] { token.cancel(); });
    const auto outcome = fit(table, pm(LobeCount{64}, 8), token);
    other.join();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, ErrorCode::cancelled);
}

TEST(Progress, PartsCountWithinTheWhole) {
    double last = -1;
    const ProgressToken token([&](const Progress& now) { return last = now.fraction, true; });
    EXPECT_TRUE(token.subrange(0.5, 1).subrange(0, 0.5).report("a quarter", 1));
    EXPECT_WITHIN(last, 0.75, 1e-12);
    EXPECT_TRUE(token.report("earlier", 0.1));
    EXPECT_WITHIN(last, 0.75, 1e-12) << "progress decreased";
    token.subrange(0, 1).cancel();
    EXPECT_TRUE(token.cancelled());
    EXPECT_FALSE(token.report("never", 1));
    EXPECT_TRUE(ProgressToken{}.report("to nobody", 1));
    EXPECT_FALSE(ProgressToken{}.cancelled());
}

// ---- Errors ----

TEST(Fitter, ReachesItsTargetDeltaE) {
    const Measured& paper = bundled("paper_white_rgb");
    std::size_t bytes = 0;
    for (const double delta_e : {6.0, 4.0}) {
        const auto outcome = checked(fit(paper, pm(AutomaticLobes{delta_e})));
        EXPECT_TRUE(outcome->reached);
        EXPECT_LE(outcome->against_mean->mean.delta_e, delta_e);
        EXPECT_GE(payload_bytes(outcome->model), bytes);
        bytes = payload_bytes(outcome->model);
    }
    EXPECT_LT(bytes, 208u);
    // Between samples there is no picture to compare with.
    const auto samples_fit = fit(samples(), pm(AutomaticLobes{2}));
    ASSERT_FALSE(samples_fit);
    EXPECT_EQ(samples_fit.error().code, ErrorCode::argument);
}

TEST(Fitter, RefusesInvalidRequests) {
    const Measured& table = bundled("paper_white_rgb");
    const auto code = [&](FitRequest request) {
        const auto outcome = fit(table, request);
        return outcome ? "fitted" : std::string(name(outcome.error().code));
    };
    FitRequest spectral = pm(LobeCount{2});
    spectral.spectral = true;
    EXPECT_EQ(code(spectral), "argument");
    EXPECT_EQ(code(pm(AutomaticLobes{0})), "argument");
    EXPECT_EQ(code(pm(LobeCount{65})), "argument");
    EXPECT_EQ(code(su(1)), "argument");
    FitRequest beyond_horizon = ggx();
    beyond_horizon.max_theta = 2.0;
    EXPECT_EQ(code(beyond_horizon), "argument");
    const Evaluate black = constant_brdf({0, 0, 0});
    for (const FitRequest& request : {pm(LobeCount{2}), su(32), ggx()}) {
        const auto outcome = fit(black, request);
        ASSERT_FALSE(outcome);
        EXPECT_EQ(outcome.error().code, ErrorCode::no_data);
    }
    EXPECT_EQ(load_measured("no such file").error().code, ErrorCode::unreadable);
}

TEST(ResultDeathTest, MisuseStopsInEveryBuildType) {
    const Result<int> failed = Error{"a.bsdf", {}, "header", "a magic number", "nothing"}, good = 1;
    EXPECT_DEATH((void)*failed, "a.bsdf: header: expected a magic number, found nothing");
    EXPECT_DEATH((void)good.error(), "holds a value");
    EXPECT_EQ(set_misuse_handler([](std::string_view what) { throw std::string(what); }), nullptr);
    EXPECT_THROW((void)*failed, std::string);
    EXPECT_NE(set_misuse_handler(nullptr), nullptr);
}

}  // namespace
}  // namespace srbf::fitter_test
