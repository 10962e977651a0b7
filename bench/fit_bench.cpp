// What a fit costs: seconds from a loaded measurement to a rounded model, and the squared error ratio that it reaches on
// pairs of directions that it has not seen, on the bundled measurements.
#include <benchmark/benchmark.h>

#include <string>

#include "srbf/fit.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"

namespace srbf {
namespace {

void fit(benchmark::State& state, const std::string& name) {
    const Measured measured = *load_measured(std::string(SRBF_SOURCE_DIR) + "/data/" + name);
    FitOptions options;
    options.form = PmForm(state.range(0));
    options.lobes = int(state.range(1));
    options.variates = int(state.range(2));
    options.threads = int(state.range(3));
    const ObserveOptions observing{.objective = Objective::raw};
    PmModel model;
    for (auto _ : state) model = fit_pm(*observe(signed_evaluator(measured), observing), options)->model;
    const Evaluate others[] = {evaluator(model)};
    const MeasureOptions within{default_max_theta(observing.objective), 0};
    state.counters["error_percent"] = 100 * measure_heldout(evaluator(measured), others, within)[0].squared_error_ratio;
    state.counters["bytes"] = double(payload_bytes(model));
}

void sizes(benchmark::internal::Benchmark* benchmark) {
    benchmark->ArgNames({"form", "J", "N", "threads"})->Unit(benchmark::kMillisecond)->UseRealTime();
    for (const int form : {0, 1, 2})
        for (const auto& [lobes, variates] : {std::pair(4, 3), {6, 3}, {8, 4}, {16, 4}})
            benchmark->Args({form, lobes, variates, 2});
    benchmark->Args({2, 8, 4, 1});
}
BENCHMARK_CAPTURE(fit, paper_white, std::string("paper_white_rgb.bsdf"))->Apply(sizes);
BENCHMARK_CAPTURE(fit, cc_ibiza_sunset, std::string("cc_ibiza_sunset_rgb.bsdf"))->Apply(sizes);

}  // namespace
}  // namespace srbf
