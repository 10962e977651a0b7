// Pictures under an environment converge, without bias, to those of the path tracer and to quadrature.
#include <algorithm>
#include <map>

#include "brdf/frame.h"
#include "dialects.h"
#include "errors/image_errors.h"
#include "extras/render/path.h"
#include "extras/render/raster.h"
#include "measured/tables.h"
#include "models.h"
#include "models/pm/search/fit_pm.h"
#include "program.h"
#include "srbf/convert.h"
#include "su_models.h"

namespace srbf::raster_environment_test {
namespace {

const Measured& film() {
    static const Measured measured = *load_measured(bundled_data() / "cc_ibiza_sunset_rgb.bsdf");
    return measured;
}
const PmModel& film_pm() {
    static const PmModel model =
        fit_pm(*observe(signed_evaluator(film()), {.objective = Objective::cosine, .count = 8192}),
               {.lobes = 5, .variates = 3, .starts = 2, .perturbations = 0})
            ->model;
    return model;
}
const MerlTable& film_table() {
    static const MerlTable table = to_merl(evaluator(film()), {64, 45, 24});
    return table;
}
const GgxModel k_ggx{{0.1f, 0.2f, 0.4f}, {{0.15f, {0.1f, 0.05f, 0.02f}, 0.9f}}};

/// Coloured light with a bright texel.
const Environment& coloured_light() {
    static const Environment environment([] {
        Image image(32, 16);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) image.at(x, y) = {0.25f + 0.5f * float(x) / 32, 0.5f, float(y) / 16};
        image.at(11, 4) = {30, 25, 20};
        return image;
    }());
    return environment;
}

template <typename M> SampledMaterial sampled(const M& model) {
    return {model, propose(evaluator(model), {.azimuths = 1})};
}
const SampledMaterial& sampled_film() {
    static const SampledMaterial of = sampled(film_pm());
    return of;
}
const SampledMaterial& sampled_both() {
    static const SampledMaterial of{full_bsdf(), propose_parts(evaluator(Model{full_bsdf(), {}}), {.azimuths = 1})};
    return of;
}
template <typename M> PreparedBrdf prepared(const M& model) { return prepare(model, propose(evaluator(model))); }

/// The integral of f cosθl L over the hemisphere, for a surface that faces +z of the world.
std::array<double, 3> quadrature(const Evaluate& brdf, Vec3f wv, const Environment& environment, const Frame& axes) {
    const Quadrature points = MirrorMixture(k_pi / 2).quadrature(to_double(wv), 1 << 17);
    std::vector<Rgb> f(points.w.size());
    brdf(points.w, std::vector<Vec3f>(f.size(), wv), f);
    std::array<double, 3> sum{};
    for (std::size_t i = 0; i < f.size(); ++i) {
        const Vec3d w = to_double(points.w[i]);
        const Rgb arriving = environment.at(to_float(axes.to(w))).radiance;
        for (int c = 0; c < 3; ++c)
            sum[std::size_t(c)] += points.weight[i] * w.z * double(f[i][c]) * double(arriving[c]);
    }
    return sum;
}

class RasterEnvironments : public InEachDialect {
  protected:
    std::optional<RasterMaterial> made(const SampledMaterial& of) {
        auto material = RasterMaterial::make(of.material, {.dialect = GetParam(), .environment = true});
        if (!material) return ADD_FAILURE() << message(material.error()), std::nullopt;
        material->set_proposal(of.proposal);
        return *std::move(material);
    }

    /// The mean of `samples` samples of each pixel.
    std::vector<Float4> picture(std::optional<RasterMaterial>& material, const Mesh& mesh, const Camera& camera,
                                int size, int samples, const Environment& environment, const Frame& axes,
                                LightDraws draws = LightDraws::both) {
        const auto light = RasterEnvironment::make(environment);
        const auto surface = RasterSurface::make(GetParam(), size, size, RasterSurface::Points::four);
        if (!light || !surface || !material)
            return ADD_FAILURE() << message(!light ? light.error() : surface.error()), std::vector<Float4>();
        auto mean = RasterMean::make(*surface);
        if (!mean) return ADD_FAILURE() << message(mean.error()), std::vector<Float4>();
        const RasterMesh drawn(mesh);
        for (int i = 0; i < samples; ++i) {
            const RasterView view{.camera = camera, .aspect = 1, .lights = {}, .shift = sample_shift(i, size, size)};
            surface->draw(drawn, view);
            mean->add(*material, *surface, view, {&*light, axes, draws});
        }
        EXPECT_EQ(mean->samples(), samples);
        return mean->picture().read_floats();
    }
    /// Of a material that is drawn once.
    std::vector<Float4> picture(const SampledMaterial& of, const Mesh& mesh, const Camera& camera, int size,
                                int samples, const Environment& environment, const Frame& axes,
                                LightDraws draws = LightDraws::both) {
        auto material = made(of);
        return picture(material, mesh, camera, size, samples, environment, axes, draws);
    }
};

constexpr Frame k_world{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// A square that fills the picture and faces +z, seen at θv from so far that wv is the same everywhere; y is up.
const Mesh k_plane{{{-10, -10, 0}, {10, -10, 0}, {10, 10, 0}, {-10, 10, 0}},
                   std::vector<Vec3f>(4, {0, 0, 1}),
                   {{0, 1, 2}, {0, 2, 3}},
                   {}};
Camera plane_camera(double theta) {
    const Vec3d wv = spherical(theta, 0.0);
    return {100.0 * wv, {0, 0, 0}, {0, 1, 0}, 1e-3};
}

/// The mean of pixels that are independent estimates, and its standard error, of each channel.
struct Mean {
    std::array<double, 3> value{}, error{};
};
Mean mean_of(const std::vector<Float4>& pixels) {
    Mean mean;
    const double n = double(pixels.size());
    for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0, squares = 0;
        for (const Float4& pixel : pixels) sum += double(pixel[c]), squares += double(pixel[c]) * double(pixel[c]);
        mean.value[c] = sum / n;
        mean.error[c] = std::sqrt(std::max(squares / n - sum / n * sum / n, 0.0) / n);
    }
    return mean;
}

TEST_P(RasterEnvironments, AreWithoutBiasHoweverTheyAreTurned) {
    // All pixels are samples of one integral.
    const double theta = 50 * k_degree;
    const Vec3f wv = to_float(spherical(theta, 0.0));
    static const SampledMaterial materials[] = {sampled_film(), sampled(isotropic_su(128)), sampled(k_ggx),
                                                sampled(film_table())};
    const Evaluate brdfs[] = {evaluator(film_pm()), evaluator(isotropic_su(128)), evaluator(k_ggx),
                              evaluator(film_table())};
    static const SuModel su = isotropic_su(128);
    const bool is_es = GetParam() == Dialect::es_300;  // whose text is the same
    std::vector<std::optional<RasterMaterial>> drawn;
    for (const SampledMaterial& of : materials) drawn.push_back(made(of));
    for (const double turn : {0.0, 1.0, 4.0}) {
        if (is_es && turn != 1) continue;
        const Frame axes = frame_about(spherical(0.5 * turn, turn), {0, 1, 0.2});
        for (std::size_t i = 0; i < (is_es ? 1 : std::size(materials)); ++i) {
            const Evaluate brdf = i == 1 ? evaluator(su) : brdfs[i];
            const auto expected = quadrature(brdf, wv, coloured_light(), axes);
            for (const LightDraws draws : {LightDraws::both, LightDraws::material, LightDraws::light}) {
                if (turn > 0 && draws != LightDraws::both) continue;
                const Mean found =
                    mean_of(picture(drawn[i], k_plane, plane_camera(theta), 64, 16, coloured_light(), axes, draws));
                for (std::size_t c = 0; c < 3; ++c) {
                    EXPECT_TRUE(near(found.value[c], expected[c], 0.004 * expected[c] + 4 * found.error[c]))
                        << turn << ' ' << i << ' ' << int(draws) << ": " << found.value[c] << ' ' << expected[c];
                    // Which is precise enough to tell.
                    const double precise = draws == LightDraws::both ? 0.003 : 0.05;
                    EXPECT_LT(found.error[c], precise * expected[c]) << turn << ' ' << i << ' ' << int(draws);
                }
            }
        }
    }
}

/// A narrow highlight reflects little of uniform light, but most of what a lamp sends: so often it is drawn.
TEST_P(RasterEnvironments, AreDrawnByTheLampsThatHighlightsReflect) {
    const GgxModel lacquer{{0.3f, 0.25f, 0.2f}, {{0.02f, {0.04f, 0.04f, 0.04f}, 1}}};
    const double theta = 40 * k_degree;
    const Vec3f mirrored = mirror(to_float(spherical(theta, 0.0)));
    Image image(64, 32, {0.1f, 0.1f, 0.1f});
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double phi = 2 * k_pi * ((x + 0.5) / image.width - 0.5), from_y = k_pi * (y + 0.5) / image.height;
            const Vec3f w =
                to_float(Vec3d(std::sin(from_y) * std::sin(phi), std::cos(from_y), -std::sin(from_y) * std::cos(phi)));
            if (dot(w, mirrored) > std::cos(12 * k_degree)) image.at(x, y) = {30, 30, 30};
        }
    const Mean drawn = mean_of(picture(sampled(lacquer), k_plane, plane_camera(theta), 64, 1, Environment(image),
                                       k_world, LightDraws::material));
    for (std::size_t c = 0; c < 3; ++c) {
        const double relative = drawn.error[c] / drawn.value[c];
        EXPECT_LT(64 * 64 * relative * relative, 1) << c;  // the relative variance of a draw
    }
}

TEST_P(RasterEnvironments, UniformLightShowsTheDirectionalAlbedo) {
    const Environment uniform_light(Image(8, 4, {1, 1, 1}));
    const bool is_es = GetParam() == Dialect::es_300;  // whose text is the same
    auto drawn_film = made(sampled_film()), drawn_both = made(sampled_both());
    for (const double degrees : {5.0, 60.0, 80.0}) {
        if (is_es && degrees != 60) continue;
        const Vec3f wv = to_float(spherical(degrees * k_degree, 0.0));
        const auto expected = quadrature(evaluator(film_pm()), wv, uniform_light, k_world);
        for (const LightDraws draws : {LightDraws::both, LightDraws::material}) {
            const Mean found = mean_of(
                picture(drawn_film, k_plane, plane_camera(degrees * k_degree), 32, 16, uniform_light, k_world, draws));
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_TRUE(near(found.value[c], expected[c], 0.004 * expected[c] + 4 * found.error[c]))
                    << degrees << ' ' << int(draws) << ": " << found.value[c] << ' ' << expected[c];
        }
    }
    // Of a BSDF what both sides scatter, and what the beams let through.
    const Model both{full_bsdf(), {}};
    const auto& [parts, beams] = std::get<BsdfModel>(both.model);
    for (const double degrees : {20.0, 60.0, 110.0, 150.0}) {
        if (is_es && degrees != 60 && degrees != 110) continue;
        const Vec3f wv = to_float(spherical(degrees * k_degree, 0.0));
        const Vec3f from = mirror(wv);
        const bool back = wv.z < 0;
        const Part reflected = back ? Part::reflection_back : Part::reflection_front,
                   transmitted = back ? Part::transmission_front : Part::transmission_back;
        auto expected =
            quadrature(evaluator(*parts[std::size_t(reflected)]), {wv.x, wv.y, std::abs(wv.z)}, uniform_light, k_world);
        const auto through = quadrature(evaluator(*parts[std::size_t(transmitted)]), {wv.x, wv.y, std::abs(wv.z)},
                                        uniform_light, k_world);
        for (std::size_t c = 0; c < 3; ++c)
            for (const double more : {through[c], double(share_at(beams, reflected, from)[int(c)]),
                                      double(share_at(beams, transmitted, from)[int(c)])})
                expected[c] += more;
        for (const LightDraws draws : {LightDraws::both, LightDraws::material, LightDraws::light}) {
            const Mean found = mean_of(
                picture(drawn_both, k_plane, plane_camera(degrees * k_degree), 32, 16, uniform_light, k_world, draws));
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_TRUE(near(found.value[c], expected[c], 0.004 * expected[c] + 4 * found.error[c]))
                    << degrees << ' ' << int(draws) << ": " << found.value[c] << ' ' << expected[c];
        }
    }
    // Whatever there is no surface in is the environment itself.
    for (const Float4& pixel :
         picture(sampled(k_ggx), k_plane, {{0, 0, 1}, {0, 0, 9}, {0, 1, 0}, 1}, 8, 2, uniform_light, k_world))
        for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(pixel[c], 1);
}

TEST_P(RasterEnvironments, ConvergeToThePathTracer) {
    constexpr int size = 16;
    static const SuModel su = isotropic_su(128);
    const Mesh mesh = sphere(48);
    const Camera camera = camera_of(mesh, {}, 1);
    const auto check = [&](const char* name, const SampledMaterial& of, const PreparedBsdf& brdf, const Mesh& shape) {
        static std::map<std::string, Image> of_paths;  // for both dialects
        Image& expected = of_paths[name];
        if (expected.pixels.empty()) {
            PathScene scene{{{&shape, 0}}, {brdf}, camera, {}, {}, &coloured_light()};
            PathOptions options;
            options.width = options.height = size, options.samples = 1024, options.occlusion = false,
            options.threads = 1;
            expected = render_paths(scene, options).rendering.radiance;
        }
        auto drawn = made(of);
        const auto picture_of = [&](int samples) {
            Image image(size, size);
            const auto pixels = picture(drawn, shape, camera, size, samples, coloured_light(),
                                        environment_frame(camera), LightDraws::both);
            for (std::size_t i = 0; i < pixels.size(); ++i)
                image.pixels[i] = {pixels[i][0], pixels[i][1], pixels[i][2]};
            return image;
        };
        const float exposure = automatic_exposure(expected);
        const std::vector<float> whole(expected.pixels.size(), 1);
        const Image8 reference = shown({expected, whole}, exposure);
        const auto likeness_of = [&](const Image& image) {
            return likeness(reference, shown({image, whole}, exposure));
        };
        const Likeness few = likeness_of(picture_of(4)), many = likeness_of(picture_of(256));
        EXPECT_GE(many.psnr, 44.5) << name;
        EXPECT_GE(many.psnr, few.psnr + 8) << name;
    };
    static const PreparedBrdf film_brdf = prepared(film_pm()), table_brdf = prepared(film_table());
    static const SampledMaterial table = sampled(film_table());
    check("pm", sampled_film(), film_brdf, mesh);
    if (GetParam() == Dialect::gl_450) {  // whose text is the same in the other
        check("su", sampled(su), prepared(su), mesh);
        check("ggx", sampled(k_ggx), prepared(k_ggx), mesh);
    }
    check("table", table, table_brdf, mesh);
    // Both sides, from outside and, in one of the dialects, from inside.
    static const PreparedBsdf both_brdf = prepare_bsdf(Model{full_bsdf(), {}}, {.threads = 1});
    Mesh inside = mesh;
    std::erase_if(inside.triangles,
                  [&](const Triangle& t) { return dot(to_double(inside.positions[t[0]]), camera.eye) > 0; });
    check("bsdf", sampled_both(), both_brdf, mesh);
    if (GetParam() == Dialect::gl_450) check("bsdf inside", sampled_both(), both_brdf, inside);
}

TEST_P(RasterEnvironments, Repeat) {
    const Camera camera = camera_of(sphere(32), {}, 1);
    const auto once = [&] {
        return picture(sampled(k_ggx), sphere(32), camera, 24, 8, coloured_light(), environment_frame(camera));
    };
    EXPECT_EQ(once(), once());
}

TEST_P(RasterEnvironments, TooLargeForTexturesAreRefused) {
    const auto refused = RasterEnvironment::make(Environment(Image(40000, 1, {1, 1, 1})));
    ASSERT_FALSE(refused);
    EXPECT_NE(message(refused.error()).find("40001"), std::string::npos) << message(refused.error());
}

IN_EACH_DIALECT(RasterEnvironments);

TEST(Render, TakesAnEnvironmentInTheRasterRenderer) {
    if (const auto context = OffscreenContext::make(); !context) GTEST_SKIP() << message(context.error());
    const TemporaryFolder folder;
    ASSERT_TRUE(save_model({film_pm(), {}}, folder / "pm.srbf").ok());
    const auto render = [&](const std::string& environment) {
        return run(folder, {"render", "pm.srbf", "--renderer", "raster", "--env", environment, "--spp", "2", "--size",
                            "48x32", "-o", "x.png"});
    };
    const ProgramRun made = render("studio");
    EXPECT_EQ(made.status, 0) << made.err;
    EXPECT_TRUE(contents(folder / "x.png").starts_with("\x89PNG\r\n\x1a\n"));
    std::filesystem::remove(folder / "x.png");
    write(folder / "cut.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\nno texels here, but forty or so bytes");
    for (const char* bad : {"missing.hdr", "cut.hdr"}) {
        const ProgramRun refused = render(bad);
        EXPECT_EQ(refused.status, 1);
        EXPECT_NE(refused.err.find(bad), std::string::npos);
        EXPECT_EQ(std::ranges::count(refused.err, '\n'), 1) << refused.err;
        EXPECT_FALSE(std::filesystem::exists(folder / "x.png"));
    }
}

}  // namespace
}  // namespace srbf::raster_environment_test
