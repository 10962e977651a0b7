#include <memory>

#include "app/commands.h"
#include "app/load.h"
#include "app/memory.h"
#include "app/output.h"
#include "base/errors.h"
#include "base/files.h"
#include "base/printable.h"
#include "errors/picture_errors.h"
#include "extras/render/app/mask.h"
#include "extras/render/app/mesh_options.h"
#include "extras/render/app/path.h"
#include "extras/render/exr.h"
#include "extras/render/likeness.h"
#include "extras/render/material.h"
#include "extras/render/raster.h"
#include "extras/render/scene.h"
#include "extras/render/tone.h"
#include "generated/app/extra_subcommands.h"
#include "srbf/file.h"

namespace SRBF_NAMESPACE {
namespace {

struct RenderCommand {
    std::vector<std::string> files;
    std::string renderer = "path", mesh = "ball", up = "y", mask, output, compare, json;
    int width = 640, height = 480;  ///< size of a picture [pixels]
    bool aov = false;
    PathCommand path;

    int run() const;
    /// The output's name with `what` inserted before its extension.
    std::string beside(std::string_view what) const {
        return std::filesystem::path(output).replace_extension(fmt::format("{}.png", what)).string();
    }
    bool is_exr() const { return std::filesystem::path(output).extension() == ".exr"; }
};

/// The results of a renderer for each subject; first hits come from the path tracer only.
struct RenderedPictures {
    std::vector<Rendering> renderings;
    std::vector<FirstHits> first;
};

Result<RenderedPictures> render_paths(const Scene& scene, std::span<const Pictured> subjects,
                                      const RenderCommand& options) {
    ProgressLine line;
    auto pictures = options.path.render(scene, subjects, options.width, options.height,
                                        [&](double part) { line.show("tracing paths", part); });
    if (!pictures) return pictures.error();
    RenderedPictures rendered;
    for (PathPicture& picture : *pictures) {
        rendered.renderings.push_back(std::move(picture.rendering));
        rendered.first.push_back(std::move(picture.first));
    }
    return rendered;
}

Result<RenderedPictures> render_raster([[maybe_unused]] const Scene& scene,
                                       [[maybe_unused]] std::span<const Pictured> pictured,
                                       [[maybe_unused]] const RenderCommand& options) {
#ifdef SRBF_RASTER
    if (const auto can_draw = check_drawing(); !can_draw) return can_draw.error();
    std::vector<Material> materials;
    for (const Pictured& item : pictured) {
        const auto* const* subject = std::get_if<const LoadedFile*>(&item);
        if (!subject) return argument_error(options.files[0], "input of raster", "measurements and models", "a map");
        auto material = material_of((*subject)->content, (*subject)->path);
        if (!material) return material.error();
        materials.push_back(*std::move(material));
    }
    Scene lit = scene;
    if (options.path.lights == "behind") lit.lights = {light_behind(scene.camera)};
    auto renderings = rasterize(lit, materials, options.width, options.height);
    if (!renderings) return renderings.error();
    return RenderedPictures{*std::move(renderings), {}};
#else
    return Error{"renderer raster", {}, "this program", "one built with libepoxy", "one without"};
#endif
}

/// Images of equal size side by side.
template <typename Pixel> Picture<Pixel> join_images(const std::vector<Picture<Pixel>>& images) {
    const int width = images[0].width, height = images[0].height;
    Picture<Pixel> row(width * int(images.size()), height);
    for (std::size_t i = 0; i < images.size(); ++i)
        for (int y = 0; y < height; ++y) std::copy_n(&images[i].at(0, y), width, &row.at(int(i) * width, y));
    return row;
}

Result<Done> write_float(const RenderedPictures& pictures, const RenderCommand& options) {
    std::vector<Image> radiance, normal, albedo, depth;
    for (const Rendering& rendering : pictures.renderings) radiance.push_back(rendering.radiance);
    std::vector<Channel> channels = channels_of(join_images(radiance));
    const Image joined = join_images(radiance);
    if (options.aov) {
        for (const FirstHits& first : pictures.first) {
            normal.push_back(first.normal);
            albedo.push_back(first.albedo);
            depth.emplace_back(first.normal.width, first.normal.height);
            for (std::size_t i = 0; i < first.depth.size(); ++i) depth.back().pixels[i].r = first.depth[i];
        }
        for (Channel& channel : channels_of(join_images(normal), "normal.", "XYZ"))
            channels.push_back(std::move(channel));
        for (Channel& channel : channels_of(join_images(albedo), "albedo.")) channels.push_back(std::move(channel));
        channels.push_back({"Z", channels_of(join_images(depth))[0].pixels});
    }
    return write_exr(joined.width, joined.height, channels, options.output);
}

/// Prints the difference of each image from the reference, and writes it.
Result<Done> compare_pictures(const Image8& reference, std::span<const Image8> images,
                              std::span<const std::string> captions, const RenderCommand& options) {
    std::vector<Image8> differences;
    Json json;
    const bool quiet = options.json == "-";
    if (!quiet)
        fmt::print("{:<40}  {:>8}  {:>8}  {:>8}\n", printable("against " + options.compare), "PSNR, dB", "SSIM",
                   "FLIP");
    for (std::size_t i = 0; i < images.size(); ++i) {
        const Likeness errors = likeness(reference, images[i]);
        differences.push_back(in_false_colours(flip_map(reference, images[i]), reference.width, reference.height));
        if (!quiet)
            fmt::print("{:<40}  {:>8.2f}  {:>8.4f}  {:>8.4f}\n", printable(captions[i]), errors.psnr, errors.ssim,
                       errors.flip);
        json.push_back(
            {{"file", options.files[i]}, {"psnr", errors.psnr}, {"ssim", errors.ssim}, {"flip", errors.flip}});
    }
    if (!options.json.empty())
        if (const auto written = write_json(json, options.json); !written) return written.error();
    return write_png(side_by_side(differences, captions), options.beside(".difference"));
}

/// The picture in `file`, which must have the requested size; no value if the file is not a picture.
Result<std::optional<Image>> picture_in(const std::string& file, const RenderCommand& options) {
    const auto bytes = read_file(file, all_if(srbf::is_exr));
    if (!bytes) return bytes.error();
    if (!srbf::is_exr(*bytes)) return std::optional<Image>();
    auto image = read_exr(*bytes, file);
    if (!image) return image.error();
    if (image->width != options.width || image->height != options.height)
        return input_error(file, "size of the reference", fmt::format("{}x{}", options.width, options.height),
                           fmt::format("{}x{}", image->width, image->height));
    return std::optional(*std::move(image));
}

/// Writes the pictures, the requested further files, and the errors against `reference` if there is one. All
/// pictures have the same exposure, so that they are comparable.
Result<Done> write_pictures(const RenderedPictures& pictures, const std::optional<Image>& reference,
                            const std::vector<std::string>& captions, const RenderCommand& options) {
    const float exposure = automatic_exposure(reference ? *reference : pictures.renderings.front().radiance);
    std::vector<Image8> images;
    for (const Rendering& rendering : pictures.renderings) images.push_back(shown(rendering, exposure));
    const auto written =
        options.is_exr() ? write_float(pictures, options) : write_png(side_by_side(images, captions), options.output);
    if (!written) return written.error();
    if (!reference) return Done{};
    const Rendering reference_rendering{*reference, pictures.renderings.front().coverage};
    return compare_pictures(shown(reference_rendering, exposure), images, captions, options);
}

/// The materials of a mask.
Result<MaskedSubjects> masked_by(const std::string& mask, std::span<const Pictured> materials) {
    MaskedSubjects masked;
    for (const Pictured& material : materials) {
        const auto* subject = std::get_if<const LoadedFile*>(&material);
        if (!subject) return argument_error(mask, "materials", "measurements and models", "a map");
        masked.subjects.push_back(*subject);
    }
    if (const std::size_t count = masked.subjects.size(); count < 2 || count > 3)
        return argument_error(mask, "materials", "two or three", std::to_string(count));
    auto image = load_mask(mask);
    if (!image) return image.error();
    masked.mask = *std::move(image);
    return masked;
}

int RenderCommand::run() const {
    std::vector<std::string> inputs = files, captions;
    std::vector<FileOrMap> subjects;
    std::optional<Image> reference;  // otherwise the reference is one more subject
    if (!compare.empty()) {
        inputs.push_back(compare);
        auto picture = picture_in(compare, *this);
        if (!picture) return complain(picture.error());
        reference = *std::move(picture);
    }
    for (const std::string& file : inputs) {
        if (reference && subjects.size() == files.size()) break;
        auto loaded = load_file_or_map(file);
        if (!loaded) return complain(loaded.error());
        subjects.push_back(*std::move(loaded));
    }
    for (const std::string& file : files) captions.push_back(std::filesystem::path(file).filename().string());
    auto loaded = load_mesh(mesh);
    if (!loaded) return complain(loaded.error());
    inputs.push_back(mesh);
    if (!mask.empty()) inputs.push_back(mask);
    std::vector<std::string> outputs{output, json == "-" ? "" : json};
    if (!compare.empty()) outputs.push_back(beside(".difference"));
    if (const auto writable = check_outputs(inputs, outputs); !writable) return complain(writable.error());

    const Viewpoint viewpoint{.z_up = up == "z"};
    const Scene scene = scene_of(*std::move(loaded), viewpoint, double(width) / height);
    std::vector<Pictured> pictured;
    for (const FileOrMap& subject : subjects)
        std::visit([&](const auto& content) { pictured.emplace_back(&content); }, subject);
    MaskedSubjects masked;
    if (!mask.empty()) {
        auto mixed = masked_by(mask, std::span(pictured).first(files.size()));
        if (!mixed) return complain(mixed.error());
        masked = *std::move(mixed);
        pictured.erase(pictured.begin() + 1, pictured.begin() + std::ptrdiff_t(files.size()));
        pictured[0] = &masked;
        captions = {fmt::format("{}", fmt::join(captions, " and "))};
    }
    auto pictures = renderer == "path" ? render_paths(scene, pictured, *this) : render_raster(scene, pictured, *this);
    if (!pictures) return complain(pictures.error());
    if (pictures->renderings.size() > captions.size()) {
        reference = std::move(pictures->renderings.back().radiance);
        pictures->renderings.pop_back();
        if (!pictures->first.empty()) pictures->first.pop_back();
    }
    return status_of(write_pictures(*pictures, reference, captions, *this));
}

/// The largest width and height in "WxH".
constexpr int k_max_pixels = 8192;
Check size_in_pixels(int& width, int& height) {
    return [&](std::string& text) -> std::string {
        const auto number = [](std::string_view word) {
            int n = 0;
            const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), n);
            return error == std::errc() && end == word.data() + word.size() && n <= k_max_pixels ? n : 0;
        };
        const std::string_view size = text;
        const auto separator = std::min(size.find('x'), size.size());
        width = number(size.substr(0, separator));
        height = number(size.substr(std::min(separator + 1, size.size())));
        if (width >= 1 && height >= 1) return {};
        return fmt::format("expected WxH, each from 1 to {}, found {}", k_max_pixels, text);
    };
}

}  // namespace

std::vector<Option> add_mesh_options(const Subcommand& sub, std::string& mesh, std::string& up) {
    const Option file =
        sub.add_option("--mesh", mesh, fmt::format("A .ply or .obj file, or {}", fmt::join(k_built_in_meshes, " or ")))
            .type_name("FILE")
            .capture_default_str();
    return {file, add_up_option(sub, up, "Axis of the mesh that points upwards, y or z")};
}
Option add_up_option(const Subcommand& sub, std::string& up, const std::string& about) {
    return sub.add_option("--up", up, about).type_name("AXIS").one_of({"y", "z"}).capture_default_str();
}

void add_render(CommandLine& app, int& status) {
    const auto command = std::make_shared<RenderCommand>();
    const Subcommand sub = app.add_subcommand("render", "Render a mesh with each of the materials, side by side");
    sub.add_option("FILE", command->files, "Measurements, models and maps of texels, one picture each")
        .type_name("")
        .required();
    sub.add_option("--renderer", command->renderer, "path or raster")
        .type_name("NAME")
        .one_of({"path", "raster"})
        .capture_default_str();
    const std::vector<Option> about_mesh = add_mesh_options(sub, command->mesh, command->up);
    sub.add_option("--size", "Size of each picture in pixels (640x480)")
        .type_name("WxH")
        .check(size_in_pixels(command->width, command->height));
    sub.add_option("-o,--output", command->output, "The picture to write: .png, or .exr for linear radiance")
        .type_name("FILE")
        .required()
        .check([](std::string& name) -> std::string {
            const auto ending = std::filesystem::path(name).extension();
            if (ending == ".png" || ending == ".exr") return {};
            return fmt::format("expected a name that ends in .png or .exr, found {}", name);
        });
    const Option aov =
        sub.add_flag("--aov", command->aov, "path: also write normal, albedo and depth, as channels of an .exr");
    const Option mask =
        sub.add_option("--mask", command->mask,
                       "path: one picture of two or three materials, mixed by this picture (.png, .jpg, .exr) at the "
                       "mesh's\ntexture coordinates: red is the share of the second, green that of the third")
            .type_name("FILE");
    sub.add_option("--compare", command->compare,
                   "Print PSNR, SSIM and FLIP against this reference, a BRDF to render or an .exr, and write "
                   "OUTPUT.difference.png")
        .type_name("REF");
    const Option json = sub.add_option("--json", command->json, "Write the results of --compare; - is standard output")
                            .type_name("FILE");
    const auto is_path = [command] { return command->renderer == "path"; };
    std::vector<AllowedWhen> allowed = command->path.add_options(sub, about_mesh, is_path);
    allowed.push_back({{aov, mask}, "only with --renderer path", is_path});
    allowed.push_back({{aov}, "only with an output .exr", [command] { return command->is_exr(); }});
    allowed.push_back({{json}, "only with --compare", [command] { return !command->compare.empty(); }});
    sub.footer(
        "Examples:\n  srbf render paper_white_rgb.bsdf paper_white_rgb.srbf -o paper.png\n"
        "  srbf render film.srbf --compare film.bsdf --env lobby.hdr --mesh bunny.ply --spp 256 -o film.exr");
    sub.callback([command, &status] { status = command->run(); }, std::move(allowed));
}

}  // namespace
