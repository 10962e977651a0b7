// These benchmarks time the stages of the view-by-view model, for the bundled vinyl film with objective raw and 1536
// directions: the raw matrix, the stages of the fit, writing the file, building the index texture, and evaluation.
#include <benchmark/benchmark.h>

#include <chrono>
#include <map>
#include <string>

#include "brdf/values.h"
#include "errors/measures.h"
#include "models/su/fit_su.h"
#include "models/su/su_functions.h"
#include "random_pairs.h"
#include "srbf/measured.h"
#include "srbf/metrics.h"
#include "srbf/model.h"

namespace srbf {
namespace {

using Clock = std::chrono::steady_clock;

const Measured& measured() {
    static const Measured film = *load_measured(SRBF_SOURCE_DIR "/data/cc_ibiza_sunset_rgb.bsdf");
    return film;
}
const RawMatrix& matrix() {
    static const RawMatrix raw = *tabulate(signed_evaluator(measured()));
    return raw;
}
SuFitOptions options_of(int lobes, int threads) {
    return {.lobes = lobes, .objective = Objective::raw, .threads = threads};
}
const SuModel& model() {
    static const SuModel fitted = fit_su(matrix(), options_of(5, 0))->model;
    return fitted;
}

void tabulate_matrix(benchmark::State& state) {
    for (auto _ : state)
        benchmark::DoNotOptimize(tabulate(signed_evaluator(measured()), {.threads = int(state.range(0))}));
}
BENCHMARK(tabulate_matrix)->ArgName("threads")->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Fits the raw matrix and encodes the model. The counters are milliseconds between progress reports of each stage.
void fit(benchmark::State& state) {
    std::map<std::string, double> stages;
    SuModel fitted;
    for (auto _ : state) {
        auto last = Clock::now();
        const auto result =
            fit_su(matrix(), options_of(int(state.range(0)), int(state.range(1))), [&](const Progress& progress) {
                const auto now = Clock::now();
                stages[std::string(progress.stage)] += 1e3 * std::chrono::duration<double>(now - last).count();
                last = now;
                return true;
            });
        fitted = result->model;
        benchmark::DoNotOptimize(write_model({fitted, {}}));
    }
    for (const auto& [stage, milliseconds] : stages)
        state.counters[stage] = benchmark::Counter(milliseconds, benchmark::Counter::kAvgIterations);
    const Evaluate others[] = {evaluator(fitted)};
    state.counters["error_percent"] = 100 * measure_matrix(rgb_channels(evaluator(measured())), rgb_channels(others),
                                                           {80 * k_degree, 0}, fitted.direction)[0]
                                                .squared_error_ratio;
}
BENCHMARK(fit)
    ->ArgNames({"J", "threads"})
    ->ArgsProduct({{2, 4, 5, 8}, {2}})
    ->Args({5, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void write_file(benchmark::State& state) {
    const Model any{model(), {}};
    for (auto _ : state) benchmark::DoNotOptimize(write_model(any));
}
BENCHMARK(write_file)->Unit(benchmark::kMillisecond);

void build_index(benchmark::State& state) {
    const auto map = DirectionMap(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(index_texture(model(), map));
    state.SetLabel(std::string(name(map)));
}
BENCHMARK(build_index)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();

constexpr std::size_t k_pairs = 1 << 14;

// Evaluation, in ns per pair: single pairs, arrays of unrelated pairs, and arrays of pairs with the same view.
void evaluate_pair(benchmark::State& state) {
    SuModel su = model();
    su.interpolation = SuInterpolation(state.range(0));
    const Pairs pairs = random_pairs(k_pairs);
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(value(su, pairs.wl[i], pairs.wv[i]));
        i = (i + 1) % pairs.wl.size();
    }
    state.SetLabel(std::string(name(su.interpolation)));
}
BENCHMARK(evaluate_pair)->Arg(0)->Arg(1);

void evaluate_array(benchmark::State& state) {
    SuModel su = model();
    su.interpolation = SuInterpolation(state.range(0));
    Pairs pairs = random_pairs(k_pairs);
    if (state.range(1) == 1) std::fill(pairs.wv.begin(), pairs.wv.end(), pairs.wv[0]);
    std::vector<Rgb> f(pairs.wl.size());
    for (auto _ : state) {
        evaluate(su, pairs.wl, pairs.wv, f);
        benchmark::DoNotOptimize(f.data());
    }
    state.counters["per_pair"] = benchmark::Counter(
        double(f.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    state.SetLabel(std::string(name(su.interpolation)));
}
BENCHMARK(evaluate_array)->ArgNames({"interpolation", "one_view"})->ArgsProduct({{0, 1}, {0, 1}});

}  // namespace
}  // namespace srbf
