#include "srbf/shading_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <ranges>
#include <set>

#include "base/parameters.h"
#include "base/printable.h"
#include "code/added_code.h"
#include "code/blend_code.h"
#include "code/bsdf_code.h"
#include "code/defined_names.h"
#include "code/extra_code.h"
#include "code/lanes_code.h"
#include "code/offered_code.h"
#include "code/print.h"
#include "code/print_python.h"
#include "code/syntax.h"
#include "code/texts.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/library_file.h"
#include "models/openpbr/openpbr_functions.h"
#include "models/su/su_functions.h"
#include "sampling/elevation_nodes.h"
#include "sampling/mixture.h"
#include "srbf/prepared.h"

namespace srbf {
namespace {

using syntax::Program;
using syntax::Table;

/// Handles and accessors that kernel.glsl requires of a host, for a model that does not have these numbers.
constexpr const char* k_handles = R"(
struct Su { };
struct SuNearest { };
int su_nearest(SuNearest nearest, int k) { return 0; }
)";
constexpr const char* k_no_su = R"(
int su_lobes(Su su) { return 0; }
int su_views(Su su) { return 1; }
Vec3 su_direction(Su su, int view) { return Vec3(0.0, 0.0, 1.0); }
Vec3 su_centre(Su su, int view, int j) { return Vec3(0.0, 0.0, 1.0); }
Real su_bandwidth(Su su, int view, int j) { return 0.0; }
Vec3 su_coefficient(Su su, int view, int j) { return Vec3(0.0, 0.0, 0.0); }
Real su_shape(Su su, int view, int j) { return 0.0; }
)";

/// The storage of a model's numbers in a program. Numbers of lobes are in a table.
enum class ParameterStorage {
    constants,  ///< other numbers are in the text
    tables,     ///< other numbers are in a table
    arguments,  ///< the coefficients of lobes are members of a handle, which is an argument of all functions
};

/// Exponents of models are to the base e, those of kernel.glsl to the base 2.
constexpr const char* k_log2_e = "1.4426950408889634";
constexpr const char* k_half_log2_e = "0.7213475204444817";

/// The positions of numbers in a lobe's row, and the size of the row.
struct LobeRow {
    std::size_t scale, variates, variate_size, exponents, size;
    LobeRow(const PmModel& model, ParameterStorage storage)
        : scale(storage == ParameterStorage::arguments ? 0 : 3),
          variates(scale + 1),
          variate_size(model.axial ? 1 : 4),
          exponents(variates + variate_size * std::size_t(model.variates)),
          size(exponents + std::size_t(features(model.form))) {}
};
bool any_down(const PmModel& model) {
    return model.axial && std::ranges::any_of(model.centre, [](const Vec3f& centre) { return centre.z < 0; });
}
Table lobes_of(const PmModel& model, ParameterStorage storage) {
    const auto N = std::size_t(model.variates), F = std::size_t(features(model.form));
    const char* const variates = !model.axial      ? "the centre and bandwidth of each variate"
                                 : any_down(model) ? "a bandwidth for each variate, negative where its centre is -z"
                                                   : "a bandwidth for each variate";
    Table lobes{fmt::format("A row for each lobe: its {}log scale, {}{}.",
                            storage == ParameterStorage::arguments ? "" : "coefficient (R, G, B) and ", variates,
                            F > 0 ? ", exponents" : ""),
                "lobes",
                {},
                LobeRow(model, storage).size};
    for (std::size_t j = 0; j < std::size_t(model.lobes); ++j) {
        for (int c = 0; c < 3 && storage != ParameterStorage::arguments; ++c)
            lobes.add(model.coefficient[j][c], "coefficient", 3 * j + std::size_t(c));
        lobes.add(model.log_scale[j], "log_scale", j);
        for (std::size_t n = j * N; n < (j + 1) * N; ++n) {
            const Vec3f& xi = model.centre[n];
            if (!model.axial) {
                lobes.add(xi.x, "centre", 3 * n), lobes.add(xi.y, "centre", 3 * n + 1);
                lobes.add(xi.z, "centre", 3 * n + 2);
            }
            if (model.axial && xi.z < 0)
                lobes.add(-model.bandwidth[n], "-bandwidth", n);
            else
                lobes.add(model.bandwidth[n], "bandwidth", n);
        }
        for (std::size_t k = j * F; k < (j + 1) * F; ++k) lobes.add(model.exponent[k], "exponent", k);
    }
    return lobes;
}

std::string numbers_of(const PmModel& model, ParameterStorage storage, Program& program) {
    const LobeRow row(model, storage);
    Table weights{"The weights a, b of each variate.", "variates", {}, 2};
    for (const auto& [a, b] : model.parameterization)
        for (const float weight : {a, b}) weights.add(weight, "parameterization", weights.numbers.size());
    program.tables = {std::move(weights), lobes_of(model, storage)};

    const auto number = [&](std::size_t offset, const char* index = "") {
        return fmt::format("lobes[{} * j + {}{}]", row.size, offset, index);
    };
    std::string text = fmt::format(
        "int pm_lobes(Pm pm) {{ return {}; }}\n"
        "int pm_variates(Pm pm) {{ return {}; }}\n"
        "int pm_features(Pm pm) {{ return {}; }}\n"
        "bool pm_axial(Pm pm) {{ return {}; }}\n"
        "bool pm_reciprocal(Pm pm) {{ return {}; }}\n"
        "Real pm_weight_l(Pm pm, int n) {{ return variates[2 * n]; }}\n"
        "Real pm_weight_v(Pm pm, int n) {{ return variates[2 * n + 1]; }}\n"
        "Vec3 pm_coefficient(Pm pm, int j) {{ return {}; }}\n"
        "Real pm_log2_scale(Pm pm, int j) {{ return {} * {}; }}\n"
        "Real pm_exponent(Pm pm, int j, int k) {{ return {} * {}; }}\n",
        model.lobes, model.variates, features(model.form), model.axial, is_reciprocal(model.form),
        storage == ParameterStorage::arguments ? "pm.lobe[j]"
                                               : fmt::format("Vec3({}, {}, {})", number(0), number(1), number(2)),
        k_log2_e, number(row.scale), k_log2_e, number(row.exponents, " + k"));
    if (model.axial) {
        const std::string bandwidth = number(row.variates, " + n");
        text += fmt::format(
            "Real pm_log2_falloff(Pm pm, int j, int n) {{ return {} * {}; }}\n"
            "bool pm_down(Pm pm, int j, int n) {{ return {}; }}\n"
            "Vec3 pm_centre(Pm pm, int j, int n) {{ return Vec3(0.0, 0.0, 1.0); }}\n",
            k_half_log2_e, any_down(model) ? "abs(" + bandwidth + ")" : bandwidth,
            any_down(model) ? bandwidth + " < 0.0" : "false");
    } else {
        text += fmt::format(
            "Real pm_log2_falloff(Pm pm, int j, int n) {{ return {} * {}; }}\n"
            "bool pm_down(Pm pm, int j, int n) {{ return false; }}\n"
            "Vec3 pm_centre(Pm pm, int j, int n) {{ return Vec3({}, {}, {}); }}\n",
            k_half_log2_e, number(row.variates + 3, " + 4 * n"), number(row.variates, " + 4 * n"),
            number(row.variates + 1, " + 4 * n"), number(row.variates + 2, " + 4 * n"));
    }
    return text;
}

const std::string k_no_pm =
    "int pm_lobes(Pm pm) { return 0; }\n"
    "int pm_variates(Pm pm) { return 0; }\n"
    "int pm_features(Pm pm) { return 0; }\n"
    "bool pm_axial(Pm pm) { return true; }\n"
    "bool pm_reciprocal(Pm pm) { return false; }\n"
    "bool pm_down(Pm pm, int j, int n) { return false; }\n"
    "Real pm_weight_l(Pm pm, int n) { return 0.0; }\n"
    "Real pm_weight_v(Pm pm, int n) { return 0.0; }\n"
    "Real pm_log2_scale(Pm pm, int j) { return 0.0; }\n"
    "Real pm_log2_falloff(Pm pm, int j, int n) { return 0.0; }\n"
    "Real pm_exponent(Pm pm, int j, int k) { return 0.0; }\n"
    "Vec3 pm_coefficient(Pm pm, int j) { return Vec3(0.0, 0.0, 0.0); }\n"
    "Vec3 pm_centre(Pm pm, int j, int n) { return Vec3(0.0, 0.0, 1.0); }\n";

/// The accessors of a view-by-view model, whose numbers (`shading_data`) the host supplies.
constexpr std::size_t k_view_numbers = 3, k_view_lobe_numbers = 8;
std::string numbers_of(const SuModel& model, Program& program) {
    const std::size_t J = std::size_t(model.lobes), row = k_view_numbers + k_view_lobe_numbers * J;
    program.tables.push_back(
        {fmt::format(
             "number i of the data, float32 in little-endian order; a function or macro of the host. {} rows of {}: "
             "the direction of a view (x, y, z), and for each of its lobes, {}, coefficient (R, G, B), bandwidth, "
             "centre (x, y, z), shape (tau or -alpha, 0 without).",
             model.direction.size(), row, J),
         "number",
         {}});
    const auto number = [&](std::size_t offset) {
        return fmt::format("number[{} * view + {} * j + {}]", row, k_view_lobe_numbers, k_view_numbers + offset);
    };
    return fmt::format(
        "int su_lobes(Su su) {{ return {0}; }}\n"
        "int su_views(Su su) {{ return {1}; }}\n"
        "Vec3 su_direction(Su su, int view) {{ return Vec3(number[{2} * view], number[{2} * view + 1], number[{2} * "
        "view + "
        "2]); }}\n"
        "Vec3 su_coefficient(Su su, int view, int j) {{ return Vec3({3}, {4}, {5}); }}\n"
        "Real su_bandwidth(Su su, int view, int j) {{ return {6}; }}\n"
        "Vec3 su_centre(Su su, int view, int j) {{ return Vec3({7}, {8}, {9}); }}\n"
        "Real su_shape(Su su, int view, int j) {{ return {10}; }}\n",
        J, model.direction.size(), row, number(0), number(1), number(2), number(3), number(4), number(5), number(6),
        model.shape.empty() ? "0.0" : number(7));
}

std::string real(float x) { return fmt::format("Real({})", syntax::digits(x)); }
std::string vector(const Rgb& rgb) { return fmt::format("Vec3({}, {}, {})", real(rgb.r), real(rgb.g), real(rgb.b)); }

/// The function `brdf`. `statements` compute the value above the horizon.
std::string brdf_function(const std::string& statements) {
    return "// The BRDF f_r [1/sr] in linear sRGB, without the cosine: multiply by wl.z and by the irradiance of the "
           "light on a\n"
           "// surface that faces it. wl points to the light and wv to the viewer: unit vectors in the local frame, "
           "whose z is the\n"
           "// shading normal. 0 where one of them is not above the horizon, or has a NaN.\n"
           "Vec3 brdf(Su su, Vec3 wl, Vec3 wv, Pm pm) {\n"
           "    if (!(Real(0.0) < wl.z && Real(0.0) < wv.z && dot(wl, wl) + dot(wv, wv) < Real(1.0e30)))\n"
           "        return Vec3(Real(0.0), Real(0.0), Real(0.0));\n" +
           statements + "}\n";
}
constexpr const char* k_value_pdf_text = R"(
// The BRDF and the density of samples, as multiple importance sampling needs them together.
struct ValuePdf {
    Vec3 value;
    Real pdf;
};
ValuePdf value_pdf(Su su, Vec3 wl, Vec3 wv, Pm pm) {
    ValuePdf both;
    both.value = brdf(su, wl, wv, pm);
    both.pdf = light_pdf(wl, wv);
    return both;
}
)";
std::string brdf_of(const Model& model, ParameterStorage storage, Program& program) {
    if (storage != ParameterStorage::tables)
        return brdf_function(formula_text(model, [](float x, auto, auto) { return real(x); }));
    Table numbers{"The numbers of the model.", "model_numbers", {}};
    const std::string statements = formula_text(model, [&](float x, std::string_view parameter, std::size_t index) {
        numbers.add(x, parameter, index);
        return fmt::format("{}[{}]", numbers.name, numbers.numbers.size() - 1);
    });
    if (!numbers.numbers.empty()) program.tables.push_back(std::move(numbers));
    return brdf_function(statements);
}

/// A model of lobe j alone, with coefficient 1.
Model lobe_alone(PmModel basis, std::size_t j) {
    basis.coefficient.assign(std::size_t(basis.lobes), Rgb{}), basis.coefficient[j] = {1, 1, 1};
    return {std::move(basis), {}};
}

/// Directional albedos at the nodes. They are those of the model, whose values are the same on every processor,
/// not of the faster functions for renderers.
std::vector<Rgb> node_albedos(const Model& model) {
    const PreparedBrdf brdf = prepare<Model>(model, CosineProposal{});
    std::vector<Rgb> reflected;
    for (int i = 0; i < k_albedo_nodes; ++i) reflected.push_back(albedo_of_node(brdf, albedo_cosine(i)));
    return reflected;
}
/// The function that albedo.glsl requires. If coefficients are arguments, it sums over lobes. Unless `is_used`, its
/// table is empty.
std::string albedo_node_text(const Model& model, ParameterStorage storage, bool is_used, Program& program) {
    Table nodes{"Directional albedo (R, G, B), a row for each node.", "albedo_nodes", {}, 3};
    if (storage != ParameterStorage::arguments) {
        for (const Rgb& albedo : is_used ? node_albedos(model) : std::vector<Rgb>())
            nodes.numbers.insert(nodes.numbers.end(), {albedo.r, albedo.g, albedo.b});
        program.tables.push_back(std::move(nodes));
        return "Vec3 albedo_node(Pm pm, int i) { return Vec3(albedo_nodes[3 * i], albedo_nodes[3 * i + 1], "
               "albedo_nodes[3 * i + 2]); }\n";
    }
    const auto& lobes = std::get<PmModel>(model.model);
    const auto J = std::size_t(lobes.lobes);
    nodes.comment = "Directional albedo of each lobe with coefficient 1, a row for each node.", nodes.columns = J;
    nodes.numbers.resize(is_used ? k_albedo_nodes * J : 0);
    for (std::size_t j = 0; j < J && is_used; ++j) {
        const std::vector<Rgb> albedo = node_albedos(lobe_alone(lobes, j));
        for (std::size_t i = 0; i < albedo.size(); ++i) nodes.numbers[i * J + j] = albedo[i].g;
    }
    program.tables.push_back(std::move(nodes));
    return fmt::format(
        "Vec3 albedo_node(Pm pm, int i) {{\n"
        "    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));\n"
        "    for (int j = 0; j < {0}; ++j) sum = sum + albedo_nodes[{0} * i + j] * pm.lobe[j];\n"
        "    return sum;\n}}\n",
        J);
}

/// The mixture that samples of a model follow; without sampling, one that nothing reads.
MixtureProposal mixture_of(const Model& model, const CodeOptions& options) {
    if (!options.sampling) return {};
    const int azimuths = is_isotropic(model) ? 1 : k_anisotropic_azimuths;
    return std::get<MixtureProposal>(propose(model, {azimuths, options.threads}));
}

/// The functions and the macro that mixture.glsl requires.
std::string mixture_numbers_text(const MixtureProposal& mixture, const CodeOptions& options, Program& program,
                                 std::map<std::string, std::string>& defines) {
    const bool has_facets = mixture.facets.has_value();
    Table nodes{fmt::format("The proposal, a row for each node: weights of lobes, stretch and power of two shapes{}.",
                            has_facets ? ", the weights and matrices of facets" : ""),
                "mixture_numbers",
                {},
                has_facets ? k_node_numbers : k_lobe_numbers};
    for (std::size_t node = 0; options.sampling && node < MixtureProposal::k_nodes; ++node) {
        const auto numbers = numbers_of(mixture, node);
        nodes.numbers.insert(nodes.numbers.end(), numbers.begin(), numbers.begin() + std::ptrdiff_t(nodes.columns));
    }
    defines["MIXTURE_COMPONENTS"] =
        std::to_string(has_facets ? MixtureProposal::k_components : MixtureProposal::k_lobes);
    const std::size_t columns = nodes.columns;
    program.tables.push_back(std::move(nodes));
    return fmt::format(
        "Real mixture_number(int node, int i) {{ return mixture_numbers[{} * node + i]; }}\n"
        "Vec3 mixture_tangent(Vec3 wv) {{ return {}; }}\n",
        columns, mixture.has_axis() ? vector({mixture.cosine, mixture.sine, 0}) : "wv");
}

/// The entry functions: their names in the kernel's language, and in the code.
using Names = std::map<std::string, std::string>;
Names entries(const CodeOptions& options, const AddedCode& added) {
    Names names = added.entries;
    names.insert({"brdf", "brdf"});
    if (options.sampling) names.insert({{"sample_light", "sample"}, {"light_pdf", "pdf"}, {"value_pdf", "value_pdf"}});
    if (options.albedo) names.insert({"directional_albedo", "albedo"});
    return names;
}

/// The entries of a map, and functions that look up its textures if the language allows it.
Names map_entries(const CodeOptions& options, const AddedCode& added) {
    Names names = entries(options, added);
    if (syntax::reads_buffers(options.language)) names.insert({{"layer", "layer"}, {"coefficients", "coefficients"}});
    return names;
}
std::string coefficients_of(const PmModel& basis) {
    return fmt::format(
        "// The coefficients of a material: R, G, B of each lobe.\n"
        "struct Pm {{ Vec3 lobe[{}]; }};\n",
        basis.lobes);
}
std::string look_up_text(const PmModel& basis) {
    return fmt::format(
        "// The coefficient of lobe j at (u, v), which the host looks up in its textures: R, G, B of layer j.\n"
        "Vec3 layer(int j, Real u, Real v);\n"
        "// The coefficients there.\n"
        "Pm coefficients(Real u, Real v) {{\n"
        "    Pm pm;\n"
        "    for (int j = 0; j < {}; ++j) pm.lobe[j] = layer(j, u, v);\n"
        "    return pm;\n}}\n",
        basis.lobes);
}

struct ModelText {
    std::string accessors = k_no_pm + k_no_su, brdf;
    int variates = 1, terms = 1;
    std::string handle = "struct Pm { };\n";
};
ModelText text_of(const Model& model, ParameterStorage storage, Program& program) {
    ModelText text{.brdf = brdf_of(model, storage, program)};
    if (const auto* pm = std::get_if<PmModel>(&model.model)) {
        text.accessors = numbers_of(*pm, storage, program) + k_no_su;
        text.variates = pm->variates, text.terms = std::max(features(pm->form), 1);
        if (storage == ParameterStorage::arguments) text.handle = coefficients_of(*pm), text.brdf += look_up_text(*pm);
    } else if (const auto* su = std::get_if<SuModel>(&model.model)) {
        text.accessors = k_no_pm + numbers_of(*su, program);
    }
    return text;
}

/// Replaces the body of a function by its definition in the printed language.
void set_native(Program& program, std::string_view name, std::string native) {
    syntax::Function& function = *std::ranges::find(program.functions, name, &syntax::Function::name);
    function.body.clear(), function.native = std::move(native);
}

Program program_of(const Model& model, const CodeOptions& options, const std::vector<std::string>& roots,
                   const AddedCode& added = {}, ParameterStorage storage = ParameterStorage::constants) {
    Program program;
    const ModelText model_text = text_of(model, storage, program);
    std::map<std::string, std::string> defines{{"SRBF_MAX_VARIATES", std::to_string(model_text.variates)},
                                               {"SRBF_TERMS", std::to_string(model_text.terms)},
                                               {"MIXTURE_NODES", std::to_string(MixtureProposal::k_nodes)},
                                               {"ALBEDO_NODES", std::to_string(k_albedo_nodes)}};
    const bool has_albedo = options.albedo || added.albedo, is_mixture = options.sampling || has_albedo;
    const MixtureProposal proposal = mixture_of(model, options);
    const std::string mixture = is_mixture ? mixture_numbers_text(proposal, options, program, defines) : std::string(),
                      nodes = added.albedo_node.empty() ? albedo_node_text(model, storage, has_albedo, program)
                                                        : added.albedo_node,
                      more =
                          added.text ? added.text(model, storage == ParameterStorage::arguments, program, defines) : "";
    syntax::parse(model_text.handle + model_text.accessors + k_handles, program, defines, true);
    syntax::parse(k_kernel_text, program, defines);
    syntax::parse(model_text.brdf, program, defines);
    if (is_mixture)
        syntax::parse(mixture + k_mixture_text + k_value_pdf_text + nodes + k_albedo_text + more, program, defines);
    if (options.language == CodeLanguage::c && storage == ParameterStorage::constants) {
        if (const auto* pm = std::get_if<PmModel>(&model.model)) set_native(program, "pm_value", value_in_c(*pm));
        if (options.sampling) {
            set_native(program, "sample_light", mixture_in_c(proposal) + k_sample_in_c);
            set_native(program, "light_pdf", k_pdf_in_c);
        }
    }
    syntax::specialise(program, roots);
    if (added.unrolled) syntax::unroll(program, roots);
    return program;
}

/// Returns the definitions that native ones of models require.
std::string lanes_text(std::span<const NamedModel> models, const CodeOptions& options) {
    const auto is_pm = [](const NamedModel& named) { return std::holds_alternative<PmModel>(named.model->model); };
    if (options.language != CodeLanguage::c || !(options.sampling || std::ranges::any_of(models, is_pm))) return "";
    std::set<std::string> known;
    const std::string lobes = lobes_in_c(known);
    return options.sampling ? lobes + mixtures_in_c(known) : lobes;
}

/// The functions that a text in C defines.
std::set<std::string> functions_in_c(const std::string& text) {
    const std::string_view head = "\nSRBF_FN ";
    std::set<std::string> names;
    for (std::size_t at = text.find(head); at != text.npos; at = text.find(head, at + 1)) {
        const std::size_t end = text.find('(', at), begin = text.rfind(' ', end) + 1;
        names.insert(text.substr(begin, end - begin));
    }
    return names;
}

std::string kind_text(const Model& model) {
    if (const auto* pm = std::get_if<PmModel>(&model.model))
        return fmt::format("{} lobes of {} variates, form {}", pm->lobes, pm->variates, name(pm->form));
    if (const auto* su = std::get_if<SuModel>(&model.model)) return fmt::format("view by view, {} lobes", su->lobes);
    if (std::holds_alternative<OpenPbrModel>(model.model)) return "a surface by parameters of OpenPBR";
    return std::string(kind_words(model));
}

/// Describes a model: its name, kind, size and provenance.
std::string describe_model(const NamedModel& named) {
    const Model& model = *named.model;
    std::string text = named.name + ": " + kind_text(model);
    text += fmt::format(", {} bytes.", payload_bytes(model));
    for (const auto& [key, value] : model.provenance) text += fmt::format("\n  {}", printable(key + " " + value));
    return text;
}

/// The program of a model, with its name and description.
struct NamedProgram {
    std::string name, description;
    Program program;
};

/// Prints several programs, and definitions that they share once.
class ProgramPrinter {
  public:
    ProgramPrinter(std::vector<NamedProgram> programs, std::string_view prefix, CodeLanguage language, Names entries)
        : programs_(std::move(programs)),
          prefix_(std::string(prefix) + "_"),
          language_(language),
          entries_(std::move(entries)) {
        for (const auto& [name, printed_name] : entries_) own_.insert(name);
        for (const auto& named : programs_)
            for (const Table& table : named.program.tables) own_.insert(table.name);
        while (separate()) {
        }
    }

    /// Adds the names of all definitions that are not shared.
    Result<Done> add_names(DefinedNames& defined) const {
        for (std::size_t i = 0; i < programs_.size(); ++i) {
            const Names printed_names = names(i);
            Result<Done> added = Done{};
            for_each_definition(i, [&](const auto& definition) {
                if (added && own_.contains(definition.name))
                    added = defined.add(printed_names.at(definition.name), programs_[i].name);
            });
            if (!added) return added;
        }
        return Done{};
    }

    std::string text() {
        std::string shared, own_texts;
        std::set<std::string> known;
        for (std::size_t i = 0; i < programs_.size(); ++i) {
            syntax::Printer printer(language_, names(i));
            std::string own;
            for_each_definition(i, [&](const auto& definition) {
                if (own_.contains(definition.name))
                    own += printer.text(definition) + "\n";
                else if (known.insert(definition.name).second)
                    shared += printer.text(definition) + "\n";
            });
            own_texts += syntax::comment_text(programs_[i].description) + "\n" + own;
        }
        return shared + own_texts;
    }

  private:
    template <typename Visit> void for_each_definition(std::size_t i, const Visit& visit) const {
        const Program& program = programs_[i].program;
        for (const auto& structure : program.structures) visit(structure);
        for (const auto& table : program.tables) visit(table);
        for (const auto& function : program.functions) visit(function);
    }

    Names names(std::size_t i) const {
        Names names;
        const std::string own = programs_[i].name + "_";
        for_each_definition(i, [&](const auto& definition) {
            names[definition.name] = (own_.contains(definition.name) ? own : prefix_) + definition.name;
        });
        for (const auto& [name, printed_name] : entries_) names[name] = own + printed_name;
        return names;
    }

    /// Marks definitions as a model's own if they differ between models, or use a model's own definitions. Returns true
    /// if it marked any.
    bool separate() {
        Names texts;
        const std::size_t before = own_.size();
        for (const NamedProgram& named : programs_)
            for (const syntax::Function& function : named.program.functions) {
                for (const syntax::Variable& parameter : function.parameters)
                    if (own_.contains(parameter.type.name)) own_.insert(function.name);
                syntax::visit_expressions(function.body, [&](const syntax::Expression& part) {
                    if (own_.contains(part.text)) own_.insert(function.name);
                });
            }
        for (std::size_t i = 0; i < programs_.size(); ++i) {
            syntax::Printer printer(language_, names(i));
            for_each_definition(i, [&](const auto& definition) {
                if (own_.contains(definition.name)) return;
                const std::string text = printer.text(definition);
                if (texts.emplace(definition.name, text).first->second != text) own_.insert(definition.name);
            });
        }
        return own_.size() != before;
    }

    std::vector<NamedProgram> programs_;
    std::string prefix_;
    CodeLanguage language_;
    Names entries_;
    std::set<std::string> own_;  ///< definitions that are not shared
};

}  // namespace

std::vector<float> shading_data(const SuModel& model) {
    std::vector<float> data;
    const auto J = std::size_t(model.lobes);
    for (std::size_t i = 0; i < model.direction.size(); ++i) {
        const Vec3f w = model.direction[i];
        data.insert(data.end(), {w.x, w.y, w.z});
        for (std::size_t j = i * J; j < (i + 1) * J; ++j) {
            const Rgb& beta = model.coefficient[j];
            const Vec3f xi = model.centre[j];
            data.insert(data.end(), {beta.r, beta.g, beta.b, model.bandwidth[j], xi.x, xi.y, xi.z,
                                     model.shape.empty() ? 0 : model.shape[j]});
        }
    }
    return data;
}

std::string identifier(std::string_view text) {
    std::string name;
    for (const char c : text) {
        const bool is_letter = std::isalnum(static_cast<unsigned char>(c)) && static_cast<unsigned char>(c) < 128;
        if (is_letter)
            name += c;
        else if (!name.empty() && name.back() != '_')
            name += '_';
    }
    while (!name.empty() && name.back() == '_') name.pop_back();
    std::string letters;
    for (const char c : name)
        if (c != '_') letters += char(std::tolower(static_cast<unsigned char>(c)));
    const bool is_reserved = name.starts_with("gl_") || name.starts_with("webgl_") || letters == "measured" ||
                             letters == "meshstandard";  // names of classes in three.js and its module
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) || is_reserved)
        name.insert(0, name.empty() ? "brdf" : "brdf_");
    return name;
}

Rgb albedo_of_node(const PreparedBrdf& brdf, double cosine) { return albedo(brdf, std::max(float(cosine), 1e-30f)); }

std::optional<CodeLanguage> code_language_named(std::string_view name) {
    const auto row = std::ranges::find(k_code_languages, name, &CodeLanguageRow::name);
    return row == std::end(k_code_languages) ? std::nullopt : std::optional(row->language);
}

std::string code_language_names() {
    return fmt::format("{}", fmt::join(std::views::transform(k_code_languages, &CodeLanguageRow::name), ", "));
}

Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix,
                                 const CodeOptions& requested, const AddedCode& added) {
    CodeOptions options = requested;
    std::vector<NamedModel> brdfs;  // includes the parts of BSDFs
    std::vector<PartModels> parts;
    std::string list, bsdf_text;
    DefinedNames defined;
    const auto is_bsdf = [](const NamedModel& named) { return std::holds_alternative<BsdfModel>(named.model->model); };
    if (added.sampling) options.sampling = true;
    // Samples choose among the parts of a BSDF by their albedos.
    if (options.sampling && std::ranges::any_of(models, is_bsdf)) options.albedo = true;
    const Names names = entries(options, added);
    const auto add_name = [&](const std::string& name) { list += (list.empty() ? "" : ", ") + name; };
    for (const NamedModel& named : models) {
        if (is_bsdf(named)) {
            const PartModels& own = parts.emplace_back(part_models(named, options.sampling));
            brdfs.insert(brdfs.end(), own.named.begin(), own.named.end());
            for (const std::string& name : bsdf_functions(named, options.sampling)) add_name(name);
            const auto code = bsdf_code(named, options, defined);
            if (!code) return code.error();
            bsdf_text += syntax::comment_text(describe_model(named)) + "\n" + *code;
        } else {
            brdfs.push_back(named);
            for (const auto& [name, printed_name] : names) add_name(fmt::format("{}_{}", named.name, printed_name));
        }
    }
    std::vector<NamedProgram> programs;
    std::vector<std::string> roots;
    for (const auto& [name, printed_name] : names) roots.push_back(name);
    for (const NamedModel& named : brdfs) {
        if (const auto* su = std::get_if<SuModel>(&named.model->model)) {
            const auto refuse = [&](const char* what, const char* expected, const char* found) {
                return Error{named.name, {}, what, expected, found, ErrorCode::argument};
            };
            if (su->interpolation == SuInterpolation::plain)
                return refuse("model", "interpolation of rotated views", "plain interpolation");
            if (options.sampling) return refuse("sampling code", "a model that is not view by view", "one that is");
            if (!syntax::reads_buffers(options.language))
                return refuse("view-by-view model", "a language with global buffers", "one without");
        }
        programs.push_back({named.name, describe_model(named), program_of(*named.model, options, roots, added)});
    }
    ProgramPrinter printer(std::move(programs), prefix, options.language, names);
    if (const auto distinct = printer.add_names(defined); !distinct) return distinct.error();
    const std::string lanes = lanes_text(brdfs, options);
    for (const std::string& name : functions_in_c(lanes))
        if (const auto distinct = defined.add(name, "the functions of srbf"); !distinct) return distinct.error();
    std::string definitions = lanes + printer.text() + bsdf_text;
    if (options.blend) {
        const auto blend = blend_code(models, prefix, options, defined);
        if (!blend) return blend.error();
        definitions += *blend;
        for (const std::string& name : blend_functions(prefix, options)) add_name(name);
    }
    return syntax::whole_text(options.language, list, std::string(prefix) + "_BRDF", definitions);
}

PmModel with_mean_coefficients(const Library& map) {
    PmModel model = map.basis;
    const std::size_t J = model.coefficient.size();
    std::vector<double> sum(3 * J);
    for (std::size_t i = 0; i < map.coefficient.size(); ++i)
        for (int c = 0; c < 3; ++c) sum[3 * (i % J) + std::size_t(c)] += double(map.coefficient[i][c]);
    for (std::size_t i = 0; i < sum.size(); ++i)
        model.coefficient[i / 3][int(i % 3)] = float(sum[i] / double(std::max<std::size_t>(map.count(), 1)));
    return model;
}

Result<std::string> map_code(const Library& map, std::string_view name, const CodeOptions& options,
                             const AddedCode& added) {
    const auto refuse = [&](const char* what, const char* expected, const char* found) {
        return Error{std::string(name), {}, what, expected, found, ErrorCode::argument};
    };
    if (options.blend) return refuse("code of a map", "values, albedos and light", "a blend");
    if (!map.dense()) return refuse("library", "a coefficient for each lobe", "some lobes of each material");
    if (options.sampling || added.sampling) return refuse("code of a map", "values, albedos and light", "sampling");
    Names names = map_entries(options, added);
    std::vector<std::string> roots;
    std::string list;
    for (const auto& [root, printed_name] : names) {
        roots.push_back(root);
        list += fmt::format("{}{}_{}", list.empty() ? "" : ", ", name, printed_name);
    }
    const Model basis{with_mean_coefficients(map), {}};
    std::string description =
        fmt::format("{}: {} lobes of {} variates, form {}, {} bytes, which all materials share.", name, map.basis.lobes,
                    map.basis.variates, srbf::name(map.basis.form), basis_bytes(map));
    if (map.width > 0) description += fmt::format("\n  map {} x {}", map.width, map.count() / map.width);
    for (const auto& [key, value] : map.provenance) description += fmt::format("\n  {}", printable(key + " " + value));
    NamedProgram program{std::string(name), description,
                         program_of(basis, options, roots, added, ParameterStorage::arguments)};
    names.insert({"Pm", "Coefficients"});
    return syntax::whole_text(options.language, list, std::string(name) + "_BRDF",
                              ProgramPrinter({std::move(program)}, name, options.language, names).text());
}

namespace {

/// The functions of all extras that the options name. Errors: no extra has one of them.
Result<AddedCode> added_code(const CodeOptions& options) {
    AddedCode all;
    for (const auto extra : k_extra_code) {
        AddedCode own = extra().functions(options);
        if (own.entries.empty()) continue;
        all.entries.merge(own.entries);
        all.sampling = all.sampling || own.sampling, all.albedo = all.albedo || own.albedo;
        all.text = [first = std::move(all.text), next = std::move(own.text)](const auto& model, bool is_basis,
                                                                             auto& program, auto& defines) {
            const std::string before = first ? first(model, is_basis, program, defines) : "";
            return before + next(model, is_basis, program, defines);
        };
    }
    for (const std::string& name : options.with)
        if (std::ranges::find(code_features(), name, &CodeFeature::name) == code_features().end())
            return Error{"code", {}, "functions", "those of this program", name, ErrorCode::argument};
    return all;
}
template <typename Row> std::vector<Row> rows_of_extras(std::vector<Row> CodeExtra::*member) {
    std::vector<Row> rows;
    for (const auto extra : k_extra_code) {
        const std::vector<Row> added = extra().*member;
        rows.insert(rows.end(), added.begin(), added.end());
    }
    return rows;
}

}  // namespace

std::span<const CodeFeature> code_features() {
    static const std::vector<CodeFeature> all = rows_of_extras(&CodeExtra::features);
    return all;
}
std::span<const CodeModule> code_modules() {
    static const std::vector<CodeModule> all = rows_of_extras(&CodeExtra::modules);
    return all;
}

Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix,
                                 const CodeOptions& options) {
    const auto added = added_code(options);
    return added ? shading_code(models, prefix, options, *added) : added.error();
}
Result<std::string> map_code(const Library& map, std::string_view name, const CodeOptions& options) {
    const auto added = added_code(options);
    return added ? map_code(map, name, options, *added) : added.error();
}

Result<std::string> python_code(const Model& model, int threads) {
    if (std::holds_alternative<SuModel>(model.model) || std::holds_alternative<BsdfModel>(model.model))
        return Error{"python code", {}, "model", "multivariate, or Lambert and GGX", "another", ErrorCode::argument};
    const Program program =
        program_of(model, {.sampling = true, .threads = threads},
                   {"brdf", "chosen_lobe", "sample_of_lobe", "light_pdf"}, {}, ParameterStorage::tables);
    std::string text =
        fmt::format("components = {}\n", facets_of(model) ? MixtureProposal::k_components : MixtureProposal::k_lobes);
    for (const Table& table : program.tables) text += syntax::python_text(table);
    for (const syntax::Function& function : program.functions) text += "\n\n" + syntax::python_text(function, program);
    return text;
}

}  // namespace srbf
