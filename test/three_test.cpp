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
Json json_of(const Scene& scene, const std::string& material, float exposure, bool as_instance) {
    Json of{{"width", k_width},
            {"height", k_height},
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
double psnr(const std::string& rgba, const Image8& picture, const std::vector<Float4>& positions) {
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < picture.pixels.size() && rgba.size() == 4 * picture.pixels.size(); ++i)
        for (std::size_t c = 0; c < 3 && positions[i][3] > 0; ++c, ++count) {
            const double apart = double(std::uint8_t(rgba[4 * i + c])) - double(picture.pixels[i][c]);
            squares += apart * apart;
        }
    return count > 0 ? 10 * std::log10(255 * 255 * count / std::max(squares, 1e-3)) : 0;
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
    std::vector<std::vector<Float4>> covered;
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
        covered.push_back(surface->read_positions());
        scenes.push_back(json_of(scene, classes[i], exposure, i == 1));
    }
    write(folder / "scenes.json", scenes.dump());

    const int status =
        std::system(fmt::format("PYTHONDONTWRITEBYTECODE=1 timeout 100 python3 '{}/test/three.py' '{}' > '{}' 2>&1",
                                SRBF_SOURCE_DIR, folder.path.string(), (folder / "said").string())
                        .c_str());
    const std::string said = contents(folder / "said");
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77) GTEST_SKIP() << said;
    ASSERT_EQ(status, 0) << said;
    const Json result = Json::parse(said);
    EXPECT_EQ(result["problems"], Json::array());
    EXPECT_GT(result["colours"], 100);
    EXPECT_GE(result["psnr"], 45);
    for (std::size_t i = 0; i < classes.size(); ++i)
        EXPECT_GE(psnr(contents(folder / fmt::format("{}.rgba", i)), expected[i], covered[i]), 45) << classes[i];
}

}  // namespace
}  // namespace srbf::three_test
