// What a graphics library draws is what the CPU makes of the same text, the same normals and positions.
#include "render/raster.h"

#include <map>

#include "models.h"
#include "render/shading.h"
#include "srbf/convert.h"
#include "srbf/fit.h"
#include "srbf/half.h"
#include "srbf/kernel.h"
#include "su_models.h"

namespace srbf {
namespace {

constexpr int k_width = 320, k_height = 240;

/// f_r as the texts that the shader is made of have it, on the CPU.
Rgb rgb(Vec3f f) { return {f.x, f.y, f.z}; }
Rgb by_text(const PmModel& model, Vec3f wl, Vec3f wv) { return rgb(Kernel<float>::pm_value(model, wl, wv)); }
Rgb by_text(const SuModel& model, Vec3f wl, Vec3f wv) {
    const bool by_view = model.discretise == Discretise::view;
    const Vec3f of_lobes = by_view ? wl : wv, sampled = by_view ? wv : wl;
    if (model.interpolation == SuInterpolation::rotated)
        return rgb(Kernel<float>::su_rotated_value(model, of_lobes, sampled));
    const IndexTexture& index = *model.index;
    const NearestViews& nearest = index.texels[texel_of(index.map, index.size, sampled)];
    return rgb(Kernel<float>::su_plain_value(model, nearest, of_lobes, sampled, model.neighbours));
}
Rgb by_text(const MerlTable& table, Vec3f wl, Vec3f wv) { return value(table, wl, wv); }
Rgb by_text(const Flat&, Vec3f, Vec3f) { return {Flat::k_value, Flat::k_value, Flat::k_value}; }

/// The scene's positions and normals, a pixel each, as the library interpolates them.
struct Pixels {
    std::vector<Float4> positions, normals;
};

class Raster : public testing::TestWithParam<Dialect> {
  protected:
    void SetUp() override {
        auto made = OffscreenContext::make(GetParam());
        if (!made) GTEST_SKIP() << message(made.error());
        context.emplace(*std::move(made));
    }

    static RasterView view_of(const Scene& scene, float exposure = 1) {
        return {scene.camera, double(k_width) / k_height, scene.lights, exposure};
    }

    Pixels pixels_of(const Scene& scene) {
        const auto surface = RasterSurface::make(GetParam(), k_width, k_height);
        if (!surface) return ADD_FAILURE() << message(surface.error()), Pixels();
        surface->draw(RasterMesh(scene.mesh), view_of(scene));
        return {surface->read_positions(), surface->read_normals()};
    }

    /// In one pass, or in two.
    Image8 shown(const Scene& scene, const Material& material, float exposure, PixelInput input) {
        constexpr auto bytes = RasterTarget::Format::bytes;
        const RasterMesh mesh(scene.mesh);
        const RasterView view = view_of(scene, exposure);
        const auto of = RasterMaterial::make(material, {.dialect = GetParam(), .input = input});
        const auto surface = RasterSurface::make(GetParam(), k_width, k_height);
        if (!of || !surface) return ADD_FAILURE() << message(of ? surface.error() : of.error()), Image8();
        const auto target = input == PixelInput::surface ? RasterTarget::make_for(*surface, bytes)
                                                         : RasterTarget::make(k_width, k_height, 1, bytes);
        if (!target) return ADD_FAILURE() << message(target.error()), Image8();
        target->begin();
        if (input == PixelInput::surface) {
            surface->draw(mesh, view);
            of->draw(*surface, view);
        } else {
            of->draw(mesh, view);
        }
        return target->read_bytes();
    }

    /// The radiance of each pixel that the surface covers, else NaN.
    template <typename B> Image radiance(const Scene& scene, const Pixels& surface, const B& brdf) {
        using Text = Shading<float>;
        constexpr float nan = std::numeric_limits<float>::quiet_NaN();
        Image image(k_width, k_height, {nan, nan, nan});
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
                const Rgb f = by_text(brdf, wl, wv);
                for (int c = 0; c < 3; ++c) sum[c] += wl.z * f[c] * light.irradiance[c];
            }
        }
        return image;
    }

    /// PSNR [dB] of the library's 8-bit picture against the CPU's, over the pixels that the mesh covers.
    double psnr(const Material& material, const Scene& scene, PixelInput input = PixelInput::triangles) {
        Pixels& surface = surfaces[&scene];
        if (surface.positions.empty()) surface = pixels_of(scene);
        const Image expected = std::visit([&](const auto& of) { return radiance(scene, surface, of); }, material);
        const float exposure = automatic_exposure(expected);
        EXPECT_LT(exposure, 1e6);  // there is something to see
        const Image8 picture = shown(scene, material, exposure, input);
        double squares = 0, count = 0;
        for (std::size_t i = 0; i < expected.pixels.size(); ++i) {
            if (surface.positions[i][3] == 0) continue;
            const Rgb8 pixel = to_srgb8(expected.pixels[i], exposure);
            for (std::size_t c = 0; c < 3; ++c, ++count) {
                const double apart = double(pixel[c]) - double(picture.pixels[i][c]);
                squares += apart * apart;
            }
        }
        EXPECT_GT(count, 0.1 * k_width * k_height);
        return 10 * std::log10(255 * 255 * count / squares);
    }

    std::optional<OffscreenContext> context;
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

TEST_P(Raster, MultivariateModelsLookAsOnTheCpu) {
    std::mt19937_64 random(1);
    for (const PmForm form : k_forms)
        for (const bool axial : {true, false})
            for (const auto& [lobes, variates] : {std::pair{6, 3}, {3, 5}}) {
                const PmModel model = random_model(random, {.axial = axial,
                                                            .log_scale = form != PmForm::source,
                                                            .lobes = lobes,
                                                            .variates = variates,
                                                            .most_bandwidth = 30,
                                                            .form = form});
                const auto& [scene, input] = lobes == 6 ? std::pair{&sphere_scene(), PixelInput::triangles}
                                                        : std::pair{&knot_scene(), PixelInput::surface};
                EXPECT_GE(psnr(model, *scene, input), 50) << name(form) << ' ' << axial << ' ' << lobes;
            }
    const ObserveOptions what;
    FitOptions options;
    options.lobes = 8, options.variates = 4;
    const PmModel fitted = rounded(fit_pm(*observe(signed_evaluator(film()), what), options)->model);
    EXPECT_GE(psnr(fitted, sphere_scene()), 50);
    EXPECT_GE(psnr(fitted, knot_scene()), 50);
    EXPECT_GE(psnr(fitted, knot_scene(), PixelInput::surface), 50);
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
                model.discretise = discretise, model.neighbours = neighbours;
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
    // What was not measured shows as such, not as what is beside it.
    for (std::size_t i = 0; i < table.cells.size(); ++i)
        if (i / 180 % 90 > 20) table.cells[i].r = table.cells[i].g = table.cells[i].b = std::nanf("");
    EXPECT_GE(psnr(table, sphere_scene()), 30);
    const Image8 picture = shown(sphere_scene(), table, 1, PixelInput::triangles);
    EXPECT_GT(std::ranges::count(picture.pixels, k_not_measured), k_width * k_height / 20);
}

/// Root of the mean square of the differences of two pictures.
double apart(const Image8& a, const Image8& b) {
    double squares = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double d = double(a.pixels[i][c]) - double(b.pixels[i][c]);
            squares += d * d;
        }
    return std::sqrt(squares / (3 * double(a.pixels.size())));
}

TEST_P(Raster, NothingPopsAsTheViewTurns) {
    // 64 frames of a quarter of a degree: what changes from one to the next is little, unless something pops.
    const SuModel rotated = film_su();
    SuModel plain = rotated;
    plain.interpolation = SuInterpolation::plain;
    const std::vector<Material> materials{to_merl(evaluator(film())), rotated, plain};
    const auto surface = RasterSurface::make(GetParam(), k_width, k_height);
    ASSERT_TRUE(surface) << message(surface.error());
    const auto target = RasterTarget::make_for(*surface, RasterTarget::Format::bytes);
    ASSERT_TRUE(target) << message(target.error());
    const RasterMesh mesh(knot_scene().mesh);
    std::vector<RasterMaterial> made;
    for (const Material& material : materials) {
        auto of = RasterMaterial::make(material, {.dialect = GetParam(), .input = PixelInput::surface});
        ASSERT_TRUE(of) << message(of.error());
        made.push_back(*std::move(of));
    }
    const float exposure = 3;
    std::vector<Image8> last;
    for (int frame = 0; frame < 64; ++frame) {
        const Camera camera =
            camera_of(knot_scene().mesh, {.azimuth = frame * 0.25 * k_degree}, double(k_width) / k_height);
        const RasterView view{camera, double(k_width) / k_height, knot_scene().lights, exposure};
        std::vector<Image8> images;
        for (const RasterMaterial& of : made) {
            target->begin();
            surface->draw(mesh, view);
            of.draw(*surface, view);
            images.push_back(target->read_bytes());
        }
        for (std::size_t i = 1; i < images.size() && !last.empty(); ++i) {
            const double measured = apart(images[0], last[0]), fitted = apart(images[i], last[i]);
            printf("TURN %d %zu %g %g\n", frame, i, measured, fitted);
        }
        last = std::move(images);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, Raster, testing::Values(Dialect::gl_450, Dialect::es_300),
                         [](const auto& of) { return of.param == Dialect::gl_450 ? "OpenGL" : "OpenGLES"; });

}  // namespace
}  // namespace srbf
