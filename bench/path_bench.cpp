// These benchmarks time a path-traced picture of the ball on its ground in the bundled studio: 256 × 192 pixels, 4
// paths per pixel of at most 8 bounces, on one thread. The material is the bundled vinyl film: its fit of form
// extended, its view-by-view fit, the measurement, and a table of MERL's layout. `evaluation_percent` is the fraction
// of time for f, measured as the time that a second evaluation of each f adds. Other benchmarks give the ns for a
// sample and a density of the proposals, and the time to make proposals.
#include <benchmark/benchmark.h>

#include <ctime>

#include "brdf/directions.h"
#include "extras/render/path.h"
#include "measured/tables.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "one_target.h"
#include "srbf/convert.h"
#include "srbf/measured.h"

namespace srbf {
namespace {

constexpr int k_width = 256, k_height = 192, k_samples = 4;

const Measured& film() {
    static const Measured measured = *load_measured(SRBF_SOURCE_DIR "/data/cc_ibiza_sunset_rgb.bsdf");
    return measured;
}
const MerlTable& film_as_merl() {
    static const MerlTable table = to_merl(evaluator(film()));
    return table;
}
const PmModel& film_pm() {
    static const PmModel model = fit_pm(*observe(signed_evaluator(film()), {}), {})->model;
    return model;
}
const SuModel& film_su() {
    static const SuModel model = fit_su(*tabulate(signed_evaluator(film())), {.lobes = 5})->model;
    return model;
}

double seconds_of(const PathScene& scene, std::uint64_t& rays) {
    const std::clock_t start = std::clock();  // processor time, since other processes may run
    rays =
        render_paths(scene, {.width = k_width, .height = k_height, .samples = k_samples, .threads = 1, .progress = {}})
            .rays;
    return double(std::clock() - start) / CLOCKS_PER_SEC;
}

/// A BRDF that evaluates each value twice.
struct EvaluatedTwice {
    PreparedBrdf brdf;
};
Rgb value(const EvaluatedTwice& twice, Vec3f wl, Vec3f wv) {
    benchmark::DoNotOptimize(value(twice.brdf, wl, wv));
    return value(twice.brdf, wl, wv);
}

void path(benchmark::State& state, const PreparedBrdf& brdf) {
    static const Environment studio = *load_environment("studio");
    static const Mesh mesh = ball();
    const Camera camera = camera_of(mesh, {}, double(k_width) / k_height);
    const Mesh ground = ground_below(mesh, camera.up);
    PathScene scene{{{&mesh, 0}, {&ground, 1}}, {brdf, diffuse({0.35f, 0.35f, 0.35f})}, camera, {}, {}, &studio};
    PathScene twice = scene;
    twice.materials[0] = prepare(EvaluatedTwice{brdf}, proposal(brdf));
    std::uint64_t rays = 0;
    double once_best = 1e30, twice_best = 1e30;
    for (auto _ : state) {
        once_best = std::min(once_best, seconds_of(scene, rays));
        state.PauseTiming();
        twice_best = std::min(twice_best, seconds_of(twice, rays));
        state.ResumeTiming();
    }
    state.counters["Mrays/s"] = double(rays) / once_best / 1e6;
    state.counters["Msamples/s"] = double(k_width) * k_height * k_samples / once_best / 1e6;
    state.counters["evaluation_percent"] = 100 * (twice_best - once_best) / once_best;
}
void path_pm(benchmark::State& state) { path(state, prepare(Model{film_pm(), {}}, ProposeOptions{})); }
void path_pm_by_cosine(benchmark::State& state) { path(state, prepare(Model{film_pm(), {}}, CosineProposal{})); }
void path_su(benchmark::State& state) { path(state, prepare(Model{film_su(), {}}, ProposeOptions{})); }
void path_rgl(benchmark::State& state) { path(state, prepare(film(), ProposeOptions{})); }
void path_merl(benchmark::State& state) { path(state, prepare(film_as_merl(), propose(evaluator(film_as_merl())))); }
BENCHMARK(path_pm)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(path_pm_by_cosine)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(path_su)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(path_rgl)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(path_merl)->Unit(benchmark::kMillisecond)->Iterations(5);

struct Samples {
    std::vector<Vec3f> wv, u, wl;
};
const Samples& samples() {
    static const Samples all = [] {
        std::mt19937_64 random(1);
        const MirrorMixture cap(80 * k_degree);
        Samples sampled;
        const auto number = [&] { return float(uniform(random)); };
        for (int i = 0; i < 4096; ++i) {
            const double a = uniform(random), b = uniform(random);
            sampled.wv.push_back(to_float(cap.sample_cap(a, b)));
            sampled.wl.push_back(to_float(cap.sample_cap(b, a)));
            const float x = number(), y = number(), z = number();
            sampled.u.push_back({x, y, z});
        }
        return sampled;
    }();
    return all;
}
/// Times call(wl, wv, u), whose result is kept, at these samples in turn.
template <typename Call> void for_samples(benchmark::State& state, const Call& call) {
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(call(samples().wl[i], samples().wv[i], samples().u[i]));
        i = (i + 1) % samples().u.size();
    }
}
template <typename P> void draw_one(benchmark::State& state, const P& proposal) {
    for_samples(state, [&](Vec3f, Vec3f wv, Vec3f u) { return sample(proposal, wv, {u.x, u.y}, u.z); });
}
template <typename P> void density_of_one(benchmark::State& state, const P& proposal) {
    for_samples(state, [&](Vec3f wl, Vec3f wv, Vec3f) { return pdf(proposal, wl, wv); });
}
/// Draws a sample and computes its density in one call, as path tracing does.
template <typename P> void draw_and_density_of_one(benchmark::State& state, const P& proposal) {
    for_samples(state, [&](Vec3f, Vec3f wv, Vec3f u) { return sample_with_pdf(proposal, wv, {u.x, u.y}, u.z); });
}
void value_and_density_of_pm(benchmark::State& state) {
    const PreparedBrdf brdf = prepare(Model{film_pm(), {}}, ProposeOptions{});
    for_samples(state, [&](Vec3f wl, Vec3f wv, Vec3f) { return std::pair(value(brdf, wl, wv), pdf(brdf, wl, wv)); });
}
void value_pdf_of_pm(benchmark::State& state) {
    const PreparedBrdf brdf = prepare(Model{film_pm(), {}}, ProposeOptions{});
    for_samples(state, [&](Vec3f wl, Vec3f wv, Vec3f) { return value_pdf(brdf, wl, wv); });
}
BENCHMARK(value_and_density_of_pm);
BENCHMARK(value_pdf_of_pm);

/// Benchmarks of a mixture for each instruction set of this machine.
const bool k_registered = [] {
    for (const Target target : hwy::SupportedAndGeneratedTargets()) {
        const auto add = [&](const char* name, auto run) {
            benchmark::RegisterBenchmark((name + std::string("_mixture/") + hwy::TargetName(target)).c_str(),
                                         [=](benchmark::State& state) {
                                             const OneTarget one(target);
                                             run(state, propose(evaluator(film_pm())));
                                         });
        };
        using State = benchmark::State;
        add("draw", [](State& state, const auto& proposal) { draw_one(state, proposal); });
        add("density", [](State& state, const auto& proposal) { density_of_one(state, proposal); });
        add("draw_and_density", [](State& state, const auto& proposal) { draw_and_density_of_one(state, proposal); });
    }
    return true;
}();
void draw_su(benchmark::State& state) { draw_one(state, propose(film_su())); }
void density_su(benchmark::State& state) { density_of_one(state, propose(film_su())); }
BENCHMARK(draw_su);
BENCHMARK(density_su);

void make_mixture_of_pm(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(propose(evaluator(film_pm())));
}
void make_mixture_of_rgl(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(propose(evaluator(film())));
}
void make_proposal_of_su(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(propose(film_su()));
}
BENCHMARK(make_mixture_of_pm)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(make_mixture_of_rgl)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(make_proposal_of_su)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace srbf
