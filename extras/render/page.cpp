#include "extras/render/page.h"

#include <fmt/format.h>

#include <cassert>
#include <nlohmann/json.hpp>

#include "app/html.h"
#include "base/half.h"
#include "base/printable.h"
#include "errors/sphere.h"
#include "extras/render/environment.h"
#include "extras/render/scene.h"
#include "extras/render/slices.h"
#include "generated/render/page_text.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/su/su_functions.h"

namespace SRBF_NAMESPACE {
namespace {

using Json = nlohmann::ordered_json;

template <typename T> std::string base64_of(const std::vector<T>& numbers) {
    return base64(std::as_bytes(std::span(numbers)));
}

/// A texture in the form that viewer.js expects.
Json texture(const char* sampler, const char* target, const char* format, std::vector<std::uint32_t> size,
             std::string texels) {
    return {{"sampler", sampler},
            {"target", target},
            {"format", format},
            {"size", std::move(size)},
            {"texels", std::move(texels)}};
}

/// The inputs of a material's shader: "block", the numbers of PmNumbers; "vectors", of the uniform "vectors_name";
/// "textures".
template <typename M> Json numbers_json(const M& model) {
    const Uniform uniform = uniform_of(model);
    if (uniform.numbers.empty()) return Json::object();
    return {{"vectors", base64_of(uniform.numbers)}, {"vectors_name", uniform.name}};
}
Json numbers_json(const PmModel& model) { return {{"block", base64_of(pm_numbers(model))}}; }
Json numbers_json(const std::vector<Float4>& merl_texels, std::vector<std::uint32_t> size) {
    std::vector<std::array<std::uint16_t, 4>> halves;
    for (const Float4& texel : merl_texels) {
        auto& half = halves.emplace_back();
        for (std::size_t c = 0; c < 4; ++c) half[c] = to_half(std::min(texel[c], k_half_max));
    }
    return {{"textures", {texture("merl_table", "3D", "RGBA16F", std::move(size), base64_of(halves))}}};
}
Json numbers_json(const MerlTable& table) {
    const auto [h, d, p] = table.size;
    return numbers_json(merl_texels(table), {p, d, h});
}
Json numbers_json(const BsdfTables& tables) {
    const auto [h, d, p] = size_of(tables);
    return numbers_json(merl_texels(tables), {p, d, std::uint32_t(k_parts) * h});
}
Json numbers_json(const SuModel& model) {
    const auto n = std::uint32_t(model.direction.size());
    const SuTexels texels = su_texels(model);
    Json textures{
        texture("su_numbers", "2D", "RGBA16F", {std::uint32_t(2 * model.lobes), n}, base64_of(texels.numbers)),
        texture("su_directions", "2D", "RGBA32F", {1, n}, base64_of(texels.directions))};
    if (model.interpolation == SuInterpolation::plain) {
        const IndexTexture index = model.index ? *model.index : index_texture(model, DirectionMap::cube);
        const auto size = std::uint32_t(index.size);
        textures.push_back(texture("su_index", index.map == DirectionMap::cube ? "CUBE_MAP" : "2D", "RGBA32UI",
                                   {size, size}, base64_of(index.texels)));
    }
    return {{"textures", std::move(textures)}};
}

Json json_of(Vec3d w) { return {w.x, w.y, w.z}; }

Json json_of(const Mesh& mesh) {
    std::vector<std::array<Vec3f, 2>> vertices;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) vertices.push_back({mesh.positions[i], mesh.normals[i]});
    const bool is_small = vertices.size() <= 65536;
    std::vector<std::array<std::uint16_t, 3>> small;
    for (std::size_t i = 0; is_small && i < mesh.triangles.size(); ++i) {
        const Triangle& t = mesh.triangles[i];
        small.push_back({std::uint16_t(t[0]), std::uint16_t(t[1]), std::uint16_t(t[2])});
    }
    const Camera camera = camera_of(mesh, {}, k_page_aspect);
    return {{"vertices", base64_of(vertices)},
            {"triangles", is_small ? base64_of(small) : base64_of(mesh.triangles)},
            {"index_bytes", is_small ? 2 : 4},
            {"target", json_of(camera.target)},
            {"distance", std::sqrt(dot(camera.eye - camera.target, camera.eye - camera.target))}};
}

/// The value of the choice of `Page::mesh`.
constexpr const char* k_own_mesh = "own";

/// The number of azimuths for the proposal by which pictures under an environment sample a material.
int azimuths_of(const Material& material) {
    const auto* pm = std::get_if<PmModel>(&material);
    const auto* bsdf = std::get_if<BsdfModel>(&material);
    const bool isotropic = bsdf ? is_isotropic(Model{*bsdf, {}}) : !pm || pm->axial;
    return isotropic ? 1 : k_anisotropic_azimuths;
}

ShaderText shader_text_of(const Material& material) { return shader_text(material, {.dialect = Dialect::es_300}); }

/// True if a picture shows a BSDF.
bool shows_both_sides(const Page& page) {
    return std::ranges::any_of(
        page.materials, [](const PageMaterial& entry) { return entry.material && is_two_sided(*entry.material); });
}

/// The data of viewer.js, without the materials.
Json common_data(bool two_sided) {
    Json data;
    data["fov"] = Viewpoint{}.fov;
    data["elevation"] = Viewpoint{}.elevation;
    data["aspect"] = k_page_aspect;
    const double grey = srgb_encoded(double(k_background));
    data["background"] = {grey, grey, grey};
    for (const DirectionalLight& light : lights_of(camera_of(page_mesh("ball"), {}, k_page_aspect)))
        data["lights"].push_back({{"towards", json_of(light.towards)},
                                  {"irradiance", {light.irradiance.r, light.irradiance.g, light.irradiance.b}}});
    for (const std::string_view name : {"ball", "sphere", "knot"})
        data["meshes"][std::string(name)] = json_of(page_mesh(name));
    data["light_behind"] = json_of(k_light_behind.towards);
    data["vertex"] = shader_text_of(Flat{}).vertex;
    data["pixel"] = pixel_text({});
    // The shader that displays pictures under an environment.
    const ShaderText develop = develop_shader_text(Dialect::es_300);
    data["whole"] = develop.vertex;
    data["develop"] = develop.fragment;
    data["surface"] = surface_shader_text(Dialect::es_300).fragment;
    data["environment_pixel"] = pixel_text({.environment = true});
    if (two_sided) data["environment_pixel_of_both_sides"] = pixel_text({.environment = true, .two_sided = true});
    data["knee"] = k_knee;
    data["first_samples"] = k_first_samples;
    const Image studio = page_environment();
    data["environment"] = {{"width", studio.width}, {"height", studio.height}, {"rgbe", base64_of(to_rgbe(studio))}};
    return data;
}

Json data_of(const PageMaterial& entry) {
    if (!entry.material) return {};
    Json numbers = std::visit([](const auto& m) { return numbers_json(m); }, *entry.material);
    const bool two_sided = is_two_sided(*entry.material);
    const ProposeOptions options{.azimuths = azimuths_of(*entry.material), .facets = facets_of(*entry.material)};
    const ProposalNumbers proposal =
        proposal_numbers(two_sided ? propose_parts(entry.brdf, options) : Proposals(propose(entry.brdf, options)));
    numbers["two_sided"] = two_sided;
    numbers["nodes"] = base64_of(proposal.nodes);
    numbers["grains"] = base64_of(proposal.grains);
    return numbers;
}

/// The data of viewer.js. The page holds the shaders of the materials.
Json data_of(const Page& page) {
    Json data = common_data(shows_both_sides(page));
    const auto first_picture =
        std::ranges::find_if(page.materials, [](const PageMaterial& entry) { return entry.material.has_value(); });
    data["exposure"] =
        exposure_under_lights((first_picture == page.materials.end() ? page.materials[0] : *first_picture).brdf);
    if (page.mesh) data["meshes"][k_own_mesh] = json_of(*page.mesh);
    for (const PageMaterial& entry : page.materials) data["materials"].push_back(data_of(entry));
    return data;
}

std::string script_text(const Json& json) {
    return json_in_script(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// The first colour is dark; the others are distinguishable with colour blindness (Okabe & Ito 2008).
std::string colour_of(std::size_t i) {
    constexpr std::array<const char*, 6> others{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#b08000"};
    return i == 0 ? "var(--ink)" : others[(i - 1) % others.size()];
}
std::string label_of(const Page& page, std::size_t i) {
    return fmt::format("<span class='mark' style='background:{}'></span>{}", colour_of(i),
                       html_escaped(page.materials[i].name));
}

std::ptrdiff_t count_pictures(const Page& page) {
    return std::ranges::count_if(page.materials, [](const PageMaterial& entry) { return entry.material.has_value(); });
}

std::string figure(std::string_view material, std::string_view name, const std::string& caption) {
    return fmt::format(
        "<figure data-material='{}'><canvas tabindex='0' "
        "aria-label='{}'></canvas><figcaption>{}</figcaption></figure>\n",
        material, html_escaped(name), caption);
}

/// The caption of the difference of the first two materials.
constexpr std::string_view k_difference = "difference × 10";
/// True if the first two materials have pictures, so that the page can show their difference.
bool has_difference(const Page& page) {
    return page.materials.size() > 1 && page.materials[0].material && page.materials[1].material;
}

std::string pictures_of(const Page& page) {
    std::string html;
    for (std::size_t i = 0; i < page.materials.size(); ++i)
        if (page.materials[i].material)
            html +=
                figure(std::to_string(i), page.materials[i].name,
                       fmt::format("{} <small>{}</small>", label_of(page, i), html_escaped(page.materials[i].kind)));
    if (has_difference(page)) html += figure("difference", k_difference, std::string(k_difference));
    return html;
}
std::string choice(std::string_view show, std::string_view name) {
    return fmt::format("<button type='button' data-show='{}' aria-pressed='{}'>{}</button>\n", show, show == "all",
                       html_escaped(name));
}
std::string choices_of(const Page& page) {
    if (count_pictures(page) < 2) return {};
    std::string buttons = choice("all", "Side by side");
    if (has_difference(page)) buttons += choice("wipe", "Wipe");
    for (std::size_t i = 0; i < page.materials.size(); ++i)
        if (page.materials[i].material) buttons += choice(std::to_string(i), page.materials[i].name);
    if (has_difference(page)) buttons += choice("difference", k_difference);
    return fmt::format("<div class='choices' role='group' aria-label='Which pictures are shown'>\n{}</div>\n", buttons);
}
bool plots_both_sides(const Page& page) { return std::ranges::any_of(page.materials, &PageMaterial::both_sides); }
/// Describes the plots.
std::string slices_lead_of(const Page& page) {
    const std::string scale =
        plots_both_sides(page)
            ? "How bright the surface is from each viewing angle, all around: the front above, the back below, for "
              "light on either side. Every ring is ten times the one within. Light that passes "
              "unscattered has no width and is not drawn."
            : "How bright the surface is from each viewing angle, for four positions of the light, on a scale "
              "where every line is ten times the one below it. The peak is the highlight.";
    if (page.materials.size() < 2) return scale;
    return fmt::format("{} Where a thin line leaves the thick black one ({}), that material differs.", scale,
                       html_escaped(page.materials[0].name));
}
std::string slices_of(const Page& page) {
    std::vector<SliceCurve> curves;
    std::string html = "<p class='legend'>";
    for (std::size_t i = 0; i < page.materials.size(); ++i) {
        curves.push_back({page.materials[i].name, colour_of(i), page.materials[i].brdf, page.materials[i].both_sides});
        html += fmt::format("<span>{}</span> ", label_of(page, i));
    }
    html += "</p>\n<div class='slices'>\n";
    const bool both_sides = plots_both_sides(page);
    for (const double theta : k_slice_theta)
        html += both_sides ? lobe_drawing(curves, theta * k_degree, LobeScale::logarithmic)
                           : slice_drawing(curves, theta * k_degree);
    for (const double theta : k_slice_theta_behind)
        if (both_sides) html += lobe_drawing(curves, theta * k_degree, LobeScale::logarithmic);
    return html + "</div>";
}
std::string table_html(const Page& page) {
    std::string html = "<div class='wide'><table><thead><tr><td></td>";
    for (std::size_t i = 0; i < page.materials.size(); ++i)
        html += fmt::format("<th scope='col'>{}</th>", label_of(page, i));
    html += "</tr></thead><tbody>\n";
    std::string meanings;
    for (const Page::Row& row : page.table) {
        assert(row.cells.size() == page.materials.size());
        html += fmt::format("<tr><th scope='row'>{}</th>", html_escaped(row.name));
        for (const std::string& cell : row.cells) html += fmt::format("<td>{}</td>", html_escaped(cell));
        html += "</tr>\n";
        if (!row.meaning.empty())
            meanings += fmt::format("<dt>{}</dt> <dd>{}</dd>\n", html_escaped(row.name), html_escaped(row.meaning));
    }
    html += "</tbody></table></div>\n";
    return meanings.empty() ? html : fmt::format("{}<dl>\n{}</dl>", html, meanings);
}
std::string copyable(std::string_view title, std::string_view id, const std::string& text) {
    return fmt::format(
        "<details><summary>{}</summary><button type='button' class='copy'>Copy</button><pre "
        "id='{}'>{}</pre></details>\n",
        html_escaped(title), id, html_escaped(text));
}
/// The name of a shader's inputs, and their numbers, four per line.
using NamedNumbers = std::pair<std::string, std::string>;
NamedNumbers named(std::string name, std::span<const Float4> numbers) {
    std::string text;
    for (const Float4& four : numbers) text += fmt::format("{:.9g}\n", fmt::join(four, ", "));
    return {std::move(name), std::move(text)};
}
NamedNumbers shader_numbers(const Material& material) {
    if (const auto* pm = std::get_if<PmModel>(&material)) return named("uniform block PmNumbers", pm_numbers(*pm));
    const Uniform uniform = uniform_of(material);
    return named("uniform " + uniform.name, uniform.numbers);
}

std::string texts_of(const Page& page) {
    std::string html;
    for (std::size_t i = 0; i < page.materials.size(); ++i) {
        const PageMaterial& entry = page.materials[i];
        if (!entry.parameters.empty())
            html +=
                copyable(fmt::format("{}: parameters", entry.name), fmt::format("parameters-{}", i), entry.parameters);
        if (entry.material) {
            if (const auto [name, text] = shader_numbers(*entry.material); !text.empty())
                html += copyable(fmt::format("{}: numbers of the shader's {}", entry.name, name),
                                 fmt::format("numbers-{}", i), text);
            html += copyable(fmt::format("{}: fragment shader (GLSL ES 3.00)", entry.name), fmt::format("glsl-{}", i),
                             shader_text_of(*entry.material).fragment);
        }
    }
    return html;
}

}  // namespace

Mesh page_mesh(std::string_view name) {
    if (name == "sphere") return sphere(48);
    if (name == "knot") return knot(200, 32);
    return ball(48);
}

float exposure_under_lights(const Evaluate& brdf) {
    Lighting three{"three", {}, {}, {}, {}};
    for (const DirectionalLight& light : k_three_lights) three.sources.push_back({light.towards, 0, light.irradiance});
    return automatic_exposure(sphere_pictures({&brdf, 1}, {&three, 1}, k_sphere_pixels, 0, {}, 1)[0][0]);
}

std::string viewer_data() { return common_data(true).dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string viewer_material(const PageMaterial& entry) {
    Json data = data_of(entry);
    if (entry.material) {
        data["text"] = shader_text_of(*entry.material).fragment;
        data["exposure"] = exposure_under_lights(entry.brdf);
    }
    return data.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string page_html(const Page& page) {
    assert(!page.materials.empty());
    const auto note = [](const std::string& text) {
        return text.empty() ? text : fmt::format("<p class='note'>{}</p>", html_escaped(text));
    };
    const std::pair<std::string_view, std::string> viewer_parts[] = {
        {"pictures_lead",
         count_pictures(page) > 1
             ? "The same object under the same light, in each of the materials. Drag a picture to turn it; "
               "all of them follow. Choose a light and a shape below the pictures, or drop your own .hdr file."
             : "An object of the material. Drag the picture to turn it. Choose a light and a shape below it, "
               "or drop your own .hdr file."},
        {"pictures", pictures_of(page)},
        {"choices", choices_of(page)},
        {"own_shape", page.mesh
                          ? fmt::format("<option value=\"{}\">{}</option>", k_own_mesh, html_escaped(page.mesh_name))
                          : std::string()},
        {"behind", shows_both_sides(page) ? "<button type='button' name='behind'>Light from behind</button>\n" : ""},
        {"picture_note", note(page.picture_note)},
    };
    const std::string title = html_escaped(page.title);
    const std::pair<std::string_view, std::string> body_parts[] = {
        {"title", title},
        {"viewer", filled(k_pictures_text, viewer_parts)},
        {"slices_lead", slices_lead_of(page)},
        {"slices", slices_of(page)},
        {"table", table_html(page)},
        {"table_note", note(page.table_note)},
        {"texts", texts_of(page)},
    };
    const std::pair<std::string_view, std::string> parts[] = {
        {"title", title},
        {"style", k_style_text},
        {"body", filled(k_page_text, body_parts)},
        {"generator", html_escaped(page.generator)},
        {"scripts",
         fmt::format("<script id=\"data\" type=\"application/json\">{}</script>\n<script>\n{}{}{}{}</script>\n",
                     script_text(data_of(page)), k_light_text, k_painter_text, k_viewer_text, k_exported_text)},
    };
    return filled(k_frame_text, parts);
}

}  // namespace
