#include "code/bsdf_code.h"

#include <fmt/format.h>

#include "brdf/parts.h"
#include "code/print.h"
#include "code/syntax.h"
#include "models/bsdf/bsdf_functions.h"

namespace srbf {
namespace {

using syntax::Program;

const BsdfModel& bsdf_of(const NamedModel& of) { return std::get<BsdfModel>(of.model->model); }

/// A part's function as the kernel's language calls it.
struct Call {
    std::string function;  ///< empty: the part is 0
    bool exchanged = false;
};
Call call_of(const BsdfModel& bsdf, Part part, bool sampling) {
    const Answering<Model> of = answering(bsdf.part, part);
    if (!of.brdf) return {};
    const bool is_own = bsdf.part[std::size_t(part)] != nullptr || (sampling && of.exchanged);
    return {std::string(name(is_own ? part : counterpart(part))), of.exchanged && !is_own};
}

constexpr const char* k_black = "Vec3(Real(0.0), Real(0.0), Real(0.0))";

/// The rings of a beam and their nodes: the first ring at 0, the last at 90 degrees, where a beam without a ring is 0.
struct BeamTables {
    syntax::Table rings, nodes;
};
BeamTables tables_of(const Beam& beam, std::string_view name) {
    BeamTables of{{"Rings of nodes: angle to the normal, index of the first node, number of nodes.",
                   fmt::format("{}_rings", name),
                   {},
                   3},
                  {"The share of unscattered light at each node: R, G, B.", fmt::format("{}_nodes", name), {}, 3}};
    const auto add = [](syntax::Table& table, auto... numbers) {
        table.numbers.insert(table.numbers.end(), {float(numbers)...});
    };
    std::size_t first = 0;
    if (beam.theta.front() > 0) add(of.rings, 0, 0, beam.nodes(0));
    for (std::size_t ring = 0; ring < beam.theta.size(); ++ring) {
        add(of.rings, beam.theta[ring], first, beam.nodes(ring));
        first += std::size_t(beam.nodes(ring));
    }
    for (const Rgb& share : beam.share) add(of.nodes, share.r, share.g, share.b);
    if (beam.theta.back() < float(k_pi / 2)) {
        add(of.rings, k_pi / 2, first, 1);
        add(of.nodes, 0, 0, 0);
    } else if (of.rings.numbers.size() == 3) {
        of.rings.numbers.insert(of.rings.numbers.begin(), {0, 0, float(beam.nodes(0))});
    }
    return of;
}

/// The share of a beam for light from wl, in the frame of its part.
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

/// The call that answers for a part's beam at the direction from which it comes to the viewer.
std::string call_of(const Beams& beams, Part part) {
    const auto of = [](Part which) { return fmt::format("{}_beam", k_beam_names[std::size_t(which)]); };
    if (!beams[std::size_t(part)].empty()) return of(part) + "(Vec3(-wv.x, -wv.y, wv.z))";
    const Part other = counterpart(part);
    if (is_transmission(part) && !beams[std::size_t(other)].empty()) return of(other) + "(wv)";
    return k_black;
}

/// The functions `beam` and `mirror_beam`.
std::string beams_text(const Beams& beams, Program& program) {
    std::string text;
    for (std::size_t b = 0; b < beams.size(); ++b)
        if (!beams[b].empty()) text += beam_text(beams[b], fmt::format("{}_beam", k_beam_names[b]), program);
    const auto function = [&](std::string_view name, std::string_view what, Part above, Part below) {
        if (beams[std::size_t(above)].empty() && beams[std::size_t(below)].empty()) return;
        text += fmt::format(
            "// {0}\nVec3 {1}(Vec3 wv) {{\n    if (!(dot(wv, wv) < Real(1.0e30))) return {4};\n"
            "    if (wv.z > Real(0.0)) return {2};\n    return {3};\n}}\n",
            what, name, call_of(beams, above), call_of(beams, below), k_black);
    };
    function("beam",
             "The share for R, G, B of the light from -wv that passes unscattered to the viewer, on either side.",
             Part::transmission_back, Part::transmission_front);
    function("mirror_beam",
             "The share for R, G, B of the light from the mirror direction that is reflected unscattered.",
             Part::reflection_front, Part::reflection_back);
    return text;
}

/// The functions that those of a BSDF call, to be parsed before them.
std::string stubs_of(const BsdfModel& bsdf, bool sampling) {
    std::string text;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const Call call = call_of(bsdf, Part(p), sampling);
        if (call.function != k_part_names[p]) continue;
        text += fmt::format(
            "Vec3 {0}_brdf(Vec3 wl, Vec3 wv) {{ return wl; }}\n"
            "Vec3 {0}_sample(Vec3 wv, Real u1, Real u2, Real selector) {{ return wv; }}\n"
            "Real {0}_pdf(Vec3 wl, Vec3 wv) {{ return wl.x; }}\n"
            "Vec3 {0}_albedo(Real cosine) {{ return {1}; }}\n",
            call.function, k_black);
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
        const auto on = [](float side) { return side < 0 ? "<" : ">"; };
        text += fmt::format("    if (wl.z {} Real(0.0) && wv.z {} Real(0.0)) return {}_brdf({});\n",
                            on(side_of_light(Part(p))), on(side_of_viewer(Part(p))), call.function,
                            call.exchanged ? "v, l" : "l, v");
    }
    return text + fmt::format("    return {};\n}}\n", k_black);
}

/// `line` with {0} and {1} replaced by the calls of the parts by which a viewer at the front sees light reflected and
/// transmitted, {2} and {3} by those for a viewer at the back; by `none` where there is no such part.
std::string for_viewers(const char* line, const BsdfModel& bsdf, const char* call, const char* none) {
    const auto of = [&](Part part) {
        const std::string function = call_of(bsdf, part, true).function;
        return function.empty() ? std::string(none) : function + call;
    };
    return fmt::format(fmt::runtime(line), of(Part::reflection_front), of(Part::transmission_back),
                       of(Part::reflection_back), of(Part::transmission_front));
}

/// Reflection or transmission is drawn by the luminance that it sends to the viewer, and at least one in a thousand
/// times.
std::string chance_text(const BsdfModel& bsdf) {
    return "Real luminance(Vec3 c) { return Real(0.2126) * c.x + Real(0.7152) * c.y + Real(0.0722) * c.z; }\n"
           "// The chance of drawing reflected light, otherwise transmitted light.\n"
           "Real reflected_chance(Vec3 wv) {\n"
           "    Real cosine = abs(wv.z);\n" +
           for_viewers(
               "    Real r = luminance({0});\n    Real t = luminance({1});\n"
               "    if (wv.z < Real(0.0)) {{\n        r = luminance({2});\n        t = luminance({3});\n    }}\n",
               bsdf, "_albedo(cosine)", k_black) +
           "    Real least = max(Real(0.001) * (r + t), Real(1.0e-30));\n"
           "    r = max(r, least);\n"
           "    t = max(t, least);\n"
           "    return r / (r + t);\n"
           "}\n";
}

/// Directions to the light at the front and the back.
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
           for_viewers(
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
           for_viewers(
               "    if (wv.z > Real(0.0) && wl.z > Real(0.0)) return chance * {0};\n"
               "    if (wv.z > Real(0.0) && wl.z < Real(0.0)) return (Real(1.0) - chance) * {1};\n"
               "    if (wv.z < Real(0.0) && wl.z < Real(0.0)) return chance * {2};\n"
               "    if (wv.z < Real(0.0) && wl.z > Real(0.0)) return (Real(1.0) - chance) * {3};\n",
               bsdf, "_pdf(l, v)", "Real(0.0)") +
           "    return Real(0.0);\n"
           "}\n";
}

/// The tables and functions of `text`, which may call functions of `stubs`, as NAME_….
Result<std::string> printed(const std::string& name, Program program, const std::string& stubs, const std::string& text,
                            CodeLanguage language, DefinedNames& defined) {
    std::map<std::string, std::string> defines, names;
    syntax::parse(stubs, program, defines);
    const std::size_t known = program.functions.size();
    syntax::parse(text, program, defines);
    for (const auto& table : program.tables) names[table.name] = name + "_" + table.name;
    for (const auto& function : program.functions) names[function.name] = name + "_" + function.name;
    names["sample_light"] = name + "_sample", names["light_pdf"] = name + "_pdf";
    syntax::Printer printer(language, names);
    std::string all;
    Result<Done> distinct = Done{};
    const auto add = [&](const auto& definition) {
        if (distinct) distinct = defined.add(names.at(definition.name), name);
        all += printer.text(definition) + "\n";
    };
    for (const auto& table : program.tables) add(table);
    for (std::size_t i = known; i < program.functions.size(); ++i) add(program.functions[i]);
    if (!distinct) return distinct.error();
    return all;
}

}  // namespace

PartModels part_models(const NamedModel& of, bool sampling) {
    const BsdfModel& bsdf = bsdf_of(of);
    PartModels parts;
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (call_of(bsdf, Part(p), sampling).function != k_part_names[p]) continue;
        auto own = bsdf.part[p];
        if (!own) {
            Model exchanged = *bsdf.part[std::size_t(counterpart(Part(p)))];
            exchange(exchanged);
            own = std::make_shared<const Model>(std::move(exchanged));
        }
        parts.named.push_back({fmt::format("{}_{}", of.name, k_part_names[p]), own.get()});
        parts.own.push_back(std::move(own));
    }
    return parts;
}

Result<std::string> bsdf_code(const NamedModel& of, const CodeOptions& options, DefinedNames& defined) {
    const BsdfModel& bsdf = bsdf_of(of);
    Program program;
    std::string text = value_text(bsdf, options.sampling) + beams_text(bsdf.beam, program);
    if (options.sampling) text += chance_text(bsdf) + sampling_text(bsdf) + density_text(bsdf);
    return printed(of.name, std::move(program), stubs_of(bsdf, options.sampling), text, options.language, defined);
}

std::string beam_code(const std::string& name, const Beams& beams, CodeLanguage language) {
    Program program;
    const std::string text = beams_text(beams, program);
    DefinedNames defined;
    return *printed(name, std::move(program), "", text, language, defined);  // names of one
}

std::vector<std::string> bsdf_functions(const NamedModel& of, bool sampling) {
    const Beams& beams = bsdf_of(of).beam;
    std::vector<std::string> names{"bsdf"};
    if (!beams[2].empty() || !beams[3].empty()) names.push_back("beam");
    if (!beams[0].empty() || !beams[1].empty()) names.push_back("mirror_beam");
    if (sampling) names.insert(names.end(), {"sample", "pdf"});
    for (std::string& name : names) name = of.name + "_" + name;
    return names;
}

}  // namespace srbf
