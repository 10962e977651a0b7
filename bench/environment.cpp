// Pictures of the raster renderer under an environment: errors against the path tracer by the number of samples, or the
// number of samples after which pictures are clean. FILE is a measurement, drawn as a table in Rusinkiewicz
// coordinates, or a model.
//   usage: environment errors|samples MESH ENVIRONMENT FILE...
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>

#include "errors/image_errors.h"
#include "extras/render/offscreen.h"
#include "extras/render/path.h"
#include "extras/render/raster.h"
#include "measured/tables.h"
#include "models/bsdf/bsdf_functions.h"
#include "srbf/convert.h"
#include "srbf/load.h"

namespace srbf {
namespace {

constexpr int k_converged = 256;
constexpr double k_clean = 0.02;  ///< mean ꟻLIP
constexpr std::array<int, 5> k_counts{1, 4, 16, 64, 256};

struct Subject {
    SampledMaterial sampled;
    PreparedBrdf brdf;
};
template <typename M> Subject subject_of(const M& model, int azimuths) {
    const MixtureProposal proposal = propose(evaluator(model), {.azimuths = azimuths});
    return {{model, proposal}, prepare(model, proposal)};
}
Subject subject_of(const AnyBrdf& brdf) {
    if (const auto* measured = std::get_if<Measured>(&brdf))
        return subject_of(to_merl(evaluator(*measured), k_merl_size), 1);
    const Model& model = std::get<Model>(brdf);
    const int azimuths = is_isotropic(model) ? 1 : k_anisotropic_azimuths;
    return std::visit(
        [&](const auto& kind) -> Subject {
            if constexpr (std::is_same_v<std::decay_t<decltype(kind)>, BsdfModel>)
                return subject_of(to_merl(evaluator(model), k_merl_size), 1);
            else
                return subject_of(kind, azimuths);
        },
        model.model);
}

/// A picture under an environment, to which samples are added one by one.
class ProgressivePicture {
  public:
    static Result<ProgressivePicture> make(const OffscreenContext& context, const Scene& scene,
                                           const Environment& environment, const SampledMaterial& sampled, int width,
                                           int height) {
        auto light = RasterEnvironment::make(environment);
        if (!light) return light.error();
        auto surface = RasterSurface::make(context.dialect(), width, height, RasterSurface::Points::four);
        if (!surface) return surface.error();
        auto material = RasterMaterial::make(sampled.material, {.dialect = context.dialect(), .environment = true});
        if (!material) return material.error();
        material->set_proposal(sampled.proposal);
        auto mean = RasterMean::make(*surface);
        if (!mean) return mean.error();
        return ProgressivePicture{
            scene, *std::move(light), *std::move(surface), *std::move(material), *std::move(mean), width, height};
    }
    void restart() { mean_.restart(); }
    void add(LightDraws draws) {
        const RasterView view{.camera = scene_.camera,
                              .aspect = double(width_) / height_,
                              .lights = {},
                              .shift = sample_shift(mean_.samples(), width_, height_)};
        surface_.draw(mesh_, view);
        mean_.add(material_, surface_, view, {&light_, environment_frame(scene_.camera), draws});
    }
    Image read() const {
        Image image(width_, height_);
        const auto pixels = mean_.picture().read_floats();
        for (std::size_t i = 0; i < pixels.size(); ++i) image.pixels[i] = {pixels[i][0], pixels[i][1], pixels[i][2]};
        return image;
    }

  private:
    ProgressivePicture(const Scene& scene, RasterEnvironment light, RasterSurface surface, RasterMaterial material,
                       RasterMean mean, int width, int height)
        : scene_(scene),
          mesh_(scene.mesh),
          light_(std::move(light)),
          surface_(std::move(surface)),
          material_(std::move(material)),
          mean_(std::move(mean)),
          width_(width),
          height_(height) {}
    const Scene& scene_;
    RasterMesh mesh_;
    RasterEnvironment light_;
    RasterSurface surface_;
    RasterMaterial material_;
    RasterMean mean_;
    int width_, height_;
};

Image8 display(const Image& image, float exposure) {
    return shown({image, std::vector<float>(image.pixels.size(), 1)}, exposure);
}

/// PSNR against the path tracer, by strategy and number of samples.
Result<Done> print_errors(const OffscreenContext& context, const Mesh& mesh, const Environment& environment,
                          const Subject& subject, const std::string& name) {
    constexpr int width = 96, height = 72;
    const Scene scene = scene_of(mesh, {}, double(width) / height);
    const PathScene paths{{{&scene.mesh, 0}}, {subject.brdf}, scene.camera, {}, {}, &environment};
    const Image reference =
        render_paths(paths, {.width = width, .height = height, .samples = 8192, .occlusion = false, .progress = {}})
            .rendering.radiance;
    const float exposure = automatic_exposure(reference);
    const Image8 expected = display(reference, exposure);
    auto progress = ProgressivePicture::make(context, scene, environment, subject.sampled, width, height);
    if (!progress) return progress.error();
    for (const auto& [title, draws] : {std::pair("both", LightDraws::both),
                                       {"BRDF alone", LightDraws::material},
                                       {"environment alone", LightDraws::light}}) {
        fmt::print("| {} | {} |", name, title);
        progress->restart();
        for (int i = 1; i <= k_counts.back(); ++i) {
            progress->add(draws);
            if (std::ranges::find(k_counts, i) != k_counts.end()) {
                const auto [psnr, ssim, flip] = likeness(expected, display(progress->read(), exposure));
                fmt::print(" {:.1f}, {:.3f} |", psnr, flip);
            }
        }
        fmt::print("\n");
        std::fflush(stdout);
    }
    return Done{};
}

/// Samples until the picture differs by less than `k_clean` from the converged one.
Result<Done> print_samples(const OffscreenContext& context, const Mesh& mesh, const Environment& environment,
                           const Subject& subject, const std::string& name) {
    constexpr int width = 640, height = 480;
    const Scene scene = scene_of(mesh, {}, double(width) / height);
    auto progress = ProgressivePicture::make(context, scene, environment, subject.sampled, width, height);
    if (!progress) return progress.error();
    progress->add(LightDraws::both);
    progress->restart();
    const auto start = std::chrono::steady_clock::now();
    std::vector<Image> means;
    for (int i = 1; i <= k_converged; ++i) {
        progress->add(LightDraws::both);
        if (i <= 64) means.push_back(progress->read());
    }
    const Image converged = progress->read();
    const double seconds_per_sample =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / k_converged;
    const float exposure = automatic_exposure(converged);
    const Image8 expected = display(converged, exposure);
    const auto flip = [&](const Image& image) { return likeness(expected, display(image, exposure)).flip; };
    const auto clean = std::ranges::find_if(means, [&](const Image& mean) { return flip(mean) < k_clean; });
    fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} | {} | {:.0f} |\n", name, flip(means[0]),
               flip(means[k_first_samples - 1]), flip(means[15]),
               clean == means.end() ? "> 64" : std::to_string(clean - means.begin() + 1), 1000 * seconds_per_sample);
    std::fflush(stdout);
    return Done{};
}

Result<Done> print_tables(const std::vector<std::string>& arguments) {
    const auto mesh = load_mesh(arguments[1]);
    if (!mesh) return mesh.error();
    const auto environment = load_environment(arguments[2]);
    if (!environment) return environment.error();
    const auto context = OffscreenContext::make();
    if (!context) return context.error();
    fmt::print("{}\n\n", context->renderer());
    std::vector<std::pair<std::string, Subject>> subjects;
    for (std::size_t i = 3; i < arguments.size(); ++i) {
        const auto brdf = load_brdf(arguments[i]);
        if (!brdf) return brdf.error();
        subjects.emplace_back(std::filesystem::path(arguments[i]).stem().string(), subject_of(*brdf));
    }
    if (arguments[0] == "errors") {
        fmt::print("| PSNR [dB], ꟻLIP | draws | {} |\n|---|---|---|---|---|---|---|\n", fmt::join(k_counts, " | "));
        for (const auto& [name, subject] : subjects)
            if (const auto done = print_errors(*context, *mesh, *environment, subject, name); !done) return done;
        return Done{};
    }
    fmt::print(
        "| 640 × 480, ꟻLIP | 1 sample | {} | 16 | samples until {} | a sample [ms] |\n|---|---|---|---|---|---|\n",
        k_first_samples, k_clean);
    for (const auto& [name, subject] : subjects)
        if (const auto done = print_samples(*context, *mesh, *environment, subject, name); !done) return done;
    return Done{};
}

}  // namespace
}  // namespace srbf

int main(int argc, char** argv) {
    if (argc < 5) return fmt::print(stderr, "usage: environment errors|samples MESH ENVIRONMENT FILE...\n"), 2;
    if (const auto printed = srbf::print_tables({argv + 1, argv + argc}); !printed) {
        fmt::print(stderr, "{}\n", srbf::message(printed.error()));
        return 1;
    }
    return 0;
}
