#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <span>

#include "app/commands.h"
#include "app/load.h"
#include "app/raster.h"
#include "app/report.h"
#include "render/image.h"
#include "render/scene.h"

namespace srbf {
namespace {

struct RenderCommand {
    std::vector<std::string> files;
    std::string renderer, mesh = "sphere", up = "y", output;
    int width = 640, height = 480;  ///< of each picture

    int run() const;
};

/// A renderer: pictures of the scene, one for each subject.
struct Renderer {
    std::string_view name;
    Result<std::vector<Rendering>> (*render)(const Scene& scene, std::span<const Subject> subjects,
                                             const RenderCommand& options);
};

Result<std::vector<Rendering>> render_raster(const Scene& scene, std::span<const Subject> subjects,
                                             const RenderCommand& options) {
    return rasterize(scene, subjects, options.width, options.height);
}

/// The first is the default.
constexpr std::array<Renderer, 1> k_renderers{{{"raster", render_raster}}};

int RenderCommand::run() const {
    std::vector<std::string> inputs = files, captions;
    std::vector<Subject> subjects;
    for (const std::string& file : files) {
        auto subject = load(file);
        if (!subject) return complain(subject.error());
        subjects.push_back(*std::move(subject));
        captions.push_back(std::filesystem::path(file).filename().string());
    }
    auto loaded = load_mesh(mesh);
    if (!loaded) return complain(loaded.error());
    inputs.push_back(mesh);
    if (const auto writable = check_outputs(inputs, {output}); !writable) return complain(writable.error());

    const Viewpoint viewpoint{.z_up = up == "z"};
    const Scene scene = scene_of(*std::move(loaded), viewpoint, double(width) / height);
    const auto chosen = std::ranges::find(k_renderers, renderer, &Renderer::name);
    const auto renderings = chosen->render(scene, subjects, *this);
    if (!renderings) return complain(renderings.error());

    // All at the exposure of the first, so that they can be compared.
    const float exposure = automatic_exposure(renderings->front().radiance);
    std::vector<Image8> images;
    for (const Rendering& rendering : *renderings) images.push_back(shown(rendering, exposure));
    const auto written = write_png(side_by_side(images, captions), output);
    return written ? k_done : complain(written.error());
}

/// "WxH", each from 1 to `k_most_pixels`.
constexpr int k_most_pixels = 8192;
CLI::Validator size_in_pixels(int& width, int& height) {
    return {[&](std::string& text) -> std::string {
                const auto number = [](std::string_view word) {
                    int n = 0;
                    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), n);
                    return error == std::errc() && rest == word.data() + word.size() && n <= k_most_pixels ? n : 0;
                };
                const std::string_view all = text;
                const auto by = std::min(all.find('x'), all.size());
                width = number(all.substr(0, by)), height = number(all.substr(std::min(by + 1, all.size())));
                if (width >= 1 && height >= 1) return {};
                return fmt::format("expected WxH, each from 1 to {}, found {}", k_most_pixels, text);
            },
            ""};
}

}  // namespace

void add_render(CLI::App& app, int& status) {
    const auto command = std::make_shared<RenderCommand>();
    std::vector<std::string> names;
    for (const Renderer& renderer : k_renderers) names.emplace_back(renderer.name);
    command->renderer = names.front();
    CLI::App* sub = app.add_subcommand("render", "Pictures of a mesh made of the materials, side by side");
    sub->add_option("FILE", command->files, "Measurements and models, a picture each")->type_name("")->required();
    sub->add_option("--renderer", command->renderer, fmt::format("{}", fmt::join(names, " or ")))
        ->type_name("NAME")
        ->check(one_of(names))
        ->capture_default_str();
    sub->add_option("--mesh", command->mesh, "A .ply or .obj file, or sphere or knot")
        ->type_name("FILE")
        ->capture_default_str();
    sub->add_option("--up", command->up, "The mesh's axis that points upwards, y or z")
        ->type_name("AXIS")
        ->check(one_of({"y", "z"}))
        ->capture_default_str();
    sub->add_option("--size", "Pixels of each picture (640x480)")
        ->type_name("WxH")
        ->check(size_in_pixels(command->width, command->height));
    sub->add_option("-o,--output", command->output, "The PNG to write")
        ->type_name("FILE.png")
        ->required()
        ->check(png_name());
    sub->footer("Example:\n  srbf render paper_white_rgb.bsdf paper_white_rgb.srbf --mesh knot -o paper.png");
    sub->callback([command, &status] { status = command->run(); });
}

}  // namespace srbf
