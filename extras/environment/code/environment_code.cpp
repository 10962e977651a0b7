// Lobes of extended light in the code of models.
#include "srbf/environment_code.h"

#include <fmt/format.h>

#include <algorithm>

#include "code/added_code.h"
#include "code/print.h"
#include "extras/environment/code/unroll.h"
#include "generated/code/extra_code.h"
#include "generated/extras/environment/texts.h"
#include "sampling/elevation_nodes.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {
namespace {

using syntax::Program;
using syntax::Table;

struct LightOptions {
    EnvironmentCode code;
    int threads;
    bool has_lobes() const { return code.environment || code.area; }
};

/// A table with one row of `columns` numbers for each node of light_lobes, linear between nodes.
std::string light_number(std::size_t columns) {
    return fmt::format(
        "Real light_number(int i, NodesAbout nodes) {{\n"
        "    int at = {0} * nodes.below + i;\n"
        "    return light_lobes[at] + nodes.beyond * (light_lobes[at + {0}] - light_lobes[at]);\n}}\n",
        columns);
}
std::string light_width(std::size_t column) {
    return fmt::format("Real light_width(NodesAbout nodes) {{ return light_number({}, nodes); }}\n", column);
}
/// Weights sum to at most 1, but for materials of a basis to the albedo, because the sum is linear in their
/// coefficients.
constexpr std::string_view k_light_whole =
    "Vec3 light_whole(Vec3 albedo) {\n"
    "    return Vec3(min(albedo.x, Real(1.0)), min(albedo.y, Real(1.0)), min(albedo.z, Real(1.0)));\n}\n";
constexpr std::string_view k_light_whole_of_basis = "Vec3 light_whole(Vec3 albedo) { return albedo; }\n";
constexpr std::string_view k_reflected =
    "Vec3 reflected(Vec3 weight, Vec3 light) {\n"
    "    return Vec3(weight.x * light.x, weight.y * light.y, weight.z * light.z);\n}\n";
constexpr std::string_view k_reflected_by_host =
    "// The product of a lobe's weight, in colours that the host may change, and the radiance. The host supplies it.\n"
    "Vec3 reflected(Vec3 weight, Vec3 light);\n";
/// The text for lobes that the host supplies.
constexpr std::string_view k_light_of_host =
    "Vec3 light_between(int i, NodesAbout nodes) {\n"
    "    Vec3 here = light_texel(i, nodes.below);\n"
    "    return here + nodes.beyond * (light_texel(i, nodes.below + 1) - here);\n}\n"
    "Real light_width(NodesAbout nodes) { return light_between(0, nodes).z; }\n"
    "Vec3 light_shape(int k, NodesAbout nodes) { return light_between(2 * k - 2, nodes); }\n"
    "Vec3 light_weight(int k, Vec3 whole, NodesAbout nodes, Pm pm) {\n"
    "    Vec3 share = light_between(2 * k - 1, nodes);\n"
    "    return Vec3(share.x * whole.x, share.y * whole.y, share.z * whole.z);\n}\n";
constexpr std::string_view k_varying = "Real light_roughness(int k, Real of_view) { return of_view; }\n";
constexpr std::string_view k_fixed_of_host =
    "// The roughness of lobe k > 0. The host supplies it.\nReal lobe_roughness(int k);\n"
    "Real light_roughness(int k, Real of_view) { return lobe_roughness(k); }\n";
/// The function for roughnesses that all views share, if the lobes have such.
std::string light_roughness(std::vector<float> shared, const LightOptions& options, Program& program) {
    if (!options.code.fixed) return std::string(k_varying);
    program.tables.push_back({"The roughness of each lobe after the first.", "light_roughnesses", std::move(shared)});
    return "Real light_roughness(int k, Real of_view) { return light_roughnesses[k - 1]; }\n";
}
/// The text that extended.glsl requires, to be parsed before it.
std::string light_of(const Model& model, const LightOptions& options, Program& program) {
    if (options.code.texels)
        return std::string(k_light_whole)
            .append(options.code.fixed ? k_fixed_of_host : k_varying)
            .append(k_light_of_host);
    const auto others = std::size_t(options.code.lobes - 1);
    Table light{
        "A row for each node: p, roughness and share of the albedo (R, G, B) of each lobe after the first; width.",
        "light_lobes",
        {},
        5 * others + 1};
    std::vector<float> roughnesses;
    if (options.has_lobes()) {
        const ExtendedLight extended = extended_light(prepare(model), {.lobes = options.code.lobes,
                                                                       .isotropic = is_isotropic(model),
                                                                       .levels = options.code.levels,
                                                                       .fixed = options.code.fixed,
                                                                       .threads = options.threads});
        for (std::size_t node = 0; node < ExtendedLight::k_views; ++node) {
            for (const auto& lobe : std::span(extended.lobe).subspan((others + 1) * node + 1, others))
                light.numbers.insert(light.numbers.end(),
                                     {lobe.axis, lobe.roughness, lobe.weight.r, lobe.weight.g, lobe.weight.b});
            light.numbers.push_back(extended.width[node]);
        }
        for (std::size_t k = 1; k <= others; ++k) roughnesses.push_back(extended.lobe[k].roughness);
    }
    program.tables.push_back(std::move(light));
    return light_number(5 * others + 1) + light_width(5 * others) + std::string(k_light_whole) +
           light_roughness(std::move(roughnesses), options, program) +
           "Vec3 light_shape(int k, NodesAbout nodes) {\n"
           "    return Vec3(light_number(5 * k - 5, nodes), light_number(5 * k - 4, nodes), Real(0.0));\n}\n"
           "Vec3 light_weight(int k, Vec3 whole, NodesAbout nodes, Pm pm) {\n"
           "    return Vec3(whole.x * light_number(5 * k - 3, nodes), whole.y * light_number(5 * k - 2, nodes),\n"
           "                whole.z * light_number(5 * k - 1, nodes));\n}\n";
}
/// The text if the coefficients, whose typical values are those of `basis`, are arguments. The lobes' weights are
/// linear in them.
std::string light_of_basis(const PmModel& basis, const LightOptions& options, Program& program) {
    const auto J = std::size_t(basis.lobes), others = std::size_t(options.code.lobes - 1),
               columns = others * (2 + J) + 1;
    Table light{
        "A row for each node: p, roughness and weights by the coefficients of each lobe after the first; the least "
        "width.",
        "light_lobes",
        {},
        columns};
    std::vector<float> roughnesses;
    if (options.has_lobes()) {
        const SharedLight shared = shared_light(basis, {.lobes = options.code.lobes,
                                                        .isotropic = is_isotropic(basis),
                                                        .levels = options.code.levels,
                                                        .fixed = options.code.fixed,
                                                        .threads = options.threads});
        for (std::size_t i = 0; i < shared.shape.size(); ++i) {
            light.numbers.insert(light.numbers.end(), {shared.shape[i].axis, shared.shape[i].roughness});
            const auto weights = std::span(shared.weight).subspan(i * J, J);
            light.numbers.insert(light.numbers.end(), weights.begin(), weights.end());
            if (i % others == others - 1) light.numbers.push_back(shared.width[i / others]);
            if (i < others) roughnesses.push_back(shared.shape[i].roughness);
        }
    }
    program.tables.push_back(std::move(light));
    return light_number(columns) + light_width(columns - 1) + std::string(k_light_whole_of_basis) +
           light_roughness(std::move(roughnesses), options, program) +
           fmt::format(
               "Vec3 light_shape(int k, NodesAbout nodes) {{\n"
               "    return Vec3(light_number({0} * k - {0}, nodes), light_number({0} * k - {0} + 1, nodes), "
               "Real(0.0));\n}}\n"
               "Vec3 light_weight(int k, Vec3 whole, NodesAbout nodes, Pm pm) {{\n"
               "    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));\n"
               "    for (int j = 0; j < {1}; ++j) sum = sum + light_number({0} * k - {0} + 2 + j, nodes) * "
               "pm.lobe[j];\n"
               "    return sum;\n}}\n",
               2 + J, J);
}

constexpr const char* k_texel_of_host =
    "// Lobe k > 0 at a view has (p, roughness, width) at i = 2 k - 2 and its share of the albedo at i = 2 k - 1;\n"
    "// then albedos, of as many nodes in a column as there are views. The host supplies them.\n"
    "Vec3 light_texel(int i, int view);\n"
    "Vec3 albedo_node(Pm pm, int i) {\n"
    "    return light_texel(2 * EXTENDED_LOBES - 2 + i / EXTENDED_NODES, i % EXTENDED_NODES);\n}\n";

std::map<std::string, std::string> light_entries(const EnvironmentCode& code, CodeLanguage language) {
    std::map<std::string, std::string> names;
    const auto add = [&](const char* name) { names.emplace(name, name); };
    const bool can_read_textures = syntax::reads_buffers(language);  // a function may read the host's textures
    if (code.environment || code.area) add("environment_lobe");
    if (code.views) add("lobes_about");
    if (code.draws) add("environment_draw");
    if (code.texels) add("light_texel");
    if (code.texels && code.fixed) add("lobe_roughness");
    if (code.colours) add("reflected");
    if (code.area) add("area");
    if (code.environment && can_read_textures) {
        add("radiance");
        add("environment");
    }
    if (code.draws && can_read_textures) {
        add("radiance_over");
        add("environment_sampled");
    }
    return names;
}

AddedCode added_of(const EnvironmentCode& code, const CodeOptions& options) {
    const LightOptions light{code, options.threads};
    AddedCode added{light_entries(code, options.language), code.draws, light.has_lobes()};
    if (code.unrolled) added.rewrite = syntax::unroll;
    if (code.texels) added.albedo_node = k_texel_of_host;
    added.text = [light](const Model& model, bool is_basis, Program& program, auto& defines) {
        const auto* basis = is_basis ? &std::get<PmModel>(model.model) : nullptr;
        defines.insert({{"EXTENDED_NODES", std::to_string(ExtendedLight::k_views)},
                        {"EXTENDED_LOBES", std::to_string(light.code.lobes)},
                        {"EXTENDED_LEVELS", std::to_string(ExtendedLight::k_levels)}});
        return (basis ? light_of_basis(*basis, light, program) : light_of(model, light, program)) +
               std::string(light.code.colours ? k_reflected_by_host : k_reflected) + k_extended_text +
               (light.code.draws ? k_sampled_text : "");
    };
    return added;
}

/// The functions that `CodeOptions::with` names.
AddedCode light_functions(const CodeOptions& options) {
    const auto is_named = [&](const char* name) { return std::ranges::count(options.with, name) > 0; };
    const EnvironmentCode code{
        .environment = is_named("environment"), .draws = is_named("environment-draws"), .area = is_named("area")};
    return code.environment || code.draws || code.area ? added_of(code, options) : AddedCode{};
}

Result<std::string> for_unity(std::span<const NamedModel> models, std::string_view, int threads) {
    return unity_shader(models, threads);
}

}  // namespace

Result<std::string> environment_code(std::span<const NamedModel> models, std::string_view prefix,
                                     const CodeOptions& options, const EnvironmentCode& added) {
    return shading_code(models, prefix, options, added_of(added, options));
}
Result<std::string> environment_map_code(const TexelMap& map, std::string_view name, const CodeOptions& options,
                                         const EnvironmentCode& added) {
    return map_code(map, name, options, added_of(added, options));
}

LightTexels light_texels(const ExtendedLight& light) {
    constexpr std::size_t k_views = ExtendedLight::k_views;
    const std::size_t others = std::size_t(light.lobes) - 1,
                      columns = 2 * others + (k_albedo_nodes + k_views - 1) / k_views;
    LightTexels texels{columns, std::vector<float>(3 * columns * k_views)};
    const auto set = [&](std::size_t i, std::size_t view, const Rgb& texel) {
        std::copy_n(&texel.r, 3, &texels.numbers[3 * (i + view * columns)]);
    };
    for (std::size_t view = 0; view < k_views; ++view)
        for (std::size_t k = 0; k < others; ++k) {
            const auto& [axis, roughness, weight] = light.lobe[(others + 1) * view + k + 1];
            set(2 * k, view, {axis, roughness, light.width[view]}), set(2 * k + 1, view, weight);
        }
    for (std::size_t i = 0; i < k_albedo_nodes; ++i)
        set(2 * others + i / k_views, i % k_views, albedo_of_node(light.brdf, albedo_cosine(int(i))));
    return texels;
}

const CodeExtra& code_of_environment() {
    static const CodeExtra extra{
        {{"environment",
          "with NAME_environment, the radiance under an environment that the host has filtered as for GGX"},
         {"environment-draws", "with NAME_environment_sampled, the same by draws, of one that is not filtered"},
         {"area", "with NAME_area, the radiance under a quadrilateral"}},
        {{.name = "three",
          .summary = "a module for three.js with a class NAMEMaterial of each model; of a map, which goes into\n"
                     "NAME.ktx2 beside it, one with coefficients from textures; of a BSDF each part is a material",
          .text = three_module,
          .map_text = three_map_module},
         {.name = "three-webgpu",
          .summary = "such a module of models for the WebGPURenderer of three.js",
          .text = three_webgpu_module},
         {.name = "unity",
          .summary = "a shader for the Universal Render Pipeline of Unity 6, not run in Unity",
          .text = for_unity}},
        light_functions};
    return extra;
}

}  // namespace
