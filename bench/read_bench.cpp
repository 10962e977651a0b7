// These benchmarks time how long it takes to read files of the databases' sizes, from memory and on one thread.
#include <benchmark/benchmark.h>

#include "srbf/convert.h"
#include "srbf/file.h"

namespace srbf {
namespace {

void read_bytes(benchmark::State& state, const std::vector<std::byte>& bytes) {
    for (auto _ : state) {
        auto measured = read_measured(bytes, "f");
        if (!measured) return state.SkipWithError(message(measured.error()).c_str());
        benchmark::DoNotOptimize(measured);
    }
    state.SetBytesProcessed(std::int64_t(state.iterations()) * std::int64_t(bytes.size()));
}

/// A table of the database's size, 34,992,012 bytes.
void merl(benchmark::State& state) {
    MerlTable table;
    table.size = k_merl_size;
    table.cells.assign(90 * 90 * 180, Rgb{0.1f, 0.2f, 0.3f});
    read_bytes(state, write_merl(table));
}
BENCHMARK(merl)->Unit(benchmark::kMillisecond);

/// A bundled measurement, 658,952 bytes.
void rgl(benchmark::State& state) {
    const auto bytes = read_file(SRBF_SOURCE_DIR "/data/cc_ibiza_sunset_rgb.bsdf");
    if (!bytes) return state.SkipWithError(message(bytes.error()).c_str());
    read_bytes(state, *bytes);
}
BENCHMARK(rgl)->Unit(benchmark::kMillisecond);

/// 100,000 samples of three colours.
void csv(benchmark::State& state) {
    const Evaluate grey = [](auto, auto, std::span<Rgb> f) { std::fill(f.begin(), f.end(), Rgb{0.1f, 0.2f, 0.3f}); };
    const std::string text = write_csv(to_samples(grey, true, 317, 89 * k_degree));
    const auto bytes = as_bytes(text);
    read_bytes(state, {bytes.begin(), bytes.end()});
}
BENCHMARK(csv)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace srbf
