#include "srbf/shading_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <ranges>
#include <set>

#include "base/parameters.h"
#include "base/printable.h"
#include "code/added_code.h"
#include "code/bsdf_code.h"
#include "code/defined_names.h"
#include "code/extra_code.h"
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

/// The accessors that kernel.glsl requires of a host: the handles but Pm, and those that a model does not have.
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

/// Where the numbers of a program are.
enum class ParameterStorage {
    constants,  ///< of lobes in a table, of microfacets in the text
    tables,     ///< of microfacets too
    arguments,  ///< the coefficients of lobes are members of the handle, which the functions take
};

/// The exponents of a model are to the base e, those of kernel.glsl to the base 2.
constexpr const char* k_log2_e = "1.4426950408889634";
constexpr const char* k_half_log2_e = "0.7213475204444817";

/// The lobes of a multivariate model as rows of a table.
struct LobeRow {
    std::size_t scale, variates, of_variate, exponents, size;  ///< where they begin, and how many
    LobeRow(const PmModel& model, ParameterStorage where)
        : scale(where == ParameterStorage::arguments ? 0 : 3),
          variates(scale + 1),
          of_variate(model.axial ? 1 : 4),
          exponents(variates + of_variate * std::size_t(model.variates)),
          size(exponents + std::size_t(features(model.form))) {}
};
bool any_down(const PmModel& model) {
    return model.axial && std::ranges::any_of(model.centre, [](const Vec3f& centre) { return centre.z < 0; });
}
Table lobes_of(const PmModel& model, ParameterStorage where) {
    const auto N = std::size_t(model.variates), F = std::size_t(features(model.form));
    const char* const variates = !model.axial      ? "the centre and bandwidth of each variate"
                                 : any_down(model) ? "a bandwidth for each variate, negative where its centre is -z"
                                                   : "a bandwidth for each variate";
    Table lobes{fmt::format("A row for each lobe: its {}log scale, {}{}.",
                            where == ParameterStorage::arguments ? "" : "coefficient (R, G, B) and ", variates,
                            F > 0 ? ", exponents" : ""),
                "lobes",
                {},
                LobeRow(model, where).size};
    for (std::size_t j = 0; j < std::size_t(model.lobes); ++j) {
        for (int c = 0; c < 3 && where != ParameterStorage::arguments; ++c)
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

/// The tables and accessors of a multivariate model.
std::string numbers_of(const PmModel& model, ParameterStorage where, Program& program) {
    const LobeRow row(model, where);
    Table weights{"The weights a, b of each variate.", "variates", {}, 2};
    for (const auto& [a, b] : model.parameterization)
        for (const float of : {a, b}) weights.add(of, "parameterization", weights.numbers.size());
    program.tables = {std::move(weights), lobes_of(model, where)};

    const auto at = [&](std::size_t offset, const char* further = "") {
        return fmt::format("lobes[{} * j + {}{}]", row.size, offset, further);
    };
    std::string text = fmt::format(
        "int pm_lobes(Pm pm) {{ return {}; }}\n"
        "int pm_variates(Pm pm) {{ return {}; }}\n"
        "int pm_features(Pm pm) {{ return {}; }}\n"
        "bool pm_axial(Pm pm) {{ return {}; }}\n"
        "Real pm_weight_l(Pm pm, int n) {{ return variates[2 * n]; }}\n"
        "Real pm_weight_v(Pm pm, int n) {{ return variates[2 * n + 1]; }}\n"
        "Vec3 pm_coefficient(Pm pm, int j) {{ return {}; }}\n"
        "Real pm_log2_scale(Pm pm, int j) {{ return {} * {}; }}\n"
        "Real pm_exponent(Pm pm, int j, int k) {{ return {} * {}; }}\n",
        model.lobes, model.variates, features(model.form), model.axial,
        where == ParameterStorage::arguments ? "pm.lobe[j]" : fmt::format("Vec3({}, {}, {})", at(0), at(1), at(2)),
        k_log2_e, at(row.scale), k_log2_e, at(row.exponents, " + k"));
    if (model.axial) {
        const std::string bandwidth = at(row.variates, " + n");
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
            k_half_log2_e, at(row.variates + 3, " + 4 * n"), at(row.variates, " + 4 * n"),
            at(row.variates + 1, " + 4 * n"), at(row.variates + 2, " + 4 * n"));
    }
    return text;
}

const std::string k_no_pm =
    "int pm_lobes(Pm pm) { return 0; }\n"
    "int pm_variates(Pm pm) { return 0; }\n"
    "int pm_features(Pm pm) { return 0; }\n"
    "bool pm_axial(Pm pm) { return true; }\n"
    "bool pm_down(Pm pm, int j, int n) { return false; }\n"
    "Real pm_weight_l(Pm pm, int n) { return 0.0; }\n"
    "Real pm_weight_v(Pm pm, int n) { return 0.0; }\n"
    "Real pm_log2_scale(Pm pm, int j) { return 0.0; }\n"
    "Real pm_log2_falloff(Pm pm, int j, int n) { return 0.0; }\n"
    "Real pm_exponent(Pm pm, int j, int k) { return 0.0; }\n"
    "Vec3 pm_coefficient(Pm pm, int j) { return Vec3(0.0, 0.0, 0.0); }\n"
    "Vec3 pm_centre(Pm pm, int j, int n) { return Vec3(0.0, 0.0, 1.0); }\n";

/// The accessors of a view-by-view model, whose numbers (`shading_data`) the host supplies.
constexpr std::size_t k_of_view = 3, k_of_view_lobe = 8;
std::string numbers_of(const SuModel& model, Program& program) {
    const std::size_t J = std::size_t(model.lobes), row = k_of_view + k_of_view_lobe * J;
    program.tables.push_back(
        {fmt::format(
             "number i of the data, float32 in little-endian order; a function or macro of the host. {} rows of {}: "
             "the direction of a view (x, y, z), and for each of its lobes, {}, coefficient (R, G, B), bandwidth, "
             "centre (x, y, z), shape (tau or -alpha, 0 without).",
             model.direction.size(), row, J),
         "number",
         {}});
    const auto at = [&](std::size_t offset) {
        return fmt::format("number[{} * view + {} * j + {}]", row, k_of_view_lobe, k_of_view + offset);
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
        J, model.direction.size(), row, at(0), at(1), at(2), at(3), at(4), at(5), at(6),
        model.shape.empty() ? "0.0" : at(7));
}

/// A number of the kernel's language.
std::string real(float x) { return fmt::format("Real({})", syntax::digits(x)); }
std::string vector(const Rgb& of) { return fmt::format("Vec3({}, {}, {})", real(of.r), real(of.g), real(of.b)); }

/// The function `brdf`, of a value above the horizon that `statements` compute.
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
/// `brdf` of a model, whose numbers but those of lobes are in the text or in a table.
std::string brdf_of(const Model& model, ParameterStorage where, Program& program) {
    if (where != ParameterStorage::tables)
        return brdf_function(formula_text(model, [](float x, auto, auto) { return real(x); }));
    Table numbers{"The numbers of the model.", "model_numbers", {}};
    const std::string statements = formula_text(model, [&](float x, std::string_view parameter, std::size_t index) {
        numbers.add(x, parameter, index);
        return fmt::format("{}[{}]", numbers.name, numbers.numbers.size() - 1);
    });
    if (!numbers.numbers.empty()) program.tables.push_back(std::move(numbers));
    return brdf_function(statements);
}

/// Directional albedos of a BRDF at the nodes. Of the model itself, whose values are the same on every processor, not of
/// what renderers evaluate.
std::vector<Rgb> albedos(const Model& model) {
    const PreparedBrdf brdf = prepare<Model>(model, CosineProposal{});
    std::vector<Rgb> reflected;
    for (int i = 0; i < k_albedo_nodes; ++i) reflected.push_back(albedo_of_node(brdf, albedo_cosine(i)));
    return reflected;
}
/// The text that albedo.glsl requires, to be parsed before it: the sum over lobes where their coefficients are arguments.
std::string albedo_of(const Model& model, ParameterStorage where, bool is_wanted, Program& program) {
    Table nodes{"Directional albedo (R, G, B), a row for each node.", "albedo_nodes", {}, 3};
    if (where != ParameterStorage::arguments) {
        for (const Rgb& of : is_wanted ? albedos(model) : std::vector<Rgb>())
            nodes.numbers.insert(nodes.numbers.end(), {of.r, of.g, of.b});
        program.tables.push_back(std::move(nodes));
        return "Vec3 albedo_node(Pm pm, int i) { return Vec3(albedo_nodes[3 * i], albedo_nodes[3 * i + 1], "
               "albedo_nodes[3 * i + 2]); }\n";
    }
    const auto& lobes = std::get<PmModel>(model.model);
    const auto J = std::size_t(lobes.lobes);
    nodes.comment = "Directional albedo of each lobe with coefficient 1, a row for each node.", nodes.columns = J;
    nodes.numbers.resize(is_wanted ? k_albedo_nodes * J : 0);
    for (std::size_t j = 0; j < J && is_wanted; ++j) {
        const std::vector<Rgb> of_one = albedos(lobe_alone(lobes, j));
        for (std::size_t i = 0; i < of_one.size(); ++i) nodes.numbers[i * J + j] = of_one[i].g;
    }
    program.tables.push_back(std::move(nodes));
    return fmt::format(
        "Vec3 albedo_node(Pm pm, int i) {{\n"
        "    Vec3 sum = Vec3(Real(0.0), Real(0.0), Real(0.0));\n"
        "    for (int j = 0; j < {0}; ++j) sum = sum + albedo_nodes[{0} * i + j] * pm.lobe[j];\n"
        "    return sum;\n}}\n",
        J);
}

/// The text that mixture.glsl requires, to be parsed before it.
std::string mixture_of(const Model& model, const CodeOptions& options, Program& program) {
    Table lobes{"The proposal's lobes, a row for each node: their weights, stretch and power.",
                "mixture_numbers",
                {},
                MixtureProposal::k_numbers};
    MixtureProposal mixture;
    if (options.sampling) {
        const int azimuths = is_isotropic(model) ? 1 : k_anisotropic_azimuths;
        mixture = std::get<MixtureProposal>(propose(model, {azimuths, options.threads}));
        for (std::size_t node = 0; node < MixtureProposal::k_nodes; ++node) {
            const auto numbers = numbers_of(mixture, node);
            lobes.numbers.insert(lobes.numbers.end(), numbers.begin(), numbers.end());
        }
    }
    program.tables.push_back(std::move(lobes));
    return fmt::format(
        "Real mixture_number(int node, int i) {{ return mixture_numbers[{} * node + i]; }}\n"
        "Vec3 mixture_tangent(Vec3 wv) {{ return {}; }}\n",
        MixtureProposal::k_numbers, mixture.has_axis() ? vector({mixture.cosine, mixture.sine, 0}) : "wv");
}

/// The entry functions, by their names in the kernel's language and in the code.
using Names = std::map<std::string, std::string>;
Names entries(const CodeOptions& options, const AddedCode& added) {
    Names names = added.entries;
    names.insert({"brdf", "brdf"});
    if (options.sampling) names.insert({{"sample_light", "sample"}, {"light_pdf", "pdf"}});
    if (options.albedo) names.insert({"directional_albedo", "albedo"});
    return names;
}

/// The entries of a map, and its hook.
Names map_entries(const CodeOptions& options, const AddedCode& added) {
    Names names = entries(options, added);
    // A function sees the host's textures.
    if (syntax::reads_buffers(options.language)) names.insert({{"layer", "layer"}, {"coefficients", "coefficients"}});
    return names;
}
std::string coefficients_of(const PmModel& basis) {
    return fmt::format(
        "// The coefficients of a material: R, G, B of each lobe.\n"
        "struct Pm {{ Vec3 lobe[{}]; }};\n",
        basis.lobes);
}
std::string look_up(const PmModel& basis) {
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

/// The text that a model adds to the kernel.
struct ModelText {
    std::string accessors = k_no_pm + k_no_su, brdf;
    int variates = 1, terms = 1;
    std::string handle = "struct Pm { };\n";
};
ModelText text_of(const Model& model, ParameterStorage where, Program& program) {
    ModelText text{.brdf = brdf_of(model, where, program)};
    if (const auto* pm = std::get_if<PmModel>(&model.model)) {
        text.accessors = numbers_of(*pm, where, program) + k_no_su;
        text.variates = pm->variates, text.terms = std::max(features(pm->form), 1);
        if (where == ParameterStorage::arguments) text.handle = coefficients_of(*pm), text.brdf += look_up(*pm);
    } else if (const auto* su = std::get_if<SuModel>(&model.model)) {
        text.accessors = k_no_pm + numbers_of(*su, program);
    }
    return text;
}

Program program_of(const Model& model, const CodeOptions& options, const std::vector<std::string>& roots,
                   const AddedCode& added = {}, ParameterStorage where = ParameterStorage::constants) {
    Program program;
    const ModelText own = text_of(model, where, program);
    std::map<std::string, std::string> defines{{"SRBF_MAX_VARIATES", std::to_string(own.variates)},
                                               {"SRBF_TERMS", std::to_string(own.terms)},
                                               {"MIXTURE_NODES", std::to_string(MixtureProposal::k_nodes)},
                                               {"ALBEDO_NODES", std::to_string(k_albedo_nodes)}};
    const bool has_albedo = options.albedo || added.albedo, is_mixture = options.sampling || has_albedo;
    const std::string mixture = is_mixture ? mixture_of(model, options, program) : std::string(),
                      nodes =
                          added.albedo_node.empty() ? albedo_of(model, where, has_albedo, program) : added.albedo_node,
                      more =
                          added.text ? added.text(model, where == ParameterStorage::arguments, program, defines) : "";
    syntax::parse(own.handle + own.accessors + k_handles, program, defines, true);
    syntax::parse(k_kernel_text, program, defines);
    syntax::parse(own.brdf, program, defines);
    if (is_mixture) syntax::parse(mixture + k_mixture_text + nodes + k_albedo_text + more, program, defines);
    syntax::specialise(program, roots);
    return program;
}

std::string words(const Model& model) {
    if (const auto* pm = std::get_if<PmModel>(&model.model))
        return fmt::format("{} lobes of {} variates, form {}", pm->lobes, pm->variates, name(pm->form));
    if (const auto* su = std::get_if<SuModel>(&model.model)) return fmt::format("view by view, {} lobes", su->lobes);
    if (std::holds_alternative<OpenPbrModel>(model.model)) return "a surface by parameters of OpenPBR";
    return std::string(kind_words(model));
}

/// The name and the kind of a model, its size, and its provenance.
std::string about(const NamedModel& of) {
    const Model& model = *of.model;
    std::string text = of.name + ": " + words(model);
    text += fmt::format(", {} bytes.", payload_bytes(model));
    for (const auto& [key, value] : model.provenance) text += fmt::format("\n  {}", printable(key + " " + value));
    return text;
}

/// A program, the name of what it is of, and what is known of that.
struct NamedProgram {
    std::string name, about;
    Program program;
};

/// Several programs with what they share printed once.
class Printed {
  public:
    Printed(std::vector<NamedProgram> programs, std::string_view prefix, CodeLanguage language, Names entries)
        : programs_(std::move(programs)),
          prefix_(std::string(prefix) + "_"),
          language_(language),
          entries_(std::move(entries)) {
        for (const auto& [name, printed] : entries_) own_.insert(name);
        for (const auto& of : programs_)
            for (const Table& table : of.program.tables) own_.insert(table.name);
        while (separate()) {
        }
    }

    /// Adds the names of what is defined.
    Result<Done> add_to(DefinedNames& defined) const {
        for (std::size_t i = 0; i < programs_.size(); ++i) {
            const Names of_program = names(i);
            Result<Done> added = Done{};
            each_definition(i, [&](const auto& of) {
                if (added && own_.contains(of.name)) added = defined.add(of_program.at(of.name), programs_[i].name);
            });
            if (!added) return added;
        }
        return Done{};
    }

    std::string text() {
        std::string shared, of_models;
        std::set<std::string> known;
        for (std::size_t i = 0; i < programs_.size(); ++i) {
            syntax::Printer printer(language_, names(i));
            std::string own;
            each_definition(i, [&](const auto& definition) {
                if (own_.contains(definition.name))
                    own += printer.text(definition) + "\n";
                else if (known.insert(definition.name).second)
                    shared += printer.text(definition) + "\n";
            });
            of_models += syntax::comment_text(programs_[i].about) + "\n" + own;
        }
        return shared + of_models;
    }

  private:
    template <typename Visit> void each_definition(std::size_t i, const Visit& visit) const {
        const Program& program = programs_[i].program;
        for (const auto& structure : program.structures) visit(structure);
        for (const auto& table : program.tables) visit(table);
        for (const auto& function : program.functions) visit(function);
    }

    Names names(std::size_t i) const {
        Names names;
        const std::string own = programs_[i].name + "_";
        each_definition(i,
                        [&](const auto& of) { names[of.name] = (own_.contains(of.name) ? own : prefix_) + of.name; });
        for (const auto& [name, printed] : entries_) names[name] = own + printed;
        return names;
    }

    /// Lets each model have its own of what is not the same in all that have it, or needs what is a model's own;
    /// whether there was such.
    bool separate() {
        Names texts;
        const std::size_t before = own_.size();
        for (const NamedProgram& of : programs_)
            for (const syntax::Function& function : of.program.functions)
                syntax::visit_expressions(function.body, [&](const syntax::Expression& part) {
                    if (own_.contains(part.text)) own_.insert(function.name);
                });
        for (std::size_t i = 0; i < programs_.size(); ++i) {
            syntax::Printer printer(language_, names(i));
            each_definition(i, [&](const auto& of) {
                if (own_.contains(of.name)) return;
                const std::string text = printer.text(of);
                if (texts.emplace(of.name, text).first->second != text) own_.insert(of.name);
            });
        }
        return own_.size() != before;
    }

    std::vector<NamedProgram> programs_;
    std::string prefix_;
    CodeLanguage language_;
    Names entries_;
    std::set<std::string> own_;
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
                             letters == "meshstandard";  // whose classes three.js and its module have
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) || is_reserved)
        name.insert(0, name.empty() ? "brdf" : "brdf_");
    return name;
}

Rgb albedo_of_node(const PreparedBrdf& brdf, double cosine) { return albedo(brdf, std::max(float(cosine), 1e-30f)); }

Model lobe_alone(PmModel basis, std::size_t j) {
    basis.coefficient.assign(std::size_t(basis.lobes), Rgb{}), basis.coefficient[j] = {1, 1, 1};
    return {std::move(basis), {}};
}

std::optional<CodeLanguage> code_language_named(std::string_view name) {
    const auto row = std::ranges::find(k_code_languages, name, &CodeLanguageRow::name);
    return row == std::end(k_code_languages) ? std::nullopt : std::optional(row->language);
}

std::string code_language_names() {
    return fmt::format("{}", fmt::join(std::views::transform(k_code_languages, &CodeLanguageRow::name), ", "));
}

Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix, const CodeOptions& asked,
                                 const AddedCode& added) {
    CodeOptions options = asked;
    std::vector<NamedModel> brdfs;  // with the parts of BSDFs
    std::vector<PartModels> parts;
    std::string list, of_bsdfs;
    DefinedNames defined;
    const auto is_bsdf = [](const NamedModel& of) { return std::holds_alternative<BsdfModel>(of.model->model); };
    if (added.sampling) options.sampling = true;
    // Which part is drawn from follows from their albedos.
    if (options.sampling && std::ranges::any_of(models, is_bsdf)) options.albedo = true;
    const auto add_name = [&](const std::string& name) { list += (list.empty() ? "" : ", ") + name; };
    for (const NamedModel& of : models) {
        if (is_bsdf(of)) {
            const PartModels& own = parts.emplace_back(part_models(of, options.sampling));
            brdfs.insert(brdfs.end(), own.named.begin(), own.named.end());
            for (const std::string& name : bsdf_functions(of, options.sampling)) add_name(name);
            const auto code = bsdf_code(of, options, defined);
            if (!code) return code.error();
            of_bsdfs += syntax::comment_text(about(of)) + "\n" + *code;
        } else {
            brdfs.push_back(of);
            for (const auto& [name, printed] : entries(options, added))
                add_name(fmt::format("{}_{}", of.name, printed));
        }
    }
    std::vector<NamedProgram> programs;
    std::vector<std::string> roots;
    for (const auto& [name, printed] : entries(options, added)) roots.push_back(name);
    for (const NamedModel& of : brdfs) {
        if (const auto* su = std::get_if<SuModel>(&of.model->model)) {
            const auto refused = [&](const char* what, const char* expected, const char* found) {
                return Error{of.name, {}, what, expected, found, ErrorCode::argument};
            };
            if (su->interpolation == SuInterpolation::plain)
                return refused("model", "interpolation of rotated views", "plain interpolation");
            if (options.sampling) return refused("sampling code", "a model that is not view by view", "one that is");
            if (!syntax::reads_buffers(options.language))
                return refused("view-by-view model", "a language with global buffers", "one without");
        }
        programs.push_back({of.name, about(of), program_of(*of.model, options, roots, added)});
    }
    Printed printed(std::move(programs), prefix, options.language, entries(options, added));
    if (const auto distinct = printed.add_to(defined); !distinct) return distinct.error();
    const std::string definitions = printed.text() + of_bsdfs;
    return syntax::whole_text(options.language, list, std::string(prefix) + "_BRDF", definitions);
}

Result<std::string> map_code(const Library& map, std::string_view name, const CodeOptions& options,
                             const AddedCode& added) {
    const auto refused = [&](const char* what, const char* expected, const char* found) {
        return Error{std::string(name), {}, what, expected, found, ErrorCode::argument};
    };
    if (!map.dense()) return refused("library", "a coefficient for each lobe", "some lobes of each material");
    if (options.sampling || added.sampling) return refused("code of a map", "values, albedos and light", "sampling");
    Names names = map_entries(options, added);
    std::vector<std::string> roots;
    std::string list;
    for (const auto& [of, printed] : names) {
        roots.push_back(of);
        list += fmt::format("{}{}_{}", list.empty() ? "" : ", ", name, printed);
    }
    const Model basis{map.basis, {}};
    std::string about = fmt::format("{}: {} lobes of {} variates, form {}, {} bytes, which all materials share.", name,
                                    map.basis.lobes, map.basis.variates, srbf::name(map.basis.form), basis_bytes(map));
    if (map.width > 0) about += fmt::format("\n  map {} x {}", map.width, map.count() / map.width);
    for (const auto& [key, value] : map.provenance) about += fmt::format("\n  {}", printable(key + " " + value));
    NamedProgram program{std::string(name), about,
                         program_of(basis, options, roots, added, ParameterStorage::arguments)};
    names.insert({"Pm", "Coefficients"});
    return syntax::whole_text(options.language, list, std::string(name) + "_BRDF",
                              Printed({std::move(program)}, name, options.language, names).text());
}

namespace {

/// The functions that the options name. Errors: no extra has them.
Result<AddedCode> added_by(const CodeOptions& options) {
    AddedCode all;
    for (const auto extra : k_extra_code) {
        AddedCode own = extra().functions(options);
        if (own.entries.empty()) continue;
        all.entries.merge(own.entries);
        all.sampling = all.sampling || own.sampling, all.albedo = all.albedo || own.albedo;
        all.text = [first = std::move(all.text), next = std::move(own.text)](const auto& model, bool of_basis,
                                                                             auto& program, auto& defines) {
            const std::string before = first ? first(model, of_basis, program, defines) : "";
            return before + next(model, of_basis, program, defines);
        };
    }
    for (const std::string& name : options.with)
        if (std::ranges::find(code_features(), name, &CodeFeature::name) == code_features().end())
            return Error{"code", {}, "functions", "those of this program", name, ErrorCode::argument};
    return all;
}
/// The rows of a kind of all extras.
template <typename Row> std::vector<Row> rows_of_extras(std::vector<Row> rows, std::vector<Row> CodeExtra::*of) {
    for (const auto extra : k_extra_code) rows.insert(rows.end(), (extra().*of).begin(), (extra().*of).end());
    return rows;
}

}  // namespace

std::span<const CodeFeature> code_features() {
    static const std::vector<CodeFeature> all = rows_of_extras({}, &CodeExtra::features);
    return all;
}
std::span<const CodeModule> code_modules() {
    static const std::vector<CodeModule> all = rows_of_extras({}, &CodeExtra::modules);
    return all;
}

Result<std::string> shading_code(std::span<const NamedModel> models, std::string_view prefix,
                                 const CodeOptions& options) {
    const auto added = added_by(options);
    return added ? shading_code(models, prefix, options, *added) : added.error();
}
Result<std::string> map_code(const Library& map, std::string_view name, const CodeOptions& options) {
    const auto added = added_by(options);
    return added ? map_code(map, name, options, *added) : added.error();
}

Result<std::string> python_code(const Model& model, int threads) {
    if (std::holds_alternative<SuModel>(model.model) || std::holds_alternative<BsdfModel>(model.model))
        return Error{"python code", {}, "model", "multivariate, or Lambert and GGX", "another", ErrorCode::argument};
    const Program program =
        program_of(model, {.sampling = true, .threads = threads},
                   {"brdf", "chosen_lobe", "sample_of_lobe", "light_pdf"}, {}, ParameterStorage::tables);
    std::string text;
    for (const Table& table : program.tables) text += syntax::python_text(table);
    for (const syntax::Function& function : program.functions) text += "\n\n" + syntax::python_text(function, program);
    return text;
}

}  // namespace srbf
