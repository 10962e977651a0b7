// Path tracing: furnace tests, closed forms of direct light, and equal pictures by all sampling strategies.
#include "extras/render/path.h"

#include <tbb/global_control.h>

#include "brdf_functions.h"
#include "command.h"
#include "extras/render/exr.h"
#include "extras/render/rays.h"
#include "models.h"
#include "srbf/file.h"
#include "statistics.h"
#include "su_models.h"

namespace srbf::path_test {
namespace {

const Environment& uniform_light() {
    static const Environment environment(Image(8, 4, {1, 1, 1}));
    return environment;
}
const Mesh& ball_mesh() {
    static const Mesh mesh = sphere(64);
    return mesh;
}

/// A BRDF that is NaN everywhere: nothing was measured.
struct Unmeasured {};
Rgb value(const Unmeasured&, Vec3f, Vec3f) { return {NAN, NAN, NAN}; }

/// 0.01 / cosθv of the light, without bound where the viewer grazes.
struct Grazing {};
Rgb value(const Grazing&, Vec3f, Vec3f wv) {
    const float f = 0.01f / (float(k_pi) * wv.z);
    return {f, f, f};
}

/// A sphere of the given BRDF, without ground.
PathScene sphere_scene(const PreparedBrdf& brdf, const Environment* environment) {
    PathScene scene{{{&ball_mesh(), 0}}, {brdf}, {}, {}, {}, environment};
    scene.camera = camera_of(ball_mesh(), {}, 1);
    return scene;
}
PathOptions small(int samples, int size = 24) {
    PathOptions options;
    options.width = options.height = size;
    options.samples = samples;
    return options;
}

/// A square of 20 × 20 about the origin that faces +z, seen from (0, 0, 5) with a field of view so small that it is a
/// single point. A map has its first row at the top.
const Mesh& plane_mesh() {
    static const Mesh mesh{{{-10, -10, 0}, {10, -10, 0}, {10, 10, 0}, {-10, 10, 0}},
                           std::vector<Vec3f>(4, {0, 0, 1}),
                           {{0, 1, 2}, {0, 2, 3}},
                           {{{{0, 1}, {1, 1}, {1, 0}}}, {{{0, 1}, {1, 0}, {0, 0}}}}};
    return mesh;
}
PathScene plane_scene(const PreparedBrdf& brdf) {
    PathScene scene{{{&plane_mesh(), 0}}, {brdf}, {}, {}, {}, nullptr};
    scene.camera = {{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 1e-4};
    return scene;
}

Image drawn(const PathScene& scene, const PathOptions& options) {
    return render_paths(scene, options).rendering.radiance;
}
/// The green channel of all pixels, as independent samples of one number.
Moments greens_of(const Image& image) {
    Moments greens;
    for (const Rgb& pixel : image.pixels) greens.add(double(pixel.g));
    return greens;
}
Moments drawn_greens(const PathScene& scene, const PathOptions& options) { return greens_of(drawn(scene, options)); }

PmModel glossy() { return axial_gaussians({{0.2f, 0.2f, 0.2f}, {1.5f, 1.5f, 1.5f}}, {0, 60}); }

/// A BSDF of both sides that scatters or passes all light: a quarter is reflected, as much transmitted, half passes
/// unscattered.
PreparedBsdf lossless() {
    BsdfModel bsdf;
    const auto quarter = std::make_shared<const Model>(Model{GgxModel{{0.25f, 0.25f, 0.25f}, {{1, {}, 0}}}, {}});
    bsdf.part[std::size_t(Part::reflection_front)] = bsdf.part[std::size_t(Part::transmission_front)] = quarter;
    bsdf.beam[2] = {{0.f, float(k_pi / 2)}, {{0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}}};
    return prepare_bsdf(Model{bsdf, {}}, {.threads = 1});
}

class Path : public testing::Test {
    void SetUp() override { SKIP_UNDER_SANITIZERS("paths take too long"); }
};

TEST_F(Path, ThinSpherePassesTheWhiteFurnaceTest) {
    PathScene scene = sphere_scene(diffuse({}), &uniform_light());
    scene.materials = {lossless()};
    PathOptions options = small(256);
    options.bounces = 64;
    const Moments greens = drawn_greens(scene, options);
    EXPECT_WITHIN(greens.mean(), 1, 3 * greens.deviation_of_mean() + 0.003);
}

/// Through a plane in front of light on one side, from either side: what passes unscattered and what is transmitted.
TEST_F(Path, LightPassesThroughAPlane) {
    for (const double eye : {5.0, -5.0}) {
        PathScene scene = plane_scene(diffuse({}));
        scene.materials = {lossless()};
        scene.camera.eye.z = eye;
        // A square light beyond it, which covers a cone about the axis; E is its irradiance over its radiance.
        const float z = eye > 0 ? -2.f : 2.f;
        AreaLight light{{-1, -1, z}, {2, 0, 0}, {0, 2, 0}, {1, 1, 1}};
        if (eye < 0) std::swap(light.x, light.y);  // towards the plane
        scene.area_lights = {light};
        const double h = 2, q = std::sqrt(1 + h * h), form = 4 / k_pi * 1 / q * std::atan(1 / q);
        const Moments greens = drawn_greens(scene, small(64, 32));
        EXPECT_WITHIN(greens.mean(), 0.5 + 0.25 * form, 4 * greens.deviation_of_mean() + 1e-3) << eye;
    }
}

TEST_F(Path, PassesTheWhiteFurnaceTest) {
    const PmModel model = axial_gaussians({grey(1 / k_pi)}, {0});
    const MixtureProposal mixture = propose(evaluator(model));
    for (const PreparedBrdf& brdf : {diffuse({1, 1, 1}), prepare(model, mixture)}) {
        EXPECT_WITHIN(drawn_greens(sphere_scene(brdf, &uniform_light()), small(400, 32)).mean(), 1, 1e-3);
    }
}

TEST_F(Path, NothingIsLostBetweenWhiteSurfaces) {
    // A white ball on white ground: after interreflection all light leaves the scene.
    PathScene scene = sphere_scene(diffuse({1, 1, 1}), &uniform_light());
    const Mesh ground = ground_below(ball_mesh(), scene.camera.up, 4);
    scene.bodies.push_back({&ground, 0});
    PathOptions options = small(200, 32);
    options.bounces = 1000;
    const Moments greens = drawn_greens(scene, options);
    EXPECT_WITHIN(greens.mean(), 1, 3e-3);
    options.bounces = 1;
    EXPECT_LT(drawn_greens(scene, options).mean(), 0.97);
}

TEST_F(Path, DirectionalLightMatchesTheClosedForm) {
    PathScene scene = plane_scene(diffuse({0.5f, 0.5f, 0.5f}));
    const double theta = 50 * k_degree;
    scene.lights = {{spherical(theta, 1.0), {3, 3, 3}}};
    const PathPicture picture = render_paths(scene, small(1, 4));
    for (const Rgb& pixel : picture.rendering.radiance.pixels)
        EXPECT_WITHIN(double(pixel.g), 0.5 / k_pi * 3 * std::cos(theta), 1e-5);
}

TEST_F(Path, AreaLightMatchesTheClosedForm) {
    // Irradiance at the point below a corner of a square s × s at height d; four of them form the light.
    const double s = 2, d = 1.5, x = s / d;
    const double quarter = x / std::sqrt(1 + x * x) * std::atan(x / std::sqrt(1 + x * x));  // times L
    for (const bool glossy_surface : {false, true}) {
        const PmModel model = glossy();
        PathScene scene =
            plane_scene(glossy_surface ? prepare(model, propose(evaluator(model))) : diffuse({0.5f, 0.5f, 0.5f}));
        const float t = float(2 * s);
        scene.area_lights = {{{float(-s), float(-s), float(d)}, {0, t, 0}, {t, 0, 0}, {2, 2, 2}}};  // shines to -z
        scene.camera.eye = {3, 0, 4};
        const Moments greens = drawn_greens(scene, small(300));
        if (!glossy_surface) {
            EXPECT_WITHIN_RELATIVE(greens.mean(), 0.5 / k_pi * 2 * 4 * quarter, 4e-3);
        } else {
            double expected = 0;  // by points of the square
            const Vec3f wv = normalize(Vec3f{3, 0, 4});
            constexpr int n = 400;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const Vec3d p{s * (2 * (i + 0.5) / n - 1), s * (2 * (j + 0.5) / n - 1), d};
                    const double r = std::sqrt(dot(p, p));
                    expected += double(value(model, to_float((1 / r) * p), wv).g) * 2 * (d / r) * (d / r) / (r * r) *
                                (2 * s / n) * (2 * s / n);
                }
            EXPECT_WITHIN(greens.mean(), expected, 5 * greens.deviation_of_mean() + 1e-3 * expected);
        }
        // From behind it is dark, and so it is to a viewer below it.
        scene.camera.eye = {3, 0, 1};
        scene.area_lights[0] = {{float(-s), float(-s), float(d)}, {t, 0, 0}, {0, t, 0}, {2, 2, 2}};
        EXPECT_EQ(drawn_greens(scene, small(4)).mean(), 0);
    }
}

TEST_F(Path, LightsAreSeen) {
    PathScene scene = plane_scene(diffuse({0, 0, 0}));
    scene.area_lights = {{{-1, -1, 2}, {2, 0, 0}, {0, 2, 0}, {7, 8, 9}}};
    const PathPicture picture = render_paths(scene, small(1, 4));
    EXPECT_EQ(picture.rendering.radiance.at(1, 1), (Rgb{7, 8, 9}));
}

TEST_F(Path, AllWaysToDrawGiveOnePicture) {
    const Environment light([] {
        Image image(16, 8, {0.2f, 0.2f, 0.2f});
        image.at(3, 2) = {30, 30, 30};
        return image;
    }());
    const PmModel model = glossy();
    const SuModel su = isotropic_su(64);
    const auto with = [&](const auto& brdf, const Proposal& proposal) {
        return drawn_greens(sphere_scene(prepare(brdf, proposal), &light), small(100, 40)).mean();
    };
    EXPECT_WITHIN_RELATIVE(with(model, CosineProposal{}), with(model, propose(evaluator(model))), 0.01);
    EXPECT_WITHIN_RELATIVE(with(su, CosineProposal{}), with(su, propose(su)), 0.01);
}

/// A map of the two lobes of `glossy`, by the coefficients of each texel.
TexelMap glossy_map(std::vector<std::array<Rgb, 2>> texels, std::size_t width) {
    TexelMap map;
    map.basis = glossy();
    map.basis.coefficient = {{1, 1, 1}, {1, 1, 1}};
    map.width = width;
    map.error.assign(texels.size(), 0);
    for (const auto& [diffuse, gloss] : texels) map.coefficient.insert(map.coefficient.end(), {diffuse, gloss});
    return map;
}

TEST_F(Path, AConstantMapIsItsModel) {
    const std::array<Rgb, 2> coefficients{{{0.2f, 0.1f, 0.05f}, {1.5f, 1.5f, 1.5f}}};
    const TexelMap map = glossy_map(std::vector(6, coefficients), 3);
    const PreparedMap prepared = prepare_map(map);
    PathScene scene = sphere_scene(prepare(texel(map, 0)), &uniform_light());
    const auto drawn_with = [&](const PathMaterial& material, std::uint64_t seed) {
        scene.materials = {material};
        PathOptions options = small(256);
        options.bounces = 1;
        options.seed = seed;
        return drawn(scene, options);
    };
    const double model = greens_of(drawn_with(scene.materials[0], 1)).mean(),
                 same = greens_of(drawn_with(prepared, 2)).mean();
    EXPECT_WITHIN(same, model, 2e-3);  // four deviations of the difference of two seeds
    // Values alone, without noise.
    scene.environment = nullptr;
    scene.lights = {{normalize(Vec3d{-1, 1, 2}), {1, 1, 1}}};
    const Image expected = drawn_with(prepare(texel(map, 0)), 1), found = drawn_with(prepared, 1);
    for (std::size_t i = 0; i < found.pixels.size(); ++i)
        EXPECT_RGB_WITHIN_RELATIVE(found.pixels[i], expected.pixels[i], 1e-4, 1e-5);
}

TEST_F(Path, AMapShowsEachOfItsTexels) {
    const std::array<Rgb, 2> red{{{0.2f, 0, 0}, {}}}, green{{{0, 0.2f, 0}, {}}};
    PathScene scene{
        {{&plane_mesh(), 0}}, {prepare_map(glossy_map({red, green, green, green}, 2))}, {}, {}, {}, nullptr};
    scene.lights = {{{0, 0, 1}, {1, 1, 1}}};
    const auto at = [&](double x, double y) {
        scene.camera = {{x, y, 5}, {x, y, 0}, {0, 1, 0}, 1e-4};
        const Rgb f = drawn(scene, small(1, 1)).pixels[0];
        return std::array<double, 2>{double(f.r), double(f.g)};
    };
    const auto expect = [&](double x, double y, double red_share) {
        EXPECT_WITHIN(at(x, y)[0], 0.2 * red_share, 1e-5) << x << ' ' << y;
        EXPECT_WITHIN(at(x, y)[1], 0.2 * (1 - red_share), 1e-5) << x << ' ' << y;
    };
    expect(-5, 5, 1);  // the middles of texels
    expect(5, 5, 0);
    expect(-5, -5, 0);
    expect(0, 5, 0.5);  // between them
    expect(-2.5, 2.5, 0.75 * 0.75);
    expect(-10, 5, 0.5);  // where the map is repeated
}

TEST_F(Path, AMaskMixesMaterials) {
    const auto colour = [](const Rgb& albedo) -> PreparedBsdf {
        return prepare(Model{GgxModel{albedo, {{1, {}, 0}}}, {}});
    };
    Image mask(2, 1);
    mask.pixels = {{0, 0, 0}, {0.5f, 0.25f, 0}};
    PathScene scene{{{&plane_mesh(), 0}}, {}, {}, {{{0, 0, 1}, {float(k_pi), float(k_pi), float(k_pi)}}}, {}, nullptr};
    const auto at = [&](double x) {
        scene.camera = {{x, 0, 5}, {x, 0, 0}, {0, 1, 0}, 1e-4};
        return drawn(scene, small(4096, 1)).pixels[0];
    };
    scene.materials = {MaskedMaterials{{colour({1, 0, 0}), colour({0, 1, 0}), colour({0, 0, 1})}, mask}};
    EXPECT_WITHIN(at(-5).r, 1, 1e-4);
    const Rgb mixed = at(5), between = at(0);
    EXPECT_RGB_WITHIN(mixed, (Rgb{0.25f, 0.5f, 0.25f}), 0.03);
    EXPECT_RGB_WITHIN(between, (Rgb{0.625f, 0.25f, 0.125f}), 0.03);
    scene.materials = {MaskedMaterials{{colour({1, 0, 0}), colour({0, 1, 0})}, mask}};
    EXPECT_WITHIN(at(5).r, 0.5, 0.03);
}

/// The mean of draws is the albedo, and their variance not much more than by the texel's own mixture.
TEST_F(Path, TexelsAreDrawnFromTheirLobes) {
    std::mt19937_64 random(5);
    for (const bool axial : {true, false}) {
        const TexelMap map = random_map(random, {.axial = axial, .lobes = 4, .max_bandwidth = 200}, 4, 2);
        const PreparedMap prepared = prepare_map(map);
        const std::size_t t = 5;
        const PreparedBrdf single = prepare(texel(map, t)),
                           shared = brdf_at(prepared, {(float(t % 4) + 0.5f) / 4, (float(t / 4) + 0.5f) / 2});
        for (const double z : {0.2, 0.7}) {
            const Vec3f wv = to_float(spherical(std::acos(z), 1.0));
            Moments by_single, by_shared;
            for (int i = 0; i < 20000; ++i) {
                const Vec3f u = uniform_point(random);
                by_single.add(double(sample(single, wv, {u.x, u.y}, u.z).weight.g));
                by_shared.add(double(sample(shared, wv, {u.x, u.y}, u.z).weight.g));
            }
            const double mean = by_single.mean(), deviation = std::sqrt(by_single.variance() + by_shared.variance());
            EXPECT_WITHIN(by_shared.mean(), mean, 4 * deviation / std::sqrt(by_single.count)) << axial;
            EXPECT_LT(by_shared.variance(), 2 * by_single.variance() + 0.15 * mean * mean) << axial << z;
        }
    }
}

TEST_F(Path, EnvironmentStandsUpright) {
    Image image(16, 8);
    for (int x = 0; x < 16; ++x) image.at(x, 0) = image.at(x, 1) = {1, 1, 1};  // above
    const Environment above(image);
    PathScene scene = plane_scene(diffuse({1, 1, 1}));
    scene.environment = &above;
    scene.camera.eye = {0, -0.1, 5};
    // With the plane's normal upwards its light is above; with another axis upwards it comes from the side.
    scene.camera.up = {0, 0, 1};
    const double upright = drawn_greens(scene, small(50)).mean();
    scene.camera.up = {0, 0, -1};
    EXPECT_WITHIN(drawn_greens(scene, small(50)).mean(), 0, 1e-6);
    // cos² of half the angle: the sine squared of 45°, and a texel's rows beyond by bilinearity.
    EXPECT_TRUE(upright > 0.45 && upright < 0.6) << upright;
}

TEST_F(Path, PictureDoesNotDependOnThreads) {
    const PmModel model = glossy();
    const PathScene scene = sphere_scene(prepare(model, propose(evaluator(model))), &uniform_light());
    PathOptions options = small(3, 50);
    options.threads = 1;
    const PathPicture one = render_paths(scene, options);
    options.threads = 0;
    int calls = 0;
    double last = 0;
    options.progress = [&](double part) {
        ++calls;
        last = part;
    };
    const PathPicture all = render_paths(scene, options);
    EXPECT_EQ(one.rendering.radiance, all.rendering.radiance);
    EXPECT_EQ(one.first.normal, all.first.normal);
    EXPECT_EQ(one.rays, all.rays);
    EXPECT_EQ(calls, 16);
    EXPECT_EQ(last, 1);
    options.seed = 1;
    EXPECT_NE(one.rendering.radiance, drawn(scene, options));
}

TEST(Rays, HitTheSphereAtItsDepthAndNormal) {
    PathScene scene = sphere_scene(diffuse({0.25f, 0.5f, 0.75f}), nullptr);
    scene.lights = {{{0, 0, 1}, {1, 1, 1}}};
    const PathPicture picture = render_paths(scene, small(16, 33));
    const auto middle = std::size_t(16 * 33 + 16);
    EXPECT_WITHIN(double(picture.first.normal.pixels[middle].b), 1, 0.01);
    EXPECT_WITHIN(double(picture.first.albedo.pixels[middle].g), 0.5, 1e-5);
    const Vec3d eye = scene.camera.eye;
    EXPECT_WITHIN(double(picture.first.depth[middle]), std::sqrt(dot(eye, eye)) - 1, 0.01);
    EXPECT_EQ(picture.rendering.coverage[middle], 1);
    EXPECT_EQ(picture.rendering.coverage[0], 0);
    EXPECT_EQ(picture.first.depth[0], 0);
    EXPECT_EQ(picture.rendering.radiance.pixels[0], Rgb{});
}

TEST(Rays, AreBlackAtPointsWithoutMeasurement) {
    const PreparedBrdf unmeasured = prepare(Unmeasured{}, CosineProposal{});
    const PathPicture picture = render_paths(sphere_scene(unmeasured, &uniform_light()), small(2));
    for (const Rgb& pixel : picture.rendering.radiance.pixels) EXPECT_TRUE(is_finite(pixel));
    EXPECT_EQ(picture.rendering.radiance.at(12, 12), Rgb{});
}

/// Cosines of views are at least 0.01, also where an interpolated normal points away.
TEST_F(Path, TheRimIsBounded) {
    PathScene scene = sphere_scene(prepare(Grazing{}, CosineProposal{}), &uniform_light());
    PathOptions options = small(4, 128);
    options.occlusion = false;
    float max = 0, min = 1;
    for (const Rgb& pixel : drawn(scene, options).pixels) {
        max = std::max(max, pixel.g);
        min = std::min(min, pixel.g);
    }
    EXPECT_LE(max, 1.01f);   // that of the environment
    EXPECT_LE(min, 0.011f);  // that of the middle of the sphere
}

TEST(Rays, LeaveAllThreadsToTheProcess) {
    using Control = tbb::global_control;
    const auto max = [] { return Control::active_value(Control::max_allowed_parallelism); };
    const std::size_t before = max();
    const Rays rays({&ball_mesh()});
    EXPECT_EQ(max(), before);
}

TEST(Rays, FindTheNearestTriangle) {
    std::mt19937_64 random(1);
    const Mesh mesh = sphere(10), other = knot(40, 8);
    const Rays rays({&mesh, &other});
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
        const Vec3d origin = 3.0 * random_direction(random),
                    direction = normalize(0.7 * random_direction(random) - origin);
        // Möller and Trumbore's test of every triangle.
        double nearest = 1e30;
        for (const Mesh* m : {&mesh, &other})
            for (const Triangle& t : m->triangles) {
                const Vec3d a = to_double(m->positions[t[0]]), e1 = to_double(m->positions[t[1]]) - a,
                            e2 = to_double(m->positions[t[2]]) - a, p = cross(direction, e2), s = origin - a,
                            q = cross(s, e1);
                const double det = dot(e1, p), u = dot(s, p) / det, v = dot(direction, q) / det, at = dot(e2, q) / det;
                if (u >= 0 && v >= 0 && u + v <= 1 && at > 0) nearest = std::min(nearest, at);
            }
        const auto hit = rays.closest(to_float(origin), to_float(direction));
        ASSERT_EQ(hit.has_value(), nearest < 1e30);
        if (!hit) continue;
        ++hits;
        EXPECT_WITHIN(double(hit->distance), nearest, 1e-4);
        EXPECT_WITHIN(double(dot(hit->geometric_normal, hit->geometric_normal)), 1, 1e-5);
        EXPECT_TRUE(rays.occluded(to_float(origin), to_float(direction), hit->distance + 0.01f));
        EXPECT_FALSE(rays.occluded(to_float(origin), to_float(direction), hit->distance - 0.01f));
    }
    EXPECT_GT(hits, 100);
}

/// The mesh has each of the sizes that it may have when it is read.
TEST_F(Path, SceneOfAnySizeIsOnePicture) {
    std::vector<Image> pictures;
    for (const float scale : {1.f, 0x1p-23f, 0x1p22f}) {
        Mesh mesh = ball(24);
        for (Vec3f& p : mesh.positions) p = scale * p;
        const Scene base = scene_of(mesh, {}, 1);
        const Mesh floor = ground_below(base.mesh, base.camera.up);
        const PathScene scene{{{&base.mesh, 0}, {&floor, 0}},
                              {diffuse({0.5f, 0.5f, 0.5f})},
                              base.camera,
                              base.lights,
                              {},
                              &uniform_light()};
        pictures.push_back(drawn(scene, small(16)));
    }
    for (const Image& picture : pictures)
        for (std::size_t i = 0; i < picture.pixels.size(); ++i)
            EXPECT_WITHIN(picture.pixels[i].g, pictures[0].pixels[i].g, 0.1) << i;
}

/// The program's way with good and bad input.
class PathCommand : public ProgramTest {
  protected:
    void SetUp() override { ASSERT_TRUE(save_model({glossy(), {}}, folder / "a.srbf").ok()); }
    static Arguments command_of(const Arguments& arguments) {
        return Arguments{"render", "a.srbf", "--size", "32x24", "--spp", "2"} + arguments;
    }
    ProgramRun render(const Arguments& arguments) { return run_srbf(folder, command_of(arguments)); }
    void expect_refused(const Arguments& arguments, const std::string& part) {
        expect_failure(1, command_of(arguments), part);
    }
};

TEST_F(PathCommand, PicturesAreWritten) {
    EXPECT_EQ(render({"-o", "a.png"}).status, 0);
    EXPECT_TRUE(std::filesystem::exists(folder / "a.png"));
    EXPECT_EQ(render({"-o", "b.png", "--aov"}).status, 2);
    EXPECT_EQ(render({"-o", "a.exr", "--aov", "--lights", "softbox", "--env", "none"}).status, 0);
    const auto image = checked(read_exr(*read_file(folder / "a.exr"), "a.exr"));
    EXPECT_EQ(image->width, 32);
}

TEST_F(PathCommand, PicturesAreCompared) {
    SKIP_UNDER_SANITIZERS("takes too long");
    ASSERT_EQ(render({"-o", "a.exr"}).status, 0);
    // The reference is the same picture, from a file or made anew.
    for (const char* reference : {"a.exr", "a.srbf"}) {
        const ProgramRun result = render({"-o", "b.png", "--compare", reference, "--json", "-"});
        EXPECT_EQ(result.status, 0) << result.err;
        EXPECT_CONTAINS(result.out, "\"flip\": 0.0");
        EXPECT_TRUE(std::filesystem::exists(folder / "b.difference.png"));
    }
    EXPECT_EQ(render({"-o", "b.png", "--compare", "a.exr", "--json", "c.json", "--seed", "1"}).status, 0);
    EXPECT_LACKS(read_text(folder / "c.json"), "\"flip\": 0.0,");
    const Image other(16, 16);
    ASSERT_TRUE(write_exr(16, 16, channels_of(other), folder / "other.exr").ok());
    expect_refused({"-o", "d.png", "--compare", "other.exr"}, "size of the reference");
}

TEST_F(PathCommand, MapsAreDrawnOnMeshesWithPlaces) {
    SKIP_UNDER_SANITIZERS("takes too long");
    const TexelMap map = glossy_map({{{{0.2f, 0, 0}, {}}}, {{{0, 0.2f, 0}, {}}}}, 2);
    ASSERT_TRUE(write_file(folder / "map.srbf", write_map(map)).ok());
    write_text(folder / "bare.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    EXPECT_EQ(render({"map.srbf", "-o", "b.png"}).status, 0);
    EXPECT_EQ(render({"map.srbf#1,0", "-o", "b.png", "--mesh", "bare.obj"}).status, 0);
    expect_refused({"map.srbf", "-o", "c.png", "--mesh", "bare.obj"}, "texture coordinates");
    expect_refused({"map.srbf", "-o", "c.png", "--scene", "room"}, "scene of a map");
    expect_refused({"map.srbf", "-o", "c.png", "--draw", "cosine"}, "draws of a map");
}

TEST_F(PathCommand, TexelsThatAreNoRadianceAreCounted) {
    Image image(8, 4, {1, 1, 1});
    image.at(2, 1) = {-1, 1, 1};
    image.at(3, 1) = {NAN, 1, 1};
    ASSERT_TRUE(write_exr(8, 4, channels_of(image), folder / "e.exr").ok());
    const ProgramRun result = render({"-o", "b.png", "--env", "e.exr"});
    EXPECT_EQ(result.status, 0);
    EXPECT_CONTAINS(result.err, "e.exr: 2 texels");
}

}  // namespace
}  // namespace srbf::path_test
