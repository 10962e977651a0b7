// The material of three.js shows what the desktop's renderer shows.
#include <fmt/format.h>
#include <sys/wait.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "fit/fits.h"
#include "models.h"
#include "render/html.h"
#include "render/offscreen.h"
#include "render/page.h"
#include "render/path.h"
#include "render/preview.h"
#include "render/raster.h"
#include "render/scene.h"
#include "srbf/convert.h"
#include "srbf/shading_code.h"
#include "temporary_folder.h"

namespace srbf::three_test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr int k_width = 320, k_height = 240;

/// What three.js is given of a scene.
Json json_of(const Scene& scene, const std::string& material, float exposure, bool as_instance, int width = k_width,
             int height = k_height) {
    Json of{{"width", width},
            {"height", height},
            {"material", material},
            {"exposure", exposure},
            {"many", as_instance},
            {"fov", scene.camera.fov / k_degree},
            {"eye", {scene.camera.eye.x, scene.camera.eye.y, scene.camera.eye.z}},
            {"target", {scene.camera.target.x, scene.camera.target.y, scene.camera.target.z}}};
    for (const DirectionalLight& light : scene.lights)
        of["lights"].push_back({{"towards", {light.towards.x, light.towards.y, light.towards.z}},
                                {"irradiance", {light.irradiance.r, light.irradiance.g, light.irradiance.b}}});
    of["positions"] = base64(std::as_bytes(std::span(scene.mesh.positions)));
    of["normals"] = base64(std::as_bytes(std::span(scene.mesh.normals)));
    of["triangles"] = base64(std::as_bytes(std::span(scene.mesh.triangles)));
    return of;
}

/// PSNR [dB] over the pixels that the mesh covers.
double psnr(const std::string& rgba, const Image8& picture, const std::vector<float>& coverage) {
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < picture.pixels.size() && rgba.size() == 4 * picture.pixels.size(); ++i)
        for (std::size_t c = 0; c < 3 && coverage[i] >= 1; ++c, ++count) {
            const double apart = double(std::uint8_t(rgba[4 * i + c])) - double(picture.pixels[i][c]);
            squares += apart * apart;
        }
    return count > 0 ? 10 * std::log10(255 * 255 * count / std::max(squares, 1e-3)) : 0;
}

// A sphere before the viewer, under light that has an extent.
constexpr int k_small = 96;
PathScene sphere_under(const Scene& scene, const Model& model) {
    PathScene of;
    of.bodies = {{&scene.mesh, 0}};
    of.materials.push_back(prepare(model));
    of.camera = scene.camera;
    return of;
}
/// Its picture by paths that reach all light.
Rendering traced(const PathScene& scene) {
    PathOptions options;
    options.width = options.height = k_small, options.samples = 256, options.bounces = 1, options.occlusion = false;
    return render_paths(scene, options).rendering;
}
/// An environment as three.js holds it: rows from the bottom, columns from -x.
Json json_of(const Environment& environment) {
    const Image& image = environment.texels();
    std::vector<Float4> texels;
    for (int y = image.height; y-- > 0;)
        for (int x = 0; x < image.width; ++x) {
            const Rgb& of = image.at((x + image.width / 4) % image.width, y);
            texels.push_back({of.r, of.g, of.b, 1});
        }
    return {{"width", image.width}, {"height", image.height}, {"texels", base64(std::as_bytes(std::span(texels)))}};
}

TEST(Three, ShowsWhatTheDesktopShows) {
    const fs::path three = shared_data().parent_path() / "peers" / "three";
    if (!fs::exists(three)) GTEST_SKIP() << "no three.js at " << three;
    auto context = OffscreenContext::make();
    if (!context) GTEST_SKIP() << message(context.error());

    std::mt19937_64 random(1);
    const Measured film = *load_measured(bundled_data() / "cc_ibiza_sunset_rgb.bsdf");
    const std::vector<Model> models{
        {rounded(fit_pm(*observe(signed_evaluator(film), {}), {.lobes = 4, .variates = 3, .starts = 2})->model), {}},
        {rounded(random_model(random, {.axial = false, .lobes = 4, .most_bandwidth = 60})), {{"note", "`${a}\\"}}},
        {rounded(GgxModel{{0.1f, 0.2f, 0.4f}, {{0.1f, {0.1f, 0.05f, 0.02f}, 0.9f}, {0.5f, {0, 0.03f, 0.2f}, 0.4f}}}),
         {}},
        {rounded(GgxModel{{0.5f, 0.25f, 0.125f}, {{0.5f, {0, 0, 0}, 0}}}), {}}};
    const std::vector<NamedModel> named{
        {"film", &models[0]}, {"brushed_x", &models[1]}, {"ggx", &models[2]}, {"lambert", &models[3]}};
    const std::array<const char*, 3> classes{"FilmMaterial", "BrushedXMaterial", "GgxMaterial"},
        meshes{"ball", "knot", "sphere"};

    const TemporaryFolder folder;
    const auto module = three_module(named, "materials"), one = three_module(std::span(named).first(1), "film");
    ASSERT_TRUE(module && one);
    write(folder / "materials.js", *module);
    write(folder / "film.js", *one);
    for (const char* name : {"three.module.js", "three.core.js"}) fs::copy_file(three / name, folder / name);
    fs::copy_file(fs::path(SRBF_SOURCE_DIR) / "examples" / "three.html", folder / "three.html");

    Json scenes;
    std::vector<Image8> expected;
    std::vector<std::vector<float>> covered;
    for (std::size_t i = 0; i < classes.size(); ++i) {
        const Scene scene = scene_of(page_mesh(meshes[i]), {}, double(k_width) / k_height);
        const float exposure = automatic_exposure(render_sphere(evaluator(models[i]), {.size = 80, .samples = 1}));
        const RasterView view{scene.camera, double(k_width) / k_height, scene.lights, exposure};
        const RasterMesh mesh(scene.mesh);
        const Material content = std::visit(
            [](const auto& of) {
                if constexpr (std::is_same_v<decltype(of), const BsdfModel&>)
                    return Material();
                else
                    return Material(of);
            },
            models[i].model);
        const auto material = RasterMaterial::make(content, {.dialect = context->dialect()});
        const auto target = RasterTarget::make(k_width, k_height, 1, RasterTarget::Format::bytes);
        const auto surface = RasterSurface::make(context->dialect(), k_width, k_height);
        ASSERT_TRUE(material && target && surface);
        surface->draw(mesh, view);
        target->begin();
        material->draw(mesh, view);
        expected.push_back(target->read_bytes());
        covered.emplace_back();
        for (const Float4& position : surface->read_positions()) covered.back().push_back(position[3] > 0 ? 1.f : 0.f);
        scenes.push_back(json_of(scene, classes[i], exposure, i == 1));
    }
    // Under an environment, and by a soft box.
    Image map = load_environment("studio")->texels();
    while (map.width > 128) map = halved(map);
    const Environment environment(map);
    Scene scene = scene_of(page_mesh("sphere"), {.azimuth = 0, .elevation = 0}, 1);
    scene.lights.clear();
    const double radius = scene.mesh.positions[0].y;
    for (const std::size_t i : {0, 2}) {
        const bool is_area = i == 2;
        PathScene of = sphere_under(scene, models[i]);
        Json light;
        if (is_area) {
            const Vec3f centre{2, 2, 2}, x{std::sqrt(2.f), 0, -std::sqrt(2.f)}, y{-0.8f, 1.6f, -0.8f};
            of.area_lights.push_back({to_float(radius * to_double(centre + 0.5f * x - 0.5f * y)),
                                      to_float(-radius * to_double(x)),
                                      to_float(radius * to_double(y)),
                                      {3, 4, 5}});
            light = {{"radiance", {3, 4, 5}},
                     {"centre", {2 * radius, 2 * radius, 2 * radius}},
                     {"width", 2 * radius},
                     {"height", std::sqrt(3.84) * radius}};
        } else {
            of.environment = &environment;
        }
        const Rendering rendering = traced(of);
        Image lit = rendering.radiance;
        for (std::size_t k = 0; k < lit.pixels.size(); ++k)
            if (rendering.coverage[k] < 1) lit.pixels[k] = {};
        const float exposure = automatic_exposure(lit);
        expected.push_back(shown(rendering, exposure));
        covered.push_back(rendering.coverage);
        Json& json = scenes.emplace_back(json_of(scene, classes[i], exposure, false, k_small, k_small));
        json["lights"] = Json::array();
        json[is_area ? "area" : "environment"] = is_area ? light : json_of(environment);
    }
    write(folder / "scenes.json", scenes.dump());

    const int status =
        std::system(fmt::format("PYTHONDONTWRITEBYTECODE=1 timeout 280 python3 '{}/test/three.py' '{}' > '{}' 2>&1",
                                SRBF_SOURCE_DIR, folder.path.string(), (folder / "said").string())
                        .c_str());
    const std::string said = contents(folder / "said");
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77) GTEST_SKIP() << said;
    ASSERT_EQ(status, 0) << said;
    const Json result = Json::parse(said);
    EXPECT_EQ(result["problems"], Json::array());
    EXPECT_GT(result["colours"], 100);
    EXPECT_GE(result["psnr"], 45);
    // Of the crude fit of a film, and of a model by the terminator of an area light; without these lights 10 to 15.
    const std::array<double, 5> least{45, 45, 45, 24, 30};
    for (std::size_t i = 0; i < least.size(); ++i)
        EXPECT_GE(psnr(contents(folder / fmt::format("{}.rgba", i)), expected[i], covered[i]), least[i]) << i;
}

}  // namespace
}  // namespace srbf::three_test
