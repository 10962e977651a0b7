// These benchmarks time a value, a density, both in one call, and a sample with density and weight. They compare the
// library, srbf_runtime.h, and exported C, which gcc and clang compile for any x86-64 and for AVX2. The models are the
// default fit of the bundled vinyl film and its fit as measured. The library is also timed with each instruction set of
// this machine, for default fits of the five RGL files, for fits of the film as measured and by Lambert with one and
// two GGX lobes, and for the film's table. Pairs are random, up to 80° from the normal. A thousand are timed together,
// so the microseconds of all are the nanoseconds of one. `min` is the shortest of fifteen runs. gcc and clang compile loops.c.
#include <benchmark/benchmark.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <list>
#include <numbers>
#include <random>

#include "one_target.h"
#include "srbf/fit.h"
#include "srbf/measured.h"
#include "srbf/model.h"
#include "srbf/prepared.h"
#include "srbf/shading_code.h"
#include "temporary_folder.h"

namespace srbf {
namespace {

constexpr int k_pairs = 1000;
struct Pairs {
    std::vector<Vec3f> wl, wv, u;
    std::vector<float> results = std::vector<float>(k_pairs);
};
Pairs& pairs() {
    static Pairs all = [] {
        Pairs drawn;
        std::mt19937 random(1);
        std::uniform_real_distribution<float> uniform(0, 1);
        const auto direction = [&] {
            const float z = 0.17f + 0.83f * uniform(random), phi = 2 * std::numbers::pi_v<float> * uniform(random);
            return Vec3f(std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z);
        };
        for (int i = 0; i < k_pairs; ++i) {
            drawn.wl.push_back(direction());
            drawn.wv.push_back(direction());
            const float x = uniform(random), y = uniform(random), z = uniform(random);
            drawn.u.push_back({x, y, z});
        }
        return drawn;
    }();
    return all;
}

/// A function that stores one number for each pair. `first` has wl, or u for samples.
using Run = void (*)(const void* brdf, int count, const float* first, const float* wv, float* results);
constexpr const char* k_names[] = {"value", "density", "both", "sample"};

template <typename Each> void for_pairs(int count, const float* first, const float* wv, float* results, Each each) {
    for (int i = 0; i < count; ++i, first += 3, wv += 3)
        results[i] = each(Vec3f(first[0], first[1], first[2]), Vec3f(wv[0], wv[1], wv[2]));
}
constexpr Run k_library[] = {
    [](const void* brdf, int n, const float* l, const float* v, float* to) {
        for_pairs(n, l, v, to,
                  [&](auto wl, auto wv) { return value(*static_cast<const PreparedBrdf*>(brdf), wl, wv).r; });
    },
    [](const void* brdf, int n, const float* l, const float* v, float* to) {
        for_pairs(n, l, v, to, [&](auto wl, auto wv) { return pdf(*static_cast<const PreparedBrdf*>(brdf), wl, wv); });
    },
    [](const void* brdf, int n, const float* l, const float* v, float* to) {
        for_pairs(n, l, v, to, [&](auto wl, auto wv) {
            const ValuePdf both = value_pdf(*static_cast<const PreparedBrdf*>(brdf), wl, wv);
            return both.value.r + both.pdf;
        });
    },
    [](const void* brdf, int n, const float* u, const float* v, float* to) {
        for_pairs(n, u, v, to, [&](auto number, auto wv) {
            const LightSample light =
                sample(*static_cast<const PreparedBrdf*>(brdf), wv, {number.x, number.y}, number.z);
            return light.weight.r + light.pdf;
        });
    },
};

/// `target` is an instruction set for the library, or 0 for the best.
void add(const std::string& name, std::size_t k, Run run, const void* brdf, Target target = 0) {
    benchmark::RegisterBenchmark((std::string(k_names[k]) + "/" + name).c_str(),
                                 [=](benchmark::State& state) {
                                     const OneTarget one(target);
                                     const auto& first = k == 3 ? pairs().u : pairs().wl;
                                     for (auto _ : state)
                                         run(brdf, k_pairs, &first[0].x, &pairs().wv[0].x, pairs().results.data());
                                 })
        ->Unit(benchmark::kMicrosecond)
        ->Repetitions(15)
        ->ReportAggregatesOnly()
        ->ComputeStatistics("min", [](const std::vector<double>& times) { return std::ranges::min(times); });
}

/// Adds the benchmarks of a model. Its memory for srbf_runtime.h lasts as long as the program.
void add_model(const std::string& name, const Model& model, const TemporaryFolder& folder) {
    static std::vector<PreparedBrdf> prepared;
    prepared.reserve(2);
    prepared.push_back(prepare(model, ProposeOptions{}));
    const NamedModel named{"m", &model};
    write_text(folder / "m.h",
               *shading_code(std::span(&named, 1), "m", {.language = CodeLanguage::c, .sampling = true}));
    if (!save_model(model, (folder / "m.srbf").string())) std::abort();
    const std::string bytes = read_text(folder / "m.srbf");
    std::vector<std::pair<std::string, void*>> libraries;
    for (const std::string compiler : {"gcc", "clang"})
        for (const std::string options : {"-O2", "-O2 -march=x86-64-v3"})
            for (const std::string source : {"runtime", "code"}) {
                const std::string file = (folder / (name + source + compiler + options + ".so")).string();
                const std::string command =
                    fmt::format("{} {} -shared -fPIC{} -I '{}' '{}/bench/loops.c' -o '{}' -lm", compiler, options,
                                source == "runtime" ? " -DRUNTIME" : "", (folder / "").string(), SRBF_SOURCE_DIR, file);
                if (std::system(command.c_str()) != 0) continue;
                libraries.emplace_back(name + "/" + source + "/" + compiler + " " + options,
                                       ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL));
            }
    for (std::size_t k = 0; k < std::size(k_names); ++k) {
        add(name + "/library", k, k_library[k], &prepared.back());
        for (const auto& [compiled, library] : libraries) {
            void* brdf = nullptr;
            const auto function = [&]<typename F>(F*& f, const char* symbol) {
                f = reinterpret_cast<F*>(::dlsym(library, symbol));
            };
            std::size_t (*needed)(const void*, std::size_t);
            int (*open)(const void*, std::size_t, void*, std::size_t, void**, std::size_t*);
            void (*prepare_model)(void*);
            function(needed, "srbf_memory_needed");
            function(open, "srbf_open");
            function(prepare_model, "srbf_prepare");
            if (needed) {
                const std::size_t size = needed(bytes.data(), bytes.size());
                open(bytes.data(), bytes.size(), std::malloc(size), size, &brdf, nullptr);
                prepare_model(brdf);
            }
            Run run;
            function(reinterpret_cast<std::remove_pointer_t<Run>*&>(run), k_names[k]);
            add(compiled, k, run, brdf);
        }
    }
}

/// Adds the benchmarks of a model or a measurement with each instruction set.
template <typename B> void add_library(const std::string& name, const B& brdf) {
    static std::list<PreparedBrdf> prepared;
    for (const Target target : hwy::SupportedAndGeneratedTargets()) {
        const OneTarget one(target);
        prepared.push_back(prepare(brdf, ProposeOptions{}));
        for (std::size_t k = 0; k < std::size(k_names); ++k)
            add(fmt::format("{}/library {}", name, hwy::TargetName(target)), k, k_library[k], &prepared.back(), target);
    }
}

void add_all() {
    const TemporaryFolder folder;
    write_text(folder / "srbf_runtime.h", runtime_code());
    const Measured film = *load_measured(SRBF_SOURCE_DIR "/data/cc_ibiza_sunset_rgb.bsdf");
    add_model("default", fit(film, {})->model, folder);
    const Model as_measured = fit(film, {.model = PmRequest{.form = PmForm::extended}})->model;
    add_model("measured", as_measured, folder);
    for (const char* const name :
         {"cc_ibiza_sunset", "cg_sunflower", "colodur_napoli_4f", "paper_white", "vch_golden_yellow"})
        add_library(name, *load_model(fmt::format("{}/data/gallery/{}.srbf", SRBF_SOURCE_DIR, name)));
    add_library("measured", as_measured);
    for (const int lobes : {1, 2})
        add_library(fmt::format("ggx{}", lobes), fit(film, {.model = GgxRequest{.lobes = lobes}})->model);
    add_library("table", film);
}

}  // namespace
}  // namespace srbf

int main(int count, char** arguments) {
    benchmark::Initialize(&count, arguments);
    if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
    srbf::add_all();
    benchmark::RunSpecifiedBenchmarks();
}
