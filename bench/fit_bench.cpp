// These benchmarks time fits of the bundled measurements. They print the milliseconds from a loaded measurement to a
// rounded model and for each stage, and the squared error ratio at held-out pairs. The last ones call the default fit
// and the view-by-view fit in a process's initial floating-point mode and in a mode that flushes subnormal numbers.
#include <benchmark/benchmark.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "brdf/values.h"
#include "errors/measures.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

void fit(benchmark::State& state, const std::string& name) {
    const Measured measured = *load_measured(std::string(SRBF_SOURCE_DIR) + "/data/" + name);
    PmFitOptions options;
    options.form = PmForm(state.range(0));
    options.lobes = int(state.range(1));
    options.variates = int(state.range(2));
    options.axial = state.range(3) != 0;
    options.threads = int(state.range(4));
    const ObserveOptions observing{.objective = Objective::raw, .threads = options.threads};
    PmModel model;
    std::map<std::string, double> milliseconds;  // for each stage, which ends at a progress report
    for (auto _ : state) {
        using Clock = std::chrono::steady_clock;
        auto last = Clock::now();
        const auto lap = [&](std::string_view stage) {
            const auto now = Clock::now();
            milliseconds[std::string(stage.substr(0, stage.find(' ')))] +=
                std::chrono::duration<double, std::milli>(now - last).count();
            last = now;
        };
        const Observations observations = *observe(signed_evaluator(measured), observing);
        lap("observing");
        model = fit_pm(observations, options, [&](const Progress& progress) {
                    lap(progress.stage);
                    return true;
                })->model;
    }
    for (const auto& [stage, time] : milliseconds)
        state.counters[stage] = benchmark::Counter(time, benchmark::Counter::kAvgIterations);
    const Evaluate others[] = {evaluator(model)};
    const MeasureOptions within{default_max_theta(observing.objective), 0};
    state.counters["error_percent"] =
        100 * measure_heldout(rgb_channels(evaluator(measured)), rgb_channels(others), within)[0].squared_error_ratio;
    state.counters["bytes"] = double(payload_bytes(model));
}

void sizes(benchmark::internal::Benchmark* benchmark) {
    benchmark->ArgNames({"form", "J", "N", "axial", "threads"})->Unit(benchmark::kMillisecond)->UseRealTime();
    for (const int form : {0, 1, 2})  // gaussian, horizon, extended
        for (const auto& [lobes, variates] : {std::pair(4, 3), {6, 3}, {8, 4}, {16, 4}})
            benchmark->Args({form, lobes, variates, 1, 2});
    benchmark->Args({2, 8, 4, 1, 1});
    benchmark->Args({0, 8, 4, 0, 2})->Args({2, 8, 4, 0, 2});
}
BENCHMARK_CAPTURE(fit, paper_white, std::string("paper_white_rgb.bsdf"))->Apply(sizes);
BENCHMARK_CAPTURE(fit, cc_ibiza_sunset, std::string("cc_ibiza_sunset_rgb.bsdf"))->Apply(sizes);

/// Takes subnormal numbers for 0 on x86 while it exists, as callers may have set; has no effect elsewhere.
class FlushingArithmetic {
#if defined(__SSE__)
  public:
    FlushingArithmetic() { _mm_setcsr(before_ | 0x8040); }
    ~FlushingArithmetic() { _mm_setcsr(before_); }
    FlushingArithmetic(const FlushingArithmetic&) = delete;
    FlushingArithmetic& operator=(const FlushingArithmetic&) = delete;

  private:
    const unsigned before_ = _mm_getcsr();
#endif
};

/// The caller has a process's initial mode, or a mode that flushes subnormal numbers.
void callers_mode(benchmark::State& state, const std::string& name) {
    const Measured measured = *load_measured(std::string(SRBF_SOURCE_DIR) + "/data/" + name);
    std::optional<FlushingArithmetic> mode;
    if (state.range(0) != 0) mode.emplace();
    for (auto _ : state) {
        if (state.range(1) != 0)
            benchmark::DoNotOptimize(fit_su(*tabulate(signed_evaluator(measured)), {.lobes = 5}));
        else
            benchmark::DoNotOptimize(fit_pm(*observe(signed_evaluator(measured), {}), {}));
    }
}
BENCHMARK_CAPTURE(callers_mode, cc_ibiza_sunset, std::string("cc_ibiza_sunset_rgb.bsdf"))
    ->ArgNames({"flushing", "su"})
    ->ArgsProduct({{0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace srbf
