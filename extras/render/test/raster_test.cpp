// Pictures of a graphics library agree with the CPU's evaluation of the same text at the same positions and normals.
#include "extras/render/raster.h"
#include "dialects.h"
#include "extras/render/path.h"

#include <map>

#include "brdf/parts.h"
#include "extras/render/exr.h"
#include "extras/render/shading.h"
#include "extras/render/test/psnr.h"
#include "measured/tables.h"
#include "models.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/ggx/ggx_kind.h"
#include "models/openpbr/openpbr_kind.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/fit_su.h"
#include "models/su/su_functions.h"
#include "program.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/kernel.h"
#include "su_models.h"

namespace srbf::raster_test {
namespace {

constexpr int k_width = 160, k_height = 120;

/// f_r as the texts that the shader is made of have it, on the CPU.
Rgb rgb(Vec3f f) { return {f.x, f.y, f.z}; }
Rgb text_value(const GgxModel& model, Vec3f wl, Vec3f wv) { return value(model, wl, wv); }
Rgb text_value(const OpenPbrModel& model, Vec3f wl, Vec3f wv) { return value(model, wl, wv); }
Rgb text_value(const PmModel& model, Vec3f wl, Vec3f wv) { return rgb(Kernel<float>::pm_value(model, wl, wv)); }
Rgb text_value(const SuModel& model, Vec3f wl, Vec3f wv) {
    const bool views_are_sampled = model.discretise == Discretise::view;
    const Vec3f lobe_direction = views_are_sampled ? wl : wv, sampled = views_are_sampled ? wv : wl;
    if (model.interpolation == SuInterpolation::rotated)
        return rgb(Kernel<float>::su_rotated_value(model, lobe_direction, sampled));
    const IndexTexture& index = *model.index;
    const NearestViews& nearest = index.texels[texel_of(index.map, index.size, sampled)];
    return rgb(Kernel<float>::su_plain_value(model, nearest, lobe_direction, sampled, model.neighbours));
}
Rgb text_value(const MerlTable& table, Vec3f wl, Vec3f wv) { return value(table, wl, wv); }
Rgb text_value(const BsdfModel& model, Vec3f wl, Vec3f wv) { return value(model, wl, wv); }
Rgb text_value(const BsdfTables& tables, Vec3f wl, Vec3f wv) { return value(tables.part, wl, wv); }
Rgb text_value(const Flat&, Vec3f, Vec3f) { return {Flat::k_value, Flat::k_value, Flat::k_value}; }

/// The scene's positions and normals, a pixel each, as the library interpolates them.
struct Pixels {
    std::vector<Float4> positions, normals;
};

class Raster : public OpenGLTest {
  protected:
    static RasterView view_of(const Scene& scene, float exposure = 1) {
        return {scene.camera, double(k_width) / k_height, scene.lights, exposure};
    }

    Pixels pixels_of(const Scene& scene) {
        const auto surface = checked(RasterSurface::make(GetParam(), k_width, k_height));
        surface->draw(RasterMesh(scene.mesh), view_of(scene));
        return {surface->read_positions(), surface->read_normals()};
    }

    /// The picture drawn in one pass, or in two.
    Image8 shown(const Scene& scene, const Material& material, float exposure, PixelInput input) {
        const bool is_deferred = input == PixelInput::surface;
        const RasterMesh mesh(scene.mesh);
        const RasterView view = view_of(scene, exposure);
        const auto shader = checked(RasterMaterial::make(material, {.dialect = GetParam(), .input = input}));
        const auto surface = checked(RasterSurface::make(GetParam(), k_width, k_height));
        const auto target =
            checked(is_deferred ? RasterTarget::make_for(*surface)
                                : RasterTarget::make(k_width, k_height, 1, RasterTarget::Format::bytes));
        if (is_deferred) surface->draw(mesh, view);
        target->begin();
        if (is_deferred)
            shader->draw(*surface, view);
        else
            shader->draw(mesh, view);
        return target->read_bytes();
    }

    /// The radiance of each pixel that the surface covers, else NaN.
    template <typename B> Image radiance(const Scene& scene, const Pixels& surface, const B& brdf) {
        using Text = Shading<float>;
        Image image(k_width, k_height, {NAN, NAN, NAN});
        for (std::size_t i = 0; i < surface.positions.size(); ++i) {
            const auto [x, y, z, covered] = surface.positions[i];
            const auto [nx, ny, nz, also] = surface.normals[i];
            if (covered == 0) continue;
            const Vec3f to_viewer = normalize(to_float(scene.camera.eye) - Vec3f{x, y, z});
            const auto frame = Text::surface_frame_about(Text::visible_normal({nx, ny, nz}, to_viewer));
            const Vec3f wv = Text::to_surface(frame, to_viewer);
            Rgb& sum = image.pixels[i] = {};
            for (const DirectionalLight& light : scene.lights) {
                const Vec3f wl = Text::to_surface(frame, to_float(light.towards));
                if (!(wl.z > 0)) continue;
                const Rgb f = text_value(brdf, wl, wv);
                for (int c = 0; c < 3; ++c) sum[c] += wl.z * f[c] * light.irradiance[c];
            }
        }
        return image;
    }

    /// PSNR [dB] of the library's 8-bit picture against the CPU's, over the pixels that the mesh covers.
    double psnr(const Material& material, const Scene& scene, PixelInput input = PixelInput::triangles) {
        Pixels& surface = surfaces[&scene];
        if (surface.positions.empty()) surface = pixels_of(scene);
        const Image expected = std::visit([&](const auto& brdf) { return radiance(scene, surface, brdf); }, material);
        const float exposure = automatic_exposure(expected);
        EXPECT_LT(exposure, 1e6);  // there is something to see
        const Image8 picture = shown(scene, material, exposure, input);
        Psnr psnr;
        for (std::size_t i = 0; i < expected.pixels.size(); ++i)
            if (surface.positions[i][3] != 0) psnr.add(to_srgb8(expected.pixels[i], exposure), picture.pixels[i]);
        EXPECT_GT(psnr.count, 0.1 * k_width * k_height);
        return psnr.decibels();
    }
    std::map<const Scene*, Pixels> surfaces;
};

const Scene& sphere_scene() {
    static const Scene scene = scene_of(sphere(), {}, double(k_width) / k_height);
    return scene;
}
const Scene& knot_scene() {
    static const Scene scene = scene_of(knot(), {.azimuth = 0.4}, double(k_width) / k_height);
    return scene;
}

const Measured& film() {
    static const Measured measured = *load_measured(bundled_data() / "cc_ibiza_sunset_rgb.bsdf");
    return measured;
}
const SuModel& film_su() {
    static const SuModel model = [] {
        SuFitOptions options;
        options.lobes = 5;
        options.objective = Objective::cube_root;
        return rounded(fit_su(*tabulate(signed_evaluator(film())), options)->model);
    }();
    return model;
}

const PmModel& film_pm() {
    static const PmModel model = [] {
        PmFitOptions options;
        options.lobes = 8;
        options.variates = 4;
        options.starts = 2;
        options.perturbations = 0;
        return rounded(fit_pm(*observe(signed_evaluator(film()), {.count = 8192}), options)->model);
    }();
    return model;
}

TEST_P(Raster, MultivariateModelsLookAsOnTheCpu) {
    std::mt19937_64 random(1);
    const bool is_es = GetParam() == Dialect::es_300;  // whose text is the same
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            for (const auto& [lobes, variates] : {std::pair{3, 3}, {2, 5}}) {
                const PmModel model = random_model(random, {.axial = axial,
                                                            .log_scale = lobes == 3,
                                                            .lobes = lobes,
                                                            .variates = variates,
                                                            .max_bandwidth = 30,
                                                            .form = form});
                if (is_es && lobes == 3) continue;
                const auto& [scene, input] = lobes == 3 ? std::pair{&sphere_scene(), PixelInput::triangles}
                                                        : std::pair{&knot_scene(), PixelInput::surface};
                EXPECT_GE(psnr(model, *scene, input), 50) << name(form) << ' ' << axial << ' ' << lobes;
            }
    EXPECT_GE(psnr(film_pm(), sphere_scene()), 50);
    EXPECT_GE(psnr(film_pm(), knot_scene()), 50);
    EXPECT_GE(psnr(film_pm(), knot_scene(), PixelInput::surface), 50);
}

TEST_P(Raster, LambertAndGgxLookAsOnTheCpu) {
    const GgxModel model{{0.1f, 0.2f, 0.4f}, {{0.1f, {0.1f, 0.05f, 0.02f}, 0.9f}, {0.5f, {0, 0.03f, 0.2f}, 0.4f}}};
    EXPECT_GE(psnr(model, sphere_scene()), 50);
    EXPECT_GE(psnr(GgxModel{model.diffuse, {model.lobes[0]}}, knot_scene(), PixelInput::surface), 50);
}

TEST_P(Raster, SurfacesLookAsOnTheCpu) {
    OpenPbrModel model;
    model.base_color = {0.6f, 0.3f, 0.1f}, model.base_metalness = 0.4f, model.base_diffuse_roughness = 0.5f;
    model.coat_weight = 0.7f, model.coat_color = {0.9f, 0.8f, 0.7f}, model.coat_roughness = 0.2f;
    model.fuzz_weight = 0.5f, model.fuzz_color = {0.1f, 0.2f, 0.4f};
    EXPECT_GE(psnr(model, sphere_scene()), 50);
    model.thin_film_weight = 0.8f;
    model.thin_film_thickness = 0.4f;
    EXPECT_GE(psnr(model, knot_scene(), PixelInput::surface), 50);
    model.specular_roughness_anisotropy = 0.7f;
    model.specular_rotation = 0.1f;
    EXPECT_GE(psnr(model, sphere_scene()), 50);
}

TEST_P(Raster, ViewByViewModelsLookAsOnTheCpu) {
    SuModel model = film_su();
    EXPECT_GE(psnr(model, sphere_scene()), 45);
    EXPECT_GE(psnr(model, knot_scene()), 45);
    model.interpolation = SuInterpolation::plain;
    for (const DirectionMap map : {DirectionMap::cube, DirectionMap::parabolic}) {
        model.index = index_texture(model, map);
        for (const Discretise discretise : {Discretise::view, Discretise::light})
            for (const int neighbours : {map == DirectionMap::cube ? 7 : 1, 3}) {
                model.discretise = discretise;
                model.neighbours = neighbours;
                const Scene& scene = neighbours == 3 ? knot_scene() : sphere_scene();
                EXPECT_GE(psnr(model, scene), 45) << name(map) << ' ' << name(discretise) << ' ' << neighbours;
            }
    }
    EXPECT_GE(psnr(film_su(), knot_scene(), PixelInput::surface), 45);
    // Sharp lobes, other for each view.
    std::mt19937_64 random(2);
    SuModel sharp = random_su(random, 1536, 3);
    for (float& lambda : sharp.bandwidth) lambda *= 30;
    EXPECT_GE(psnr(sharp, sphere_scene()), 45);
}

TEST_P(Raster, MeasurementsLookAsOnTheCpu) {
    MerlTable table = to_merl(evaluator(film()));
    EXPECT_GE(psnr(table, sphere_scene()), 45);
    EXPECT_GE(psnr(table, knot_scene()), 45);
    // Points that were not measured do not take the colour of their neighbours.
    for (std::size_t i = 0; i < table.cells.size(); ++i)
        if (i / 180 % 90 > 20) table.cells[i].r = table.cells[i].g = table.cells[i].b = std::nanf("");
    EXPECT_GE(psnr(table, sphere_scene()), 30);
    const Image8 picture = shown(sphere_scene(), table, 1, PixelInput::triangles);
    EXPECT_GT(std::ranges::count(picture.pixels, k_not_measured), k_width * k_height / 20);
}

TEST_P(Raster, SamplesSmoothOutlines) {
    // Only the silhouette pixels of a white sphere lie between object and background.
    const auto between = [&](int samples) {
        const auto target = checked(RasterTarget::make(k_width, k_height, samples, RasterTarget::Format::floats));
        const auto shader =
            checked(RasterMaterial::make(Flat{}, {.dialect = GetParam(), .output = PixelOutput::radiance}));
        EXPECT_EQ(target->samples(), samples);
        target->begin();
        shader->draw(RasterMesh(sphere_scene().mesh), view_of(sphere_scene()));
        const auto pixels = target->read_floats();
        return long(std::ranges::count_if(pixels, [](const Float4& p) { return p[3] > 0 && p[3] < 1; }));
    };
    EXPECT_EQ(between(1), 0);
    EXPECT_GT(between(4), k_height);
    EXPECT_LT(between(4), 6 * k_height);
}

TEST_P(Raster, TheInsideOfAnOpenSurfaceIsSeenWithItsNormalTurned) {
    Scene scene = sphere_scene();  // its back alone
    std::erase_if(scene.mesh.triangles, [&](const Triangle& t) { return scene.mesh.positions[t[0]].z > 0; });
    scene.camera = {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.5};
    const Pixels inside = pixels_of(scene);
    double seen = 0;
    for (std::size_t i = 0; i < inside.positions.size(); ++i) {
        const auto& [x, y, z, covered] = inside.positions[i];
        if (covered == 0) continue;
        ++seen;
        const auto& n = inside.normals[i];
        ASSERT_WITHIN(n[0], -x, 1e-5);
        ASSERT_WITHIN(n[1], -y, 1e-5);
        ASSERT_WITHIN(n[2], -z, 1e-5);
    }
    EXPECT_GT(seen, 0.3 * k_height * k_height);
    const auto surface = checked(RasterSurface::make(GetParam(), k_width, k_height));
    RasterView view = view_of(scene);
    view.back_faces = false;
    surface->draw(RasterMesh(scene.mesh), view);
    EXPECT_EQ(std::ranges::count_if(surface->read_positions(), [](const Float4& p) { return p[3] > 0; }), 0);
}

TEST_P(Raster, TooLargePicturesAreRefused) {
    std::mt19937_64 random(4);
    const auto model = random_model(random, {.axial = false, .lobes = k_max_lobes, .variates = k_max_variates});
    const auto material = RasterMaterial::make(model, {.dialect = GetParam()});
    ASSERT_FALSE(material);
    EXPECT_CONTAINS(message(material.error()), "uniform buffer: expected at most");
    const auto target = RasterTarget::make(1 << 20, 1, 1, RasterTarget::Format::bytes);
    ASSERT_FALSE(target);
    EXPECT_CONTAINS(message(target.error()), "1048576 x 1");
    EXPECT_FALSE(RasterSurface::make(GetParam(), 1, 1 << 20));
}

TEST(Render, WritesAPictureOfEachFileSideBySide) {
    if (const auto context = OffscreenContext::make(); !context) GTEST_SKIP() << message(context.error());
    const TemporaryFolder folder;
    ASSERT_TRUE(save_model({film_pm(), {}}, folder / "pm.srbf").ok());
    ASSERT_TRUE(save_model({film_su(), {}}, folder / "su.srbf").ok());
    const ProgramRun made =
        run_ok(folder, {"render", bundled_data() / "cc_ibiza_sunset_rgb.bsdf", "su.srbf", "pm.srbf", "--renderer",
                        "raster", "--mesh", "knot", "--size", "160x120", "-o", "x.png"});
    EXPECT_EQ(made.err, "");
    const std::string png = read_text(folder / "x.png");
    ASSERT_TRUE(png.starts_with("\x89PNG\r\n\x1a\n"));
    const auto number = [&](std::size_t at) { return 256 * std::uint8_t(png[at + 2]) + std::uint8_t(png[at + 3]); };
    EXPECT_EQ(number(16), 3 * 160);
    EXPECT_EQ(number(20), 120 + 20);  // with a strip of captions
    // A measurement that is not isotropic has no table.
    write_text(folder / "a.csv",
               "# anisotropic\nwl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value\n0,0.6,0.8,0,0,1,1\n0.6,0,0.8,0,0,1,1\n");
    const ProgramRun refused = run_srbf(folder, {"render", "a.csv", "--renderer", "raster", "-o", "a.png"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_CONTAINS(refused.err, "expected an isotropic one, found an anisotropic one");
}

constexpr int k_traced = 96;  // pixels across of pictures of paths

/// Direct light by the path tracer.
template <typename M> Rendering traced(const Scene& scene, const M& material) {
    const PathScene paths{{{&scene.mesh, 0}}, {material}, scene.camera, scene.lights, {}, nullptr};
    PathOptions options;
    options.width = options.height = k_traced;
    options.samples = 16;
    options.bounces = 1;
    options.occlusion = false;
    options.threads = 1;
    return render_paths(paths, options).rendering;
}

/// PSNR [dB] against the path tracer's, where the object covers pixels as a whole.
double psnr_to(const Rendering& expected, const Scene& scene, const Material& material) {
    const auto drawn = checked(rasterize(scene, std::vector<Material>{material}, k_traced, k_traced, 4));
    const float exposure = automatic_exposure(expected.radiance);
    Psnr psnr;
    for (std::size_t i = 0; i < expected.coverage.size(); ++i)
        if (expected.coverage[i] == 1 && (*drawn)[0].coverage[i] == 1)
            psnr.add(to_srgb8(expected.radiance.pixels[i], exposure),
                     to_srgb8((*drawn)[0].radiance.pixels[i], exposure));
    EXPECT_GT(psnr.count, 0.2 * k_traced * k_traced);
    return psnr.decibels();
}

TEST(Rasterize, BothSidesAreLitFromBothSides) {
    if (const auto context = OffscreenContext::make(); !context) GTEST_SKIP() << message(context.error());
    const Model ggx{ggx_bsdf(), {}};
    BsdfModel lobes = lobe_bsdf_with_beams(5);
    lobes.part[1].reset();
    lobes.part[3].reset();
    BsdfTables tables;
    const Evaluate values = evaluator(ggx);
    for (std::size_t p = 0; p < k_parts; ++p)
        tables.part[p] = std::make_shared<const MerlTable>(to_merl(part_of(values, Part(p)), {64, 45, 48}));
    const PreparedBsdf by_ggx = prepare_bsdf(ggx, {.threads = 1}),
                       by_lobes = prepare_bsdf(Model{lobes, {}}, {.threads = 1});
    Scene outside = scene_of(sphere(96), {}, 1), inside = outside;
    std::erase_if(inside.mesh.triangles, [&](const Triangle& t) {
        return dot(to_double(inside.mesh.positions[t[0]]), inside.camera.eye) > 0;
    });
    for (Scene* scene : {&outside, &inside})
        for (const bool behind : {false, true}) {
            if (behind) scene->lights = {light_behind(scene->camera)};
            const Rendering ggx_picture = traced(*scene, by_ggx), lobes_picture = traced(*scene, by_lobes);
            EXPECT_GE(psnr_to(ggx_picture, *scene, ggx_bsdf()), 42) << behind;
            EXPECT_GE(psnr_to(lobes_picture, *scene, lobes), 40) << behind;
            EXPECT_GE(psnr_to(ggx_picture, *scene, tables), 40) << behind;
            // Another model is told apart.
            EXPECT_LT(psnr_to(ggx_picture, *scene, lobes), 30) << behind;
        }
}

/// The picture of `srbf render` with these arguments, 64 pixels wide and high.
Image rendered(const TemporaryFolder& folder, std::vector<std::string> arguments, const char* renderer) {
    arguments.insert(arguments.begin(), "render");
    for (const char* more : {"--size", "64x64", "-o", "x.exr", "--renderer"}) arguments.push_back(more);
    arguments.push_back(renderer);
    if (renderer == std::string("path"))
        arguments.insert(arguments.end(), {"--no-ground", "--no-occlusion", "--env", "none", "--spp", "16"});
    run_ok(folder, arguments);
    const auto bytes = read_file(folder / "x.exr");
    return bytes ? *read_exr(*bytes, "x.exr") : Image(64, 64);
}

TEST(Render, DrawsALightBehind) {
    if (const auto context = OffscreenContext::make(); !context) GTEST_SKIP() << message(context.error());
    const TemporaryFolder folder;
    ASSERT_TRUE(save_model({ggx_bsdf(), {}}, folder / "both.srbf").ok());
    ASSERT_TRUE(save_model(*ggx_bsdf().part[0], folder / "front.srbf").ok());
    const auto render = [&](const char* file, const char* renderer) {
        return rendered(folder, {file, "--lights", "behind", "--mesh", "sphere"}, renderer);
    };
    const Image by_raster = render("both.srbf", "raster"), by_paths = render("both.srbf", "path"),
                opaque = render("front.srbf", "raster");
    // The middle of the picture faces away from the light.
    EXPECT_GT(by_raster.at(32, 32).g, 0.01f);
    EXPECT_WITHIN_RELATIVE(by_raster.at(32, 32).g, by_paths.at(32, 32).g, 0.02);
    EXPECT_EQ(opaque.at(32, 32), Rgb{});
}

TEST(Rasterize, GivesRadianceAndCoverage) {
    const auto drawn = rasterize(sphere_scene(), std::vector<Material>{Flat{}, film_su()}, k_width, k_height);
    if (!drawn) GTEST_SKIP() << message(drawn.error());
    ASSERT_EQ(drawn->size(), 2u);
    double covered = 0;
    for (const float fraction : (*drawn)[0].coverage) covered += double(fraction);
    // The sphere fills the picture but for the margin, seen in perspective as a disc.
    EXPECT_WITHIN_RELATIVE(covered, k_pi * std::pow((1 - k_margin) * k_height / 2, 2), 0.02);
    EXPECT_EQ((*drawn)[0].coverage, (*drawn)[1].coverage);
    // The radiance is f E where the key light falls along the normal.
    float max = 0;
    for (const Rgb& pixel : (*drawn)[0].radiance.pixels) max = std::max(max, pixel.r);
    EXPECT_GT(max, 2.95f * Flat::k_value);
    EXPECT_LT(max, 3.6f * Flat::k_value);
}

IN_EACH_DIALECT(Raster);

}  // namespace
}  // namespace srbf::raster_test
