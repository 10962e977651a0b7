// These benchmarks time one evaluation of models by kernel.glsl and of tables. The column Time has the ns for the RGB
// value of one pair of directions on one thread. Random pairs access all of a table, as a path tracer does.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <variant>
#include <vector>

#include "measured/tables.h"
#include "models.h"
#include "models/ggx/ggx_kind.h"
#include "one_target.h"
#include "random_pairs.h"
#include "srbf/measured.h"
#include "srbf/model.h"
#include "srbf/models/ggx.h"
#include "srbf/prepared.h"

namespace srbf {
namespace {

/// A table of the database's size without masked cells.
MerlTable merl_table() {
    MerlTable table;
    table.size = {90, 90, 180};
    for (std::size_t i = 0; i < 90 * 90 * 180; ++i) {
        const float f = 1 + float(i % 97) / 97;
        table.cells.push_back({f, 0.5f * f, 0.25f * f});
    }
    return table;
}

template <Brdf B> void evaluate(benchmark::State& state, const B& brdf) {
    constexpr std::size_t count = 1 << 16;
    static const Pairs pairs = random_pairs(count);
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(value(brdf, pairs.wl[i], pairs.wv[i]));
        i = (i + 1) % count;
    }
}

PmModel model_of(const benchmark::State& state) {
    std::mt19937_64 random(2);
    return random_model(random, {.axial = state.range(3) != 0,
                                 .lobes = int(state.range(1)),
                                 .variates = int(state.range(2)),
                                 .max_bandwidth = 1000,
                                 .form = PmForm(state.range(0))});
}
void sizes(benchmark::internal::Benchmark* benchmark) {
    benchmark->ArgNames({"form", "J", "N", "axial"});     // form: 0 gaussian, 1 horizon, 2 extended, 3 reciprocal
    benchmark->Args({int(PmForm::reciprocal), 9, 3, 1});  // the default
    for (const int axial : {1, 0})
        for (const int form : {0, 1, 2})
            for (const auto& [lobes, variates] : {std::pair(6, 3), {8, 4}, {16, 4}})
                benchmark->Args({form, lobes, variates, axial});
}

void pm(benchmark::State& state) { evaluate(state, model_of(state)); }
BENCHMARK(pm)->Apply(sizes);

/// A prepared model, pair by pair, with one of the instruction sets of this machine.
void pm_prepared(benchmark::State& state, Target target) {
    const OneTarget one(target);
    evaluate(state, prepare(Model{model_of(state), {}}, CosineProposal{}));
}

/// Evaluation in batches; "per_pair" is the time for one pair.
void evaluate_batches(benchmark::State& state, const Evaluate& brdf) {
    constexpr std::size_t count = 1 << 12;
    const Pairs pairs = random_pairs(count);
    std::vector<Rgb> f(count);
    for (auto _ : state) {
        brdf(pairs.wl, pairs.wv, f);
        benchmark::DoNotOptimize(f.data());
    }
    state.counters["per_pair"] =
        benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void pm_batch(benchmark::State& state, Target target) {
    const OneTarget one(target);
    const PmModel model = model_of(state);
    evaluate_batches(state, evaluator(model));
}
const bool k_registered = [] {
    for (const Target target : hwy::SupportedAndGeneratedTargets()) {
        const std::string name = hwy::TargetName(target);
        sizes(benchmark::RegisterBenchmark(("pm_prepared/" + name).c_str(), pm_prepared, target));
        sizes(benchmark::RegisterBenchmark(("pm_batch/" + name).c_str(), pm_batch, target));
    }
    return true;
}();

void merl(benchmark::State& state) {
    static const MerlTable table = merl_table();
    evaluate(state, table);
}
BENCHMARK(merl);

void ggx(benchmark::State& state) {
    static const GgxModel model{{0.2f, 0.1f, 0.05f}, {{0.2f, {0.05f, 0.05f, 0.05f}, 1}}};
    evaluate(state, model);
}
BENCHMARK(ggx);

void rgl(benchmark::State& state) {
    static const auto measured = load_measured(SRBF_SOURCE_DIR "/data/cc_ibiza_sunset_rgb.bsdf");
    if (!measured) return state.SkipWithError(message(measured.error()).c_str());
    evaluate(state, std::get<RglTable>(measured->table));
}
BENCHMARK(rgl);

void rgl_batch(benchmark::State& state) {
    static const auto measured = load_measured(SRBF_SOURCE_DIR "/data/cc_ibiza_sunset_rgb.bsdf");
    if (!measured) return state.SkipWithError(message(measured.error()).c_str());
    evaluate_batches(state, evaluator(*measured));
}
BENCHMARK(rgl_batch);

}  // namespace
}  // namespace srbf
