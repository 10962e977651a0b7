#include "code/bsdf_code.h"

#include <fmt/format.h>

#include "brdf/parts.h"
#include "code/print.h"
#include "models/bsdf/bsdf_functions.h"

namespace SRBF_NAMESPACE {
namespace {

using syntax::Program;

const BsdfModel& bsdf_of(const NamedModel& named) { return std::get<BsdfModel>(named.model->model); }

/// The function that evaluates a part.
struct Call {
    std::string function;  ///< empty if the part is 0
    bool is_exchanged = false;
};
Call call_of(const BsdfModel& bsdf, Part part, bool sampling) {
    const PartSource<Model> used = part_source(bsdf.part, part);
    if (!used.brdf) return {};
    const bool is_own = bsdf.part[std::size_t(part)] != nullptr || (sampling && used.is_exchanged);
    return {std::string(name(is_own ? part : counterpart(part))), used.is_exchanged && !is_own};
}

constexpr const char* k_black = "Vec3(Real(0.0), Real(0.0), Real(0.0))";

/// The rings of a beam and their nodes, with rings added at 0 and at 90 degrees, where the beam vanishes.
struct BeamTables {
    syntax::Table rings, nodes;
};
BeamTables tables_of(const Beam& beam, std::string_view name) {
    BeamTables tables{{"Rings of nodes: angle to the normal, index of the first node, number of nodes.",
                       fmt::format("{}_rings", name),
                       {},
                       3},
                      {"The share of unscattered light at each node: R, G, B.", fmt::format("{}_nodes", name), {}, 3}};
    const auto add = [](syntax::Table& table, auto... numbers) {
        table.numbers.insert(table.numbers.end(), {float(numbers)...});
    };
    std::size_t first = 0;
    if (beam.theta.front() > 0) add(tables.rings, 0, 0, beam.nodes(0));
    for (std::size_t ring = 0; ring < beam.theta.size(); ++ring) {
        add(tables.rings, beam.theta[ring], first, beam.nodes(ring));
        first += std::size_t(beam.nodes(ring));
    }
    for (const Rgb& fraction : beam.fraction) add(tables.nodes, fraction.r, fraction.g, fraction.b);
    if (beam.theta.back() < float(k_pi / 2)) {
        add(tables.rings, k_pi / 2, first, 1);
        add(tables.nodes, 0, 0, 0);
    } else if (tables.rings.numbers.size() == 3) {
        tables.rings.numbers.insert(tables.rings.numbers.begin(), {0, 0, float(beam.nodes(0))});
    }
    return tables;
}

/// The function of a beam's share for light from wl, in the frame of its part.
std::string beam_text(const Beam& beam, const std::string& name, Program& program) {
    const BeamTables tables = tables_of(beam, name);
    program.tables.push_back(tables.rings);
    program.tables.push_back(tables.nodes);
    constexpr const char* at_azimuth =
        "    Real planar = sqrt(wl.x * wl.x + wl.y * wl.y);\n"
        "    Real turns = acos(min(max(wl.x / max(planar, Real(1.0e-20)), Real(-1.0)), Real(1.0))) / Real(6.2831853);\n"
        "    if (wl.y < Real(0.0)) turns = Real(1.0) - turns;\n";
    return fmt::format(
        "Vec3 {0}_node(int i) {{ return Vec3({0}_nodes[3 * i], {0}_nodes[3 * i + 1], {0}_nodes[3 * i + 2]); }}\n"
        "// On a ring, for an azimuth in turns.\n"
        "Vec3 {0}_ring(int ring, Real turns) {{\n"
        "    int first = int({0}_rings[3 * ring + 1]);\n"
        "    int count = int({0}_rings[3 * ring + 2]);\n"
        "    Real at = turns * Real(count);\n"
        "    int below = at < Real(count - 1) ? int(at) : count - 1;\n"
        "    int above = below + 1 < count ? below + 1 : 0;\n"
        "    Real beyond = at - Real(below);\n"
        "    return (Real(1.0) - beyond) * {0}_node(first + below) + beyond * {0}_node(first + above);\n"
        "}}\n"
        "Vec3 {0}(Vec3 wl) {{\n"
        "    Real theta = acos(min(abs(wl.z), Real(1.0)));\n"
        "{2}"
        "    int below = 0;\n"
        "    for (int i = 1; i < {1}; ++i) {{\n"
        "        if ({0}_rings[3 * i] <= theta) below = i;\n"
        "    }}\n"
        "    Real from = {0}_rings[3 * below];\n"
        "    Real beyond = min((theta - from) / ({0}_rings[3 * below + 3] - from), Real(1.0));\n"
        "    return (Real(1.0) - beyond) * {0}_ring(below, turns) + beyond * {0}_ring(below + 1, turns);\n"
        "}}\n",
        name, tables.rings.numbers.size() / 3 - 1,
        beam.azimuths.empty() ? "    Real turns = Real(0.0);\n" : at_azimuth);
}

/// The call of the beam of a part, or of its counterpart by reciprocity, for the light that reaches the viewer at wv.
std::string beam_call(const Beams& beams, Part part) {
    const auto function = [](Part beam) { return fmt::format("{}_beam", k_beam_names[std::size_t(beam)]); };
    if (!beams[std::size_t(part)].empty()) return function(part) + "(Vec3(-wv.x, -wv.y, wv.z))";
    const Part other = counterpart(part);
    if (is_transmission(part) && !beams[std::size_t(other)].empty()) return function(other) + "(wv)";
    return k_black;
}

std::string beams_text(const Beams& beams, CodeLanguage language, Program& program) {
    std::string text;
    for (std::size_t b = 0; b < beams.size(); ++b)
        if (!beams[b].empty()) text += beam_text(beams[b], fmt::format("{}_beam", k_beam_names[b]), program);
    const auto add_function = [&](std::string_view name, std::string_view comment, Part above, Part below) {
        if (beams[std::size_t(above)].empty() && beams[std::size_t(below)].empty()) return;
        text += fmt::format(
            "// {0}\nVec3 {1}(Vec3 wv) {{\n    if (!({5})) return {4};\n"
            "    if (wv.z > Real(0.0)) return {2};\n    return {3};\n}}\n",
            comment, name, beam_call(beams, above), beam_call(beams, below), k_black,
            syntax::are_finite(language, {"wv"}));
    };
    add_function("beam",
                 "The share for R, G, B of the light from -wv that passes unscattered to the viewer, on either side.",
                 Part::transmission_back, Part::transmission_front);
    add_function("mirror_beam",
                 "The share for R, G, B of the light from the mirror direction that is reflected unscattered.",
                 Part::reflection_front, Part::reflection_back);
    return text;
}

/// Declarations, for the parser, of the functions that the code of a BSDF calls.
std::string part_stubs(const BsdfModel& bsdf, bool sampling) {
    std::string text;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Call call = call_of(bsdf, Part(p), sampling);
        if (call.function == k_part_names[p]) text += brdf_stubs(call.function);
    }
    return text;
}

std::string value_text(const BsdfModel& bsdf, bool sampling) {
    std::string text =
        "// f [1/sr] for R, G, B, of unit vectors in the local frame on either side of the surface, wl towards the\n"
        "// light, wv towards the viewer, without beams; 0 where one of them lies in the surface.\n"
        "Vec3 bsdf(Vec3 wl, Vec3 wv) {\n"
        "    Vec3 l = Vec3(wl.x, wl.y, abs(wl.z));\n"
        "    Vec3 v = Vec3(wv.x, wv.y, abs(wv.z));\n";
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Call call = call_of(bsdf, Part(p), sampling);
        if (call.function.empty()) continue;
        const auto comparison = [](float side) { return side < 0 ? "<" : ">"; };
        text += fmt::format("    if (wl.z {} Real(0.0) && wv.z {} Real(0.0)) return {}_brdf({});\n",
                            comparison(side_of_light(Part(p))), comparison(side_of_viewer(Part(p))), call.function,
                            call.is_exchanged ? "v, l" : "l, v");
    }
    return text + fmt::format("    return {};\n}}\n", k_black);
}

/// Formats `text` with calls of parts: {0} and {1} reflect and transmit light to a viewer at the front, {2} and {3} to
/// one at the back. `none` replaces the call of a part that does not exist.
std::string format_calls(const char* text, const BsdfModel& bsdf, const char* call, const char* none) {
    const auto part_call = [&](Part part) {
        const std::string function = call_of(bsdf, part, true).function;
        return function.empty() ? std::string(none) : function + call;
    };
    return fmt::format(fmt::runtime(text), part_call(Part::reflection_front), part_call(Part::transmission_back),
                       part_call(Part::reflection_back), part_call(Part::transmission_front));
}

/// Reflection and transmission are chosen in proportion to the luminance at the viewer, but at least 1 time in 1000.
std::string chance_text(const BsdfModel& bsdf) {
    return "Real luminance(Vec3 c) { return Real(0.2126) * c.x + Real(0.7152) * c.y + Real(0.0722) * c.z; }\n"
           "// The chance of drawing reflected light, otherwise transmitted light.\n"
           "Real reflected_chance(Vec3 wv) {\n"
           "    Real cosine = abs(wv.z);\n" +
           format_calls(
               "    Real r = luminance({0});\n    Real t = luminance({1});\n"
               "    if (wv.z < Real(0.0)) {{\n        r = luminance({2});\n        t = luminance({3});\n    }}\n",
               bsdf, "_albedo(cosine)", k_black) +
           "    Real least = max(Real(0.001) * (r + t), Real(1.0e-30));\n"
           "    r = max(r, least);\n"
           "    t = max(t, least);\n"
           "    return r / (r + t);\n"
           "}\n";
}

std::string sampling_text(const BsdfModel& bsdf) {
    return "// A direction to the light on either side for three numbers uniform in [0,1); (0, 0, 0) where the draw\n"
           "// has none. Beams are not drawn.\n"
           "Vec3 sample_light(Vec3 wv, Real u1, Real u2, Real selector) {\n"
           "    Real chance = reflected_chance(wv);\n"
           "    Vec3 v = Vec3(wv.x, wv.y, abs(wv.z));\n" +
           fmt::format("    Vec3 l = {};\n", k_black) +
           "    Real side = wv.z < Real(0.0) ? Real(-1.0) : Real(1.0);\n"
           "    Real s = selector / chance;\n"
           "    if (selector >= chance) {\n"
           "        s = (selector - chance) / (Real(1.0) - chance);\n"
           "        side = -side;\n"
           "    }\n"
           "    s = min(s, Real(0.99999994));\n" +
           format_calls(
               "    if (wv.z > Real(0.0) && selector < chance) {{ l = {0}; }}\n"
               "    if (wv.z > Real(0.0) && selector >= chance) {{ l = {1}; }}\n"
               "    if (wv.z < Real(0.0) && selector < chance) {{ l = {2}; }}\n"
               "    if (wv.z < Real(0.0) && selector >= chance) {{ l = {3}; }}\n",
               bsdf, "_sample(v, u1, u2, s)", k_black) +
           fmt::format("    if (l.z <= Real(0.0)) return {};\n", k_black) +
           "    return Vec3(l.x, l.y, side * l.z);\n"
           "}\n";
}

std::string density_text(const BsdfModel& bsdf) {
    return "// Its density [1/sr].\n"
           "Real light_pdf(Vec3 wl, Vec3 wv) {\n"
           "    Real chance = reflected_chance(wv);\n"
           "    Vec3 l = Vec3(wl.x, wl.y, abs(wl.z));\n"
           "    Vec3 v = Vec3(wv.x, wv.y, abs(wv.z));\n" +
           format_calls(
               "    if (wv.z > Real(0.0) && wl.z > Real(0.0)) return chance * {0};\n"
               "    if (wv.z > Real(0.0) && wl.z < Real(0.0)) return (Real(1.0) - chance) * {1};\n"
               "    if (wv.z < Real(0.0) && wl.z < Real(0.0)) return chance * {2};\n"
               "    if (wv.z < Real(0.0) && wl.z > Real(0.0)) return (Real(1.0) - chance) * {3};\n",
               bsdf, "_pdf(l, v)", "Real(0.0)") +
           "    return Real(0.0);\n"
           "}\n";
}

}  // namespace

std::string brdf_stubs(std::string_view name) {
    return fmt::format(
        "Vec3 {0}_brdf(Vec3 wl, Vec3 wv) {{ return wl; }}\n"
        "Vec3 {0}_sample(Vec3 wv, Real u1, Real u2, Real selector) {{ return wv; }}\n"
        "Real {0}_pdf(Vec3 wl, Vec3 wv) {{ return wl.x; }}\n"
        "Vec3 {0}_albedo(Real cosine) {{ return Vec3(cosine, cosine, cosine); }}\n",
        name);
}

Result<std::string> print_functions(const Caller& caller, Program program, const std::string& text,
                                    CodeLanguage language, DefinedNames& defined) {
    std::map<std::string, std::string> defines, names;
    syntax::parse(caller.stubs, program, defines);
    const std::size_t known = program.functions.size();
    syntax::parse(text, program, defines);
    for (const auto& table : program.tables) names[table.name] = caller.name + "_" + table.name;
    for (std::size_t i = 0; i < program.functions.size(); ++i) {
        const std::string& function = program.functions[i].name;
        names[function] = (i < known ? caller.stub_prefix : caller.name + "_") + function;
    }
    names["sample_light"] = caller.name + "_sample";
    names["light_pdf"] = caller.name + "_pdf";
    names["directional_albedo"] = caller.name + "_albedo";
    syntax::Printer printer(language, names);
    std::string definitions;
    Result<Done> distinct = Done{};
    const auto add = [&](const auto& definition) {
        if (distinct) distinct = defined.add(names.at(definition.name), caller.name);
        definitions += printer.text(definition) + "\n";
    };
    for (const auto& table : program.tables) add(table);
    for (std::size_t i = known; i < program.functions.size(); ++i) add(program.functions[i]);
    if (!distinct) return distinct.error();
    return definitions;
}

PartModels part_models(const NamedModel& named, bool sampling) {
    const BsdfModel& bsdf = bsdf_of(named);
    PartModels parts;
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (call_of(bsdf, Part(p), sampling).function != k_part_names[p]) continue;
        auto part = bsdf.part[p];
        if (!part) {
            Model exchanged = *bsdf.part[std::size_t(counterpart(Part(p)))];
            exchange(exchanged);
            part = std::make_shared<const Model>(std::move(exchanged));
        }
        parts.named.push_back({fmt::format("{}_{}", named.name, k_part_names[p]), part.get()});
        parts.owned.push_back(std::move(part));
    }
    return parts;
}

Result<std::string> bsdf_code(const NamedModel& named, const CodeOptions& options, DefinedNames& defined) {
    const BsdfModel& bsdf = bsdf_of(named);
    Program program;
    std::string text = value_text(bsdf, options.sampling) +
                       beams_text(complete_beams(bsdf.part, bsdf.beam), options.language, program);
    if (options.sampling) text += chance_text(bsdf) + sampling_text(bsdf) + density_text(bsdf);
    return print_functions({named.name, part_stubs(bsdf, options.sampling), named.name + "_"}, std::move(program), text,
                           options.language, defined);
}

std::string beam_code(const std::string& name, const Beams& beams, CodeLanguage language) {
    Program program;
    const std::string text = beams_text(beams, language, program);
    DefinedNames defined;
    return *print_functions({.name = name}, std::move(program), text, language, defined);
}

std::vector<std::string> bsdf_functions(const NamedModel& named, bool sampling) {
    const Beams& beams = bsdf_of(named).beam;
    std::vector<std::string> names{"bsdf"};
    if (!beams[2].empty() || !beams[3].empty()) names.push_back("beam");
    if (!beams[0].empty() || !beams[1].empty()) names.push_back("mirror_beam");
    if (sampling) names.insert(names.end(), {"sample", "pdf"});
    for (std::string& name : names) name = named.name + "_" + name;
    return names;
}

}  // namespace
