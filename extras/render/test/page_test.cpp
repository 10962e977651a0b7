// The page holds what it promises, and a browser draws with it what the desktop's OpenGL draws.
#include "extras/render/page.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <unordered_set>

#include "app/html.h"
#include "base/printable.h"
#include "brdf/parts.h"
#include "brdf_functions.h"
#include "extras/render/chart.h"
#include "extras/render/scene.h"
#include "extras/render/slices.h"
#include "extras/render/test/psnr.h"
#include "models.h"
#include "models/ggx/ggx_kind.h"
#include "models/pm/search/fit_pm.h"
#include "models/su/su_functions.h"
#include "script.h"
#include "srbf/convert.h"
#include "su_models.h"
#include "temporary_folder.h"
#ifdef SRBF_RASTER
#include "brdf/values.h"
#include "extras/render/environment.h"
#include "extras/render/offscreen.h"
#include "extras/render/path.h"
#include "extras/render/raster.h"
#endif

namespace srbf::page_test {
namespace {

using Json = nlohmann::json;

/// A mesh with more corners than 16 bits can number.
Mesh own_mesh() { return knot(1100, 60); }

/// A page with a measurement and a model of each kind.
Page all_kinds() {
    static const Measured film = *load_measured(bundled_data() / "cc_ibiza_sunset_rgb.bsdf");
    static const MerlTable table = to_merl(evaluator(film), k_page_table);
    std::mt19937_64 random(1);
    static const PmModel lobes =
        rounded(fit_pm(*observe(signed_evaluator(film), {}), {.lobes = 4, .variates = 3, .starts = 2})->model);
    const PmModel general = random_model(random, {.axial = false, .lobes = 4, .max_bandwidth = 60});
    SuModel sampled_views = isotropic_su(256), plain = sampled_views, parabolic = sampled_views;
    plain.interpolation = parabolic.interpolation = SuInterpolation::plain;
    parabolic.index = index_texture(parabolic, DirectionMap::parabolic, 64);
    plain.index = index_texture(plain, DirectionMap::cube, 32);
    static const GgxModel ggx{{0.1f, 0.2f, 0.4f}, {{0.1f, {0.1f, 0.05f, 0.02f}, 0.9f}, {0.5f, {0, 0.03f, 0.2f}, 0.4f}}};
    static const Model bsdf{ggx_bsdf(), {}};
    Page page;
    page.title = "<every> kind";
    page.generator = "test";
    for (const Material& material :
         std::initializer_list<Material>{table, lobes, general, sampled_views, plain, parabolic, ggx, ggx_bsdf()}) {
        const auto i = page.materials.size();
        page.materials.push_back({fmt::format("m{} & <b>", i), "as long a kind as some materials have, 658,952 bytes",
                                  material, is_two_sided(material) ? evaluator(bsdf) : evaluator(ggx), false,
                                  i > 0 ? "numbers" : ""});
    }
    page.table.push_back({"bytes", "how many", std::vector<std::string>(page.materials.size(), "1")});
    page.mesh = own_mesh();
    page.mesh_name = "<own>";
    return page;
}

TEST(Page, HoldsItsShadersAndLoadsNothing) {
    const Page page = all_kinds();
    const std::string html = page_html(page);
    for (const PageMaterial& shown : page.materials)
        EXPECT_CONTAINS(
            html, ">" + html_escaped(shader_text(*shown.material, {.dialect = Dialect::es_300}).fragment) + "</pre>");
    for (const char* outside : {"http:", "https:", "src=", "href=", "url(", "import ", "fetch(", "XMLHttp"})
        EXPECT_LACKS(html, outside);
    EXPECT_LACKS(html, "<every>");
    EXPECT_LACKS(html, "{{");
    EXPECT_EQ(count_of(html, "<canvas"), page.materials.size() + 1);  // and the difference of the first two
    EXPECT_EQ(count_of(html, "<svg class="), k_slice_theta.size());
    EXPECT_EQ(count_of(html, "<script"), 2u);
    EXPECT_EQ(count_of(html, "</script>"), 2u);
    // Without a picture the plots and the table remain.
    Page blind = page;
    for (PageMaterial& shown : blind.materials) shown.material.reset();
    const std::string plots = page_html(blind);
    EXPECT_EQ(count_of(plots, "<figure"), 0u);
    EXPECT_EQ(count_of(plots, "<svg class="), k_slice_theta.size());
    EXPECT_LT(plots.size(), html.size());
    // A page with one material has no buttons to choose, and no difference picture.
    Page one = page;
    one.materials.resize(1);
    one.table[0].cells.resize(1);
    const std::string single = page_html(one);
    EXPECT_EQ(count_of(single, "<canvas"), 1u);
    EXPECT_EQ(count_of(single, "<button type='button' data-show"), 0u);
    EXPECT_EQ(count_of(single, "material differs"), 0u);
    // The user's own mesh is selected first.
    EXPECT_EQ(count_of(html, "<select name=\"mesh\"><option value=\"own\">&lt;own&gt;</option>"), 1u);
    Page built_in = one;
    built_in.mesh.reset();
    EXPECT_EQ(count_of(page_html(built_in), "<select name=\"mesh\"><option value=\"ball\">"), 1u);
    // Only a material that transmits light has the light behind.
    EXPECT_EQ(count_of(html, "name='behind'"), 1u);
    EXPECT_EQ(count_of(single, "name='behind'"), 0u);
}

/// The points of the drawing's curves.
std::vector<std::vector<std::array<double, 2>>> curves_of(const std::string& svg) {
    std::vector<std::vector<std::array<double, 2>>> curves;
    const std::regex curve("class='curve'[^>]* d='([^']*)'"), point("[ML]([-0-9.]+) ([-0-9.]+)");
    for (std::sregex_iterator at(svg.begin(), svg.end(), curve), end; at != end; ++at) {
        const std::string path = (*at)[1];
        auto& points = curves.emplace_back();
        for (std::sregex_iterator p(path.begin(), path.end(), point); p != end; ++p)
            points.push_back({std::stod((*p)[1]), std::stod((*p)[2])});
    }
    return curves;
}

TEST(Slices, AreLogarithmicAndPeakAtTheMirrorDirection) {
    const Evaluate shiny =
        pairwise([](Vec3f wl, Vec3f wv) { return grey(std::exp(1000 * (dot(mirror(wl), wv) - 1))); });
    const Evaluate half_known = pairwise([](Vec3f, Vec3f wv) { return grey(wv.x > 0 ? 1 : NAN); });
    const SliceCurve plotted[] = {{"a", "red", constant_brdf(grey(10))},
                                  {"b", "red", constant_brdf(grey(0.1))},
                                  {"c", "red", shiny},
                                  {"d", "red", half_known}};
    const auto curves = curves_of(slice_drawing(plotted, 60 * k_degree));
    ASSERT_EQ(curves.size(), 4u);
    const double ten = curves[0][0][1], tenth = curves[1][0][1];
    for (const auto& [x, y] : curves[0]) EXPECT_EQ(y, ten);
    for (const auto& [x, y] : curves[1]) EXPECT_EQ(y, tenth);
    const auto peak = std::ranges::min(curves[2], {}, [](const auto& point) { return point[1]; });
    EXPECT_WITHIN(peak[1], (ten + tenth) / 2, 0.11);  // 1 lies halfway
    // x is linear from −90° to 90°; the curves end at ±89°.
    const double left = curves[0].front()[0], right = curves[0].back()[0];
    EXPECT_WITHIN(peak[0], left + (60 + 89) / 178.0 * (right - left), 0.01 * (right - left));
    // On the far side of the normal nothing was measured.
    EXPECT_LT(std::ranges::max(curves[3], {}, [](const auto& point) { return point[0]; })[0], (left + right) / 2);
    EXPECT_GT(curves[3].size(), 150u);
}

// Two scans over eight decades, one sample out of the plane: points where the model's curve is.
TEST(Slices, ScansShowSamplesOverTheAngleFromTheMirror) {
    const auto peak = [](double from_mirror) { return 1e4 * std::pow(10.0, -std::abs(from_mirror) / 10); };
    const Evaluate model = pairwise(
        [&](Vec3f wl, Vec3f wv) { return grey(peak((std::atan2(-wv.x, wv.z) - std::atan2(wl.x, wl.z)) / k_degree)); });
    ScatteredSamples samples;
    const auto add = [&](double theta_l, double theta_v, double phi) {
        samples.wl.push_back(to_float(spherical(theta_l * k_degree, 1.0)));
        samples.wv.push_back(to_float(spherical(theta_v * k_degree, 1 + phi)));
        samples.colour.push_back(grey(peak(theta_v - theta_l)));
    };
    for (const double theta_l : {60.0, 30.0})
        for (double theta_v = -80; theta_v <= 80; theta_v += 4) add(theta_l, theta_v, k_pi);
    add(30, 40, 1.0);
    EXPECT_FALSE(is_in_plane(samples.wl.back(), samples.wv.back()));
    const std::vector<Scan> scans = scans_in_plane(samples);
    ASSERT_EQ(scans.size(), 2u);
    EXPECT_WITHIN(scans[0].theta_l, 30, 1e-4);
    EXPECT_WITHIN(scans[1].theta_l, 60, 1e-4);
    const SliceCurve models[] = {{"fit", "red", model}};
    for (const Scan& scan : scans) {
        ASSERT_EQ(scan.degrees.size(), 41u);
        const std::string svg = scan_drawing(scan, models);
        const auto curve = curves_of(svg)[0];
        const std::regex circle("cx='([-0-9.]+)' cy='([-0-9.]+)'");
        std::size_t points = 0;
        for (std::sregex_iterator at(svg.begin(), svg.end(), circle), none; at != none; ++at, ++points) {
            const double x = std::stod((*at)[1]), y = std::stod((*at)[2]);
            const auto nearest =
                std::ranges::min(curve, {}, [&](const auto& p) { return std::hypot(p[0] - x, p[1] - y); });
            EXPECT_LT(std::hypot(nearest[0] - x, nearest[1] - y), 1) << scan.theta_l << " " << x;
        }
        EXPECT_EQ(points, 41u);
    }
}

TEST(Slices, LobesReachAsFarAsTheyAreBright) {
    const SliceCurve plotted[] = {{"a", "red", constant_brdf(grey(10))},
                                  {"b", "red", constant_brdf(grey(5))},
                                  {"c", "red", constant_brdf(grey(0.1))},
                                  {"d", "red", constant_brdf(grey(99))}};
    const double x0 = 180, y0 = 190;
    const auto radii = [&](LobeScale scale) {
        std::vector<double> all;
        for (const auto& curve : curves_of(lobe_drawing(plotted, 0.5, scale))) {
            const double r = std::hypot(curve[0][0] - x0, curve[0][1] - y0);
            for (const auto& [x, y] : curve) EXPECT_WITHIN(std::hypot(x - x0, y - y0), r, 0.15);  // half-circles
            EXPECT_TRUE(r < 1 ||
                        (curve.front()[0] < x0 && curve.back()[0] > x0));  // from the light's side to the mirror's
            all.push_back(r);
        }
        return all;
    };
    const auto linear = radii(LobeScale::linear), logarithmic = radii(LobeScale::logarithmic);
    ASSERT_EQ(linear.size(), 4u);
    EXPECT_WITHIN(linear[1], linear[0] / 2, 0.2);
    EXPECT_WITHIN(linear[2], linear[0] / 100, 0.2);
    EXPECT_GT(linear[3], linear[0]);  // beyond the scale, but not far
    EXPECT_LT(linear[3], 1.1 * linear[0]);
    // The first curve sets the scale, a decade at least.
    EXPECT_WITHIN(logarithmic[0], linear[0], 0.2);
    EXPECT_WITHIN(logarithmic[1], (1 - std::log10(2)) * linear[0], 0.2);
    EXPECT_WITHIN(logarithmic[2], 0, 0.2);
}

TEST(Slices, BothSidesAreDrawnAroundTheCircle) {
    // 10 is reflected at the front, 5 at the back, 0.1 transmitted to the back and 1 to the front.
    const Evaluate f = pairwise([](Vec3f wl, Vec3f wv) {
        constexpr double part_values[] = {10, 5, 0.1, 1};
        return grey(part_values[std::size_t(to_part_frame(wl, wv)->part)]);
    });
    const SliceCurve plotted[] = {{"a", "red", f, true}};
    const double x0 = 180, y0 = 186, radius = 140;
    const auto radii = [&](double theta, LobeScale scale) {  // above and below
        std::array<double, 2> all{};
        std::array<int, 2> points{};
        for (const auto& curve : curves_of(lobe_drawing(plotted, theta, scale)))
            for (const auto& [x, y] : curve) {
                if (std::abs(y - y0) < 0.1) continue;  // rounded onto the surface
                const std::size_t side = y > y0;
                const double r = std::hypot(x - x0, y - y0);
                if (points[side]++ == 0) all[side] = r;
                EXPECT_WITHIN(r, all[side], 0.2);
            }
        EXPECT_GT(points[0], 4);
        return all;
    };
    const auto front = radii(0.5, LobeScale::linear), back = radii(k_pi - 0.5, LobeScale::linear);
    EXPECT_WITHIN(front[0], radius, 0.2);
    EXPECT_WITHIN(front[1], 0.01 * radius, 0.2);
    EXPECT_WITHIN(back[1], radius, 0.2);
    EXPECT_WITHIN(back[0], 0.2 * radius, 0.2);
    // Two decades apart, and one more from the smallest to the centre.
    EXPECT_WITHIN(radii(0.5, LobeScale::logarithmic)[1], radius / 3, 0.5);
    const LuminanceSlice slice = luminance_slice(f, 0.5, true);
    EXPECT_TRUE(std::ranges::is_sorted(slice.degrees));
    EXPECT_EQ(slice.degrees.front(), -89);
    EXPECT_EQ(slice.degrees.back(), 269);
    EXPECT_EQ(luminance_slice(f, 0.5).degrees.back(), 89);

    Page page;
    page.title = page.generator = "both";
    page.materials.push_back({"shade", "kind", {}, f, true, ""});
    page.table.push_back({"bytes", "", {"1"}});
    const std::string html = page_html(page);
    EXPECT_EQ(count_of(html, "<svg class='slice lobes'"), k_slice_theta.size() + k_slice_theta_behind.size());
    EXPECT_EQ(count_of(html, "all around"), 1u);
}

TEST(Charts, AreLogarithmicInBothDirections) {
    const Chart chart{"<a> title",
                      "J",
                      {1, 4, 16},
                      {{"a", "red", "", {{16, 0.001, "x & y"}, {1, 0.1, ""}, {4, 0.01, ""}}},
                       {"b", "red", "", {{4, 0.02, ""}, {2, 0, ""}, {2, NAN, ""}}}}};
    const std::string svg = chart_drawing(chart);
    EXPECT_LACKS(svg, "<a>");
    EXPECT_CONTAINS(svg, "x &amp; y");
    const auto curves = curves_of(svg);
    ASSERT_EQ(curves.size(), 1u);  // in the order of x; a single point has no curve
    ASSERT_EQ(curves[0].size(), 3u);
    for (const int axis : {0, 1})
        EXPECT_WITHIN(curves[0][1][std::size_t(axis)],
                      (curves[0][0][std::size_t(axis)] + curves[0][2][std::size_t(axis)]) / 2, 0.11);
    EXPECT_LT(curves[0][0][0], curves[0][2][0]);
    EXPECT_LT(curves[0][0][1], curves[0][2][1]);  // y goes downwards
    EXPECT_EQ(count_of(svg, "<circle"), 4u);      // of the second, what can be shown
    for (const char* label : {">0.1 %<", ">1 %<", ">10 %<", ">16<"}) EXPECT_CONTAINS(svg, label);
}

TEST(Html, Base64IsTheStandardsAndFieldsAreFilledOnce) {
    const auto encoded = [](std::string_view text) { return base64(std::as_bytes(std::span(text))); };
    EXPECT_EQ(encoded(""), "");  // RFC 4648
    EXPECT_EQ(encoded("f"), "Zg==");
    EXPECT_EQ(encoded("fo"), "Zm8=");
    EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
    const std::pair<std::string_view, std::string> parts[] = {{"a", "{{b}}"}, {"b", "2"}};
    EXPECT_EQ(filled("x {{a}} {{b}}", parts), "x {{b}} 2");
}

#ifdef SRBF_RASTER
/// PSNR [dB] over the pixels where either picture is not background.
double psnr(const std::string& rgba, const Image8& other) {
    EXPECT_EQ(rgba.size(), 4 * other.pixels.size());
    const Rgb8 background = other.pixels[0];
    Psnr psnr;
    for (std::size_t i = 0; i < other.pixels.size(); ++i) {
        const Rgb8 pixel = pixel_of(rgba, i);
        if (pixel != background || other.pixels[i] != background) psnr.add(pixel, other.pixels[i]);
    }
    EXPECT_GT(psnr.count, 0.1 * 3 * double(other.pixels.size()));
    return psnr.decibels();
}

/// The scene that the page says it drew.
Scene scene_in(const Json& picture) {
    const Json& scene = picture.at("scene");
    const auto vector = [](const Json& numbers, std::size_t first) {
        return Vec3d{numbers[first], numbers[first + 1], numbers[first + 2]};
    };
    const std::string name = scene["mesh"];
    Scene drawn{name == "own" ? own_mesh() : page_mesh(name),
                {vector(scene["eye"], 0), vector(scene["target"], 0), {0, 1, 0}, scene["fov"]},
                {}};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f irradiance = to_float(vector(scene["irradiances"], 3 * k));
        drawn.lights.push_back({vector(scene["directions"], 3 * k), {irradiance.x, irradiance.y, irradiance.z}});
    }
    return drawn;
}

/// The picture of that scene under the environment, by paths.
Image8 traced_picture(const Json& picture, const Material& material) {
    const Scene scene = scene_in(picture);
    const Vec3d from = scene.camera.eye - scene.camera.target;
    const Image studio = halved(load_environment("studio")->texels());
    Image turned = studio;  // the path tracer turns the environment with the camera, the page by itself
    const double angle = double(picture["scene"]["turned"]) - std::atan2(from.x, from.z),
                 shift = studio.width * (angle / (2 * k_pi) + 2), whole = std::floor(shift);
    for (int y = 0; y < studio.height; ++y)
        for (int x = 0; x < studio.width; ++x)
            turned.at(x, y) = mixed(studio.at((x + int(whole)) % studio.width, y),
                                    studio.at((x + int(whole) + 1) % studio.width, y), float(shift - whole));
    const Environment environment(turned);
    const PreparedBsdf prepared = std::visit(
        [](const auto& content) {
            using M = std::remove_cvref_t<decltype(content)>;
            if constexpr (std::is_same_v<M, MerlTable>) {
                Measured measured;
                measured.table = content;
                return prepare_bsdf(measured, {});
            } else if constexpr (std::is_constructible_v<AnyModel, M>)
                return prepare_bsdf(Model{content, {}}, {});
            else
                return ADD_FAILURE(), prepare_bsdf(Model(), {});
        },
        material);
    const PathScene paths{{{&scene.mesh, 0}}, {prepared}, scene.camera, scene.lights, {}, &environment};
    PathOptions options;
    options.width = picture.at("width");
    options.height = picture.at("height");
    options.samples = 256;
    options.occlusion = false;
    return shown(render_paths(paths, options).rendering, picture["scene"]["exposure"]);
}

/// The picture of that scene by the desktop's rasterizer.
Image8 desktop_picture(const Json& picture, const RasterMaterial& material) {
    const int width = picture.at("width"), height = picture.at("height");
    const auto target = checked(RasterTarget::make(width, height, 4, RasterTarget::Format::bytes));
    const Scene scene = scene_in(picture);
    target->begin();
    material.draw(RasterMesh(scene.mesh),
                  {scene.camera, double(width) / height, scene.lights, float(picture["scene"]["exposure"])});
    return target->read_bytes();
}

/// The mean column of the brightest pixels.
double middle_of_highlights(const std::string& rgba, int width) {
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < rgba.size() / 4; ++i) {
        const double bright = std::pow(double(std::uint8_t(rgba[4 * i + 1])) / 255, 8);
        sum += bright * double(i % std::size_t(width));
        weight += bright;
    }
    return sum / weight;
}

void expect_loaded(const Json& with) {
    EXPECT_EQ(with["problems"], Json::array());
    for (const std::string request : with["requests"])  // a blob is the page's own worker
        EXPECT_TRUE(request.starts_with("file:") || request.starts_with("blob:") || request == "about:blank")
            << request;
    EXPECT_LE(int(with["phone"][0]), int(with["phone"][1]));
    for (const auto& [state, labels] : with["labels"].items()) {
        EXPECT_EQ(labels["wrong"], Json::array()) << state;
        EXPECT_GT(int(labels["seen"]), 100) << state;
    }
    // While a file is read, pictures are under the other environment; afterwards nothing is said.
    EXPECT_EQ(with["read"], Json({"Reading flat.hdr …", "studio", "file", ""}));
}

/// The pictures of the browser by their steps.
struct StepPictures {
    std::map<std::string, Json> first;  // of each step the first picture
    std::map<std::string, std::string> pixels;
    std::map<std::string, int> count;
};
/// Compares each picture with the desktop's.
StepPictures compared_pictures(const Page& page, const Json& pictures, const TemporaryFolder& folder, Dialect dialect) {
    std::vector<RasterMaterial> materials;
    for (const PageMaterial& shown : page.materials)
        materials.push_back(*checked(RasterMaterial::make(*shown.material, {.dialect = dialect})));
    StepPictures steps;
    for (const Json& picture : pictures) {
        const std::string step = picture["step"], rgba = read_text(folder / std::string(picture["file"]));
        const std::size_t material = picture["material"];
        const bool lit_around = step.starts_with("studio");
        const double alike = psnr(rgba, lit_around ? traced_picture(picture, *page.materials[material].material)
                                                   : desktop_picture(picture, materials[material]));
        EXPECT_GE(alike, lit_around ? 30 : 40) << step << ", material " << material;
        if (steps.first.emplace(step, picture).second) steps.pixels[step] = rgba;
        std::unordered_set<std::uint32_t> colours;  // there is something to see
        for (std::size_t i = 0; i < rgba.size(); i += 4)
            colours.insert(std::uint32_t(std::uint8_t(rgba[i])) << 16 | std::uint32_t(std::uint8_t(rgba[i + 1])) << 8 |
                           std::uint8_t(rgba[i + 2]));
        EXPECT_GT(colours.size(), 500u) << step << ", material " << material;
        EXPECT_GE(int(picture["scene"]["samples"]), lit_around ? 12 : 0);
        ++steps.count[step];
    }
    return steps;
}

/// Expects that each step changes what it should, and keeps the rest.
void expect_changes(StepPictures& steps) {
    auto& [states, pixels, count] = steps;
    EXPECT_EQ(states["one"]["material"], 1);
    EXPECT_EQ(states["other"]["material"], 0);
    EXPECT_EQ(states["lit"]["scene"], states["other"]["scene"]);
    EXPECT_TRUE(pixels["lit"] != pixels["other"]);
    EXPECT_NE(states["one"]["scene"]["eye"], states["turned"]["scene"]["eye"]);
    EXPECT_EQ(states["one"]["scene"]["directions"], states["turned"]["scene"]["directions"]);
    EXPECT_EQ(states["turned"]["scene"]["eye"], states["lit"]["scene"]["eye"]);
    EXPECT_TRUE(pixels["turned"] != pixels["lit"]);
    EXPECT_GT(middle_of_highlights(pixels["lit"], states["lit"]["width"]),
              middle_of_highlights(pixels["turned"], states["lit"]["width"]) + 5);
    EXPECT_EQ(states["opened"]["scene"]["mesh"], "own");
    EXPECT_EQ(states["knot"]["scene"]["mesh"], "knot");
    EXPECT_EQ(states["knot"]["scene"]["irradiances"], Json({3, 3, 3, 0, 0, 0, 0, 0, 0}));
    EXPECT_TRUE(pixels["again"] == pixels["opened"]);
    EXPECT_EQ(count["phone"], 2);  // one over the other
    EXPECT_NE(states["phone one"]["scene"]["eye"], states["swiped"]["scene"]["eye"]);
}

/// The light behind the object is beyond the plane through its middle, and is seen through it.
void expect_light_behind(const Json& behind) {
    double facing = 0;
    for (std::size_t k = 0; k < 3; ++k)
        facing += double(behind["directions"][k]) * (double(behind["eye"][k]) - double(behind["target"][k]));
    EXPECT_LT(facing, 0);
    EXPECT_EQ(behind["irradiances"], Json({3, 3, 3, 0, 0, 0, 0, 0, 0}));
}

void expect_environment(StepPictures& steps, const Json& refused) {
    EXPECT_EQ(steps.count["studio"], 3);
    EXPECT_EQ(steps.first["studio"]["scene"]["irradiances"], Json(std::vector<int>(9, 0)));
    EXPECT_EQ(steps.first["studio turned"]["scene"]["eye"], steps.first["studio"]["scene"]["eye"]);
    EXPECT_GT(double(steps.first["studio turned"]["scene"]["turned"]), 0.1);
    EXPECT_EQ(steps.first["studio and lights"]["scene"]["irradiances"][0], 3);
    for (const char* file : {"text.hdr", "cut.hdr", "cut.exr", "huge.hdr"})
        EXPECT_TRUE(std::string(refused[file]).starts_with(file)) << refused[file];
    EXPECT_CONTAINS(std::string(refused["huge.hdr"]), "4096 MB") << refused["huge.hdr"];
    EXPECT_CONTAINS(std::string(refused["lost"]), "graphics") << refused["lost"];
    EXPECT_EQ(refused["restored"], "");
}

TEST(Page, ABrowserDrawsThePictureOfTheDesktop) {
    auto context = OffscreenContext::make();
    if (!context) GTEST_SKIP() << message(context.error());
    const Page page = all_kinds();
    const TemporaryFolder folder;
    write_text(folder / "page.html", page_html(page));
    // It writes result.json and pictures to the folder.
    const ScriptRun run =
        run_script("extras/render/test/page.py", {(folder / "page.html").string(), folder.path.string()});
    SKIP_IF_UNAVAILABLE(run);
    ASSERT_EQ(run.status, 0) << run.text;
    const Json result = Json::parse(read_text(folder / "result.json"));
    const Json &with = result["with"], &without = result["without"];
    expect_loaded(with);
    StepPictures steps = compared_pictures(page, with["pictures"], folder, context->dialect());
    EXPECT_EQ(steps.count["opened"], int(page.materials.size()));
    for (const char* step : {"one", "turned", "lit", "other", "knot", "behind"})
        EXPECT_EQ(steps.count[step], 1) << step;
    expect_changes(steps);
    expect_light_behind(steps.first["behind"]["scene"]);
    expect_environment(steps, with["refused"]);

    // This browser cannot draw.
    EXPECT_EQ(without["said"], 1);
    EXPECT_EQ(without["viewer"], 0);
    EXPECT_EQ(without["rows"], int(page.table.size()));
    EXPECT_EQ(without["slices"], int(k_slice_theta.size()));
    EXPECT_EQ(without["problems"], Json::array());
}
#endif

}  // namespace
}  // namespace srbf::page_test
