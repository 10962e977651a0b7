// The material of three.js shows what the desktop's renderer shows.
#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "app/html.h"
#include "app/map_layers.h"
#include "base/half.h"
#include "errors/sphere.h"
#include "extras/render/offscreen.h"
#include "extras/render/page.h"
#include "extras/render/path.h"
#include "extras/render/raster.h"
#include "extras/render/scene.h"
#include "extras/render/test/psnr.h"
#include "models.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/ggx/ggx_kind.h"
#include "models/pm/search/fit_pm.h"
#include "properties.h"
#include "script.h"
#include "srbf/convert.h"
#include "srbf/elementary.h"
#include "srbf/environment_code.h"
#include "srbf/file.h"
#include "temporary_folder.h"

namespace srbf::three_test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr int k_width = 320, k_height = 240;

/// Returns a scene as three.js reads it.
Json json_of(const Scene& scene, const std::string& material, float exposure, bool as_instance) {
    Json json{{"width", k_width},
              {"height", k_height},
              {"material", material},
              {"exposure", exposure},
              {"many", as_instance},
              {"fov", scene.camera.fov / k_degree},
              {"eye", {scene.camera.eye.x, scene.camera.eye.y, scene.camera.eye.z}},
              {"target", {scene.camera.target.x, scene.camera.target.y, scene.camera.target.z}}};
    for (const DirectionalLight& light : scene.lights)
        json["lights"].push_back({{"towards", {light.towards.x, light.towards.y, light.towards.z}},
                                  {"irradiance", {light.irradiance.r, light.irradiance.g, light.irradiance.b}}});
    json["positions"] = base64(std::as_bytes(std::span(scene.mesh.positions)));
    json["normals"] = base64(std::as_bytes(std::span(scene.mesh.normals)));
    json["triangles"] = base64(std::as_bytes(std::span(scene.mesh.triangles)));
    return json;
}

/// PSNR [dB] over the pixels that the mesh covers.
double psnr(const std::string& rgba, const Image8& picture, const std::vector<float>& coverage) {
    if (rgba.size() != 4 * picture.pixels.size()) return 0;
    Psnr psnr;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        if (coverage[i] >= 1) psnr.add(pixel_of(rgba, i), picture.pixels[i]);
    return psnr.count > 0 ? psnr.decibels() : 0;
}

/// Models of three classes of material, and one that is only in the module.
std::vector<Model> drawn_models() {
    std::mt19937_64 random(1);
    const Measured film = *load_measured(bundled_data() / "cc_ibiza_sunset_rgb.bsdf");
    return {
        {rounded(fit_pm(*observe(signed_evaluator(film), {}), {.lobes = 4, .variates = 3, .starts = 2})->model), {}},
        {rounded(random_model(random, {.axial = false, .lobes = 4, .max_bandwidth = 60})), {{"note", "`${a}\\"}}},
        {rounded(GgxModel{{0.1f, 0.2f, 0.4f}, {{0.1f, {0.1f, 0.05f, 0.02f}, 0.9f}, {0.5f, {0, 0.03f, 0.2f}, 0.4f}}}),
         {}},
        {rounded(GgxModel{{0.5f, 0.25f, 0.125f}, {{0.5f, {0, 0, 0}, 0}}}), {}}};
}
constexpr std::array<const char*, 3> k_classes{"FilmMaterial", "BrushedXMaterial", "GgxMaterial"},
    k_meshes{"ball", "knot", "sphere"};

/// Scenes for three.js, with the pictures of the desktop where there are some.
struct Expected {
    Json scenes;
    std::vector<Image8> pictures;
    std::vector<std::vector<float>> covered;
};

/// The picture of the rasterizer under directional lights.
void add_rasterized(Expected& to, const std::vector<Model>& models, Dialect dialect) {
    for (std::size_t i = 0; i < k_classes.size(); ++i) {
        const Scene scene = scene_of(page_mesh(k_meshes[i]), {}, double(k_width) / k_height);
        const float exposure = exposure_under_lights(evaluator(models[i]));
        const RasterView view{scene.camera, double(k_width) / k_height, scene.lights, exposure};
        const RasterMesh mesh(scene.mesh);
        const Material content = std::visit(
            [](const auto& brdf) {
                if constexpr (std::is_same_v<decltype(brdf), const BsdfModel&>)
                    return Material();
                else
                    return Material(brdf);
            },
            models[i].model);
        const auto material = RasterMaterial::make(content, {.dialect = dialect});
        const auto target = RasterTarget::make(k_width, k_height, 1, RasterTarget::Format::bytes);
        const auto surface = RasterSurface::make(dialect, k_width, k_height);
        ASSERT_TRUE(material && target && surface);
        surface->draw(mesh, view);
        target->begin();
        material->draw(mesh, view);
        to.pictures.push_back(target->read_bytes());
        to.covered.emplace_back();
        for (const Float4& position : surface->read_positions())
            to.covered.back().push_back(position[3] > 0 ? 1.f : 0.f);
        to.scenes.push_back(json_of(scene, k_classes[i], exposure, i == 1));
    }
}

TEST(Three, DrawsThePictureOfTheDesktop) {
    const fs::path three = shared_data().parent_path() / "peers" / "three";
    if (!fs::exists(three)) GTEST_SKIP() << "no three.js at " << three;
    auto context = OffscreenContext::make();
    if (!context) GTEST_SKIP() << message(context.error());
    const std::vector<Model> models = drawn_models();
    const std::vector<NamedModel> named{
        {"film", &models[0]}, {"brushed_x", &models[1]}, {"ggx", &models[2]}, {"lambert", &models[3]}};

    const TemporaryFolder folder;
    const auto module = checked(three_module(named, "materials")),
               one = checked(three_module(std::span(named).first(1), "film"));
    write_text(folder / "materials.js", *module);
    write_text(folder / "film.js", *one);
    for (const char* name : {"three.module.js", "three.core.js"}) fs::copy_file(three / name, folder / name);
    fs::copy_file(fs::path(SRBF_SOURCE_DIR) / "examples" / "three.html", folder / "three.html");
    Expected expected;
    add_rasterized(expected, models, context->dialect());
    write_text(folder / "scenes.json", expected.scenes.dump());

    const ScriptRun run = run_script("extras/environment/test/three.py", {folder.path.string()});
    SKIP_IF_UNAVAILABLE(run);
    ASSERT_EQ(run.status, 0) << run.text;
    const Json result = Json::parse(run.text);
    EXPECT_EQ(result["problems"], Json::array());
    EXPECT_GT(result["colours"], 100);
    EXPECT_GE(result["psnr"], 45);
    for (const auto& [what, difference] : result["blend"]["worst"].items()) {
        ASSERT_TRUE(difference.is_number()) << what;  // NaN is null
        EXPECT_LT(difference.get<double>(), 1e-3) << what;
    }
    EXPECT_EQ(result["blend"]["chosen"], 2);  // both materials of a mask are seen
    EXPECT_EQ(result["blend"]["compiled"], 0);
    for (std::size_t i = 0; i < expected.pictures.size(); ++i)
        EXPECT_GE(psnr(read_text(folder / fmt::format("{}.rgba", i)), expected.pictures[i], expected.covered[i]), 45)
            << i;
}

// A plane of 2 × 2 of a map under a directional light.
constexpr double k_irradiance = 2, k_fov = 35 * k_degree;
const Vec3d k_towards = normalize(Vec3d{-1, 2, 3}), k_eye{0, -2, 3};
struct MapScene {
    Json json;
    int size;
    double lod;  ///< of its pixels
    std::array<double, 2> repeat, offset;
    double rotation;
};
/// The coefficients that a texture's filter makes at a place.
class FilteredMap {
  public:
    explicit FilteredMap(const TexelMap& map)
        : map_(map), levels_{{map.width, map.count() / map.width, map.coefficient}} {
        while (levels_.back().width * levels_.back().height > 1) levels_.push_back(coarser(levels_.back()));
    }
    Model at(double u, double v, double lod, bool repeats) const {
        PmModel model = map_.basis;
        model.coefficient.assign(std::size_t(model.lobes), {});
        const auto below = std::size_t(lod);
        const double part = lod - double(below);
        add(levels_[below], 1 - part, u, v, repeats, model);
        if (part > 0) add(levels_[below + 1], part, u, v, repeats, model);
        return {model, {}};
    }

  private:
    static void add(const MapLevel& level, double fraction, double u, double v, bool repeats, PmModel& model) {
        const auto texel = [&](double i, std::size_t n) {
            const auto count = std::int64_t(n), at = std::int64_t(i);
            return std::size_t(repeats ? (at % count + count) % count : std::clamp<std::int64_t>(at, 0, count - 1));
        };
        const std::size_t J = model.coefficient.size();
        const double x = u * double(level.width) - 0.5, y = v * double(level.height) - 0.5;
        for (const double column : {std::floor(x), std::floor(x) + 1})
            for (const double row : {std::floor(y), std::floor(y) + 1}) {
                const auto weight = float(fraction * (1 - std::abs(x - column)) * (1 - std::abs(y - row)));
                const std::size_t t = texel(row, level.height) * level.width + texel(column, level.width);
                for (std::size_t j = 0; j < J; ++j)
                    for (int c = 0; c < 3; ++c) model.coefficient[j][c] += weight * level.coefficient[t * J + j][c];
            }
    }
    const TexelMap& map_;
    std::vector<MapLevel> levels_;
};
std::vector<Float4> floats(const std::string& bytes) {
    std::vector<Float4> pixels(bytes.size() / sizeof(Float4));
    std::memcpy(pixels.data(), bytes.data(), pixels.size() * sizeof(Float4));
    return pixels;
}

/// The largest difference of a picture's radiance from that of the map's models at these levels, the largest radiance,
/// and the mean ΔE_ITP with an exposure that shows the largest as white.
struct Differences {
    double max, largest, delta_e;
};
Differences differences(const std::vector<Float4>& pixels, const MapScene& scene, const FilteredMap& map, double lod) {
    Differences found{};
    std::vector<std::array<Rgb, 2>> colours;
    Camera camera;
    camera.eye = k_eye;
    camera.fov = k_fov;
    const bool is_perspective = scene.json.contains("fov");
    for (int y = 0; y < scene.size; ++y)
        for (int x = 0; x < scene.size; ++x) {
            const double s = (2 * x + 1.0) / scene.size - 1, t = 1 - (2 * y + 1.0) / scene.size;
            Vec3d p{s, t, 0}, to_viewer{0, 0, 1};
            if (is_perspective) {
                to_viewer = -1.0 * direction_through(camera, 1, s, t);
                p = camera.eye - camera.eye.z / to_viewer.z * to_viewer;
            }
            if (std::max(std::abs(p.x), std::abs(p.y)) > 0.98) continue;
            // These formulas are those of three's Matrix3.setUvTransform.
            const double c = std::cos(scene.rotation), sine = std::sin(scene.rotation), u = (p.x + 1) / 2,
                         v = (p.y + 1) / 2;
            const Model model =
                map.at(scene.repeat[0] * (c * u + sine * v) + scene.offset[0],
                       scene.repeat[1] * (c * v - sine * u) + scene.offset[1], lod, scene.json.contains("repeat"));
            const Rgb f = value(model, to_float(k_towards), to_float(to_viewer));
            colours.emplace_back();
            for (int channel = 0; channel < 3; ++channel) {
                const double expected = k_irradiance * k_towards.z * double(f[channel]);
                const double drawn = double(pixels[std::size_t(y * scene.size + x)][std::size_t(channel)]);
                colours.back()[0][channel] = float(expected);
                colours.back()[1][channel] = float(drawn);
                found.largest = std::max(found.largest, expected);
                found.max = std::max(found.max, std::abs(drawn - expected));
            }
        }
    for (auto& [expected, drawn] : colours) {
        for (int c = 0; c < 3; ++c) {
            expected[c] /= float(found.largest);
            drawn[c] /= float(found.largest);
        }
        found.delta_e += delta_e_itp(expected, drawn) / double(colours.size());
    }
    return found;
}

/// A map of one texel, no channel of which reflects more than half of the light.
TexelMap dark_constant(std::mt19937_64& random, const RandomModelOptions& lobes) {
    TexelMap constant = random_map(random, lobes, 1, 1);
    const PreparedBrdf bright = prepare(texel(constant, 0), CosineProposal{});
    float max = 0;
    for (const float cosine : {0.01f, 0.1f, 0.2f, 0.4f, 0.6f, 0.8f, 1.f})
        for (int c = 0; c < 3; ++c) max = std::max(max, albedo(bright, cosine)[c]);
    for (Rgb& f : constant.coefficient)
        for (int c = 0; c < 3; ++c) f[c] *= std::exp2(-std::ceil(std::log2(max)) - 1);  // still 16-bit floats
    return constant;
}

MapScene map_scene(const char* module, const char* class_, int size, double lod) {
    return {{{"module", module},
             {"class", class_},
             {"is_map", true},
             {"size", size},
             {"towards", {k_towards.x, k_towards.y, k_towards.z}},
             {"eye", {0, 0, 3}}},
            size,
            lod,
            {1, 1},
            {0, 0},
            0};
}

constexpr std::size_t k_first_constant = 6;
/// Scenes of the maps, then pairs of the constant map and its material alone.
std::vector<MapScene> map_scenes() {
    std::vector<MapScene> scenes{
        map_scene("map", "MapMaterial", 48, 0),    map_scene("map", "MapMaterial", 48, 0),
        map_scene("fine", "FineMaterial", 8, 2),   map_scene("fine", "FineMaterial", 12, std::log2(32. / 12)),
        map_scene("bytes", "FineMaterial", 32, 0), map_scene("bytes", "FineMaterial", 8, 2)};
    const Json oblique{{"eye", {k_eye.x, k_eye.y, k_eye.z}}, {"fov", k_fov / k_degree}};
    for (const std::size_t i : {0, 1}) scenes[i].json.update(oblique);
    scenes[1].repeat = {2, 3}, scenes[1].offset = {0.1, 0.2}, scenes[1].rotation = 0.5;
    scenes[1].json.update({{"repeat", {2, 3}}, {"offset", {0.1, 0.2}}, {"rotation", 0.5}});
    for (const char* more : {"more_lights", "environment"})
        for (const bool is_map : {true, false}) {
            scenes.push_back(is_map ? map_scene("constant", "ConstantMaterial", 12, 0)
                                    : map_scene("alone", "AloneMaterial", 12, 0));
            scenes.back().json.update({{"is_map", is_map}, {more, true}});
            scenes.back().json.update(oblique);
        }
    return scenes;
}

/// The picture of a scene is that of the filtered map.
void expect_filtered(const std::vector<Float4>& pixels, const MapScene& scene, const FilteredMap& filtered) {
    ASSERT_EQ(pixels.size(), std::size_t(scene.size * scene.size));
    // Between two levels renderers take the logarithm only approximately: Mesa 1.389 instead of 1.415.
    Differences found = differences(pixels, scene, filtered, scene.lod);
    for (double offset = -0.04; offset < 0.04 && scene.lod != std::floor(scene.lod); offset += 0.004)
        if (const Differences at = differences(pixels, scene, filtered, scene.lod + offset); at.max < found.max)
            found = at;
    EXPECT_GT(found.largest, 0.01);
    EXPECT_LT(found.delta_e, 1);
    // Textures' filters keep 8 bits of their weights; bytes are rounded by half a step.
    EXPECT_LT(found.max, found.largest * (scene.json["module"] == "bytes" ? 1 / 128. : 1 / 256.));
}

/// The modules and the textures of the maps.
void write_maps(const TemporaryFolder& folder, const TexelMap& map, const TexelMap& fine, const TexelMap& constant) {
    write_text(folder / "map.js", *three_map_module(map, "map", "map.ktx2"));
    write_text(folder / "constant.js", *three_map_module(constant, "constant", "constant.ktx2"));
    const std::string module_of_fine = *three_map_module(fine, "fine", "fine.ktx2");
    for (const std::string name : {"fine", "bytes"}) {  // which differ in their textures
        std::string text = module_of_fine;
        write_text(folder / (name + ".js"), text.replace(text.find("fine.ktx2"), 4, name));
    }
    for (const auto& [name, texels, numbers] : {std::tuple("map", &map, LayerNumbers::halves),
                                                {"fine", &fine, LayerNumbers::halves},
                                                {"bytes", &fine, LayerNumbers::bytes},
                                                {"constant", &constant, LayerNumbers::halves}})
        ASSERT_TRUE(write_file((folder / fmt::format("{}.ktx2", name)).string(), map_ktx2(*texels, numbers)));
}

TEST(Three, ShowsAMapAsItsTexels) {
    const fs::path three = shared_data().parent_path() / "peers" / "three";
    if (!fs::exists(three)) GTEST_SKIP() << "no three.js at " << three;
    std::mt19937_64 random(1);
    const RandomModelOptions lobes{.axial = false, .lobes = 5, .variates = 3, .max_bandwidth = 60};
    const TexelMap map = random_map(random, lobes, 8, 4), fine = random_map(random, lobes, 32, 32);
    // Environments show no more of a material alone than all the light; of maps, whose sum is linear, they do.
    const TexelMap constant = dark_constant(random, {.lobes = 5, .variates = 3, .max_bandwidth = 200});
    const Model alone = texel(constant, 0);
    const NamedModel named{"alone", &alone};

    const TemporaryFolder folder;
    for (const char* name : {"three.module.js", "three.core.js"}) fs::copy_file(three / name, folder / name);
    write_text(folder / "alone.js", *three_module(std::span(&named, 1), "alone"));
    ASSERT_NO_FATAL_FAILURE(write_maps(folder, map, fine, constant));
    const std::vector<MapScene> scenes = map_scenes();
    Json all;
    for (const MapScene& scene : scenes) all.push_back(scene.json);
    write_text(folder / "scenes.json", all.dump());
    const ScriptRun run = run_script("extras/environment/test/three_map.py", {folder.path.string()});
    SKIP_IF_UNAVAILABLE(run);
    ASSERT_EQ(run.status, 0) << run.text;
    const Json checks = Json::parse(run.text);
    EXPECT_EQ(checks["problems"], Json::array());
    EXPECT_EQ(checks["said"], Json::array());
    EXPECT_EQ(checks["is_loaded"], true);
    EXPECT_EQ(checks["share_a_program"], false);

    const auto drawn = [&](std::size_t i) { return floats(read_text(folder / fmt::format("{}.rgba", i))); };
    for (std::size_t i = 0; i < k_first_constant; ++i) {
        SCOPED_TRACE(i);
        const std::string module_name = scenes[i].json["module"];
        expect_filtered(drawn(i), scenes[i], FilteredMap(module_name == "map" ? map : fine));
    }
    for (std::size_t i = k_first_constant; i < scenes.size(); i += 2) {
        const auto mapped = drawn(i), single = drawn(i + 1);
        double sum = 0, difference = 0;
        for (std::size_t k = 0; k < single.size(); ++k)
            for (std::size_t c = 0; c < 3; ++c) {
                sum += double(single[k][c]);
                difference += std::abs(double(mapped[k][c]) - double(single[k][c]));
            }
        EXPECT_GT(sum, 0);
        EXPECT_LT(difference, (i == k_first_constant ? 1e-4 : 0.02) * sum)
            << i;  // weights of environments are nearly the same
    }
}

}  // namespace
}  // namespace srbf::three_test
