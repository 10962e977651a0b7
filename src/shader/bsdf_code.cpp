#include "shader/bsdf_code.h"

#include <fmt/format.h>

#include "shader/print.h"
#include "shader/syntax.h"

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

/// The nodes of a beam: angle, R, G, B; the first at 0, the last at 90 degrees, where a beam without a node is 0.
syntax::Table nodes_of(const Beam& beam, std::string_view name) {
    syntax::Table nodes{"The share of unscattered light: angle to the normal and R, G, B, a row for each node.",
                        fmt::format("{}_nodes", name),
                        {},
                        4};
    const auto add = [&](float theta, const Rgb& share) {
        nodes.numbers.insert(nodes.numbers.end(), {theta, share.r, share.g, share.b});
    };
    if (beam.theta.front() > 0) add(0, beam.share.front());
    for (std::size_t i = 0; i < beam.theta.size(); ++i) add(beam.theta[i], beam.share[i]);
    if (beam.theta.back() < float(k_pi / 2)) add(float(k_pi / 2), {});
    if (nodes.numbers.size() == 4) add(float(k_pi / 2), beam.share.back());
    return nodes;
}

constexpr const char* k_black = "Vec3(Real(0.0), Real(0.0), Real(0.0))";

/// The functions `beam` and `mirror_beam`.
std::string beams_text(const Beams& beams, Program& program) {
    std::string text;
    for (std::size_t b = 0; b < beams.size(); ++b) {
        if (beams[b].empty()) continue;
        const std::string of = fmt::format("{}_beam", k_beam_names[b]);
        program.tables.push_back(nodes_of(beams[b], of));
        text += fmt::format(
            "Vec3 {0}(Real cosine) {{\n"
            "    Real theta = acos(min(abs(cosine), Real(1.0)));\n"
            "    int below = 0;\n"
            "    for (int i = 1; i < {1}; ++i) {{\n"
            "        if ({0}_nodes[4 * i] <= theta) below = 4 * i;\n"
            "    }}\n"
            "    Real first = {0}_nodes[below];\n"
            "    Real beyond = min((theta - first) / ({0}_nodes[below + 4] - first), Real(1.0));\n"
            "    Vec3 a = Vec3({0}_nodes[below + 1], {0}_nodes[below + 2], {0}_nodes[below + 3]);\n"
            "    Vec3 b = Vec3({0}_nodes[below + 5], {0}_nodes[below + 6], {0}_nodes[below + 7]);\n"
            "    return (Real(1.0) - beyond) * a + beyond * b;\n"
            "}}\n",
            of, program.tables.back().numbers.size() / 4 - 1);
    }
    if (!beams[2].empty())
        text +=
            "// The share for R, G, B of the light from -wv that passes unscattered to the viewer, on either side.\n"
            "Vec3 beam(Vec3 wv) { return transmission_beam(wv.z); }\n";
    if (!beams[0].empty() || !beams[1].empty()) {
        const auto side = [&](std::size_t b) {
            return beams[b].empty() ? std::string(k_black) : fmt::format("{}_beam(wv.z)", k_beam_names[b]);
        };
        text += fmt::format(
            "// The share for R, G, B of the light from the mirror direction that is reflected unscattered.\n"
            "Vec3 mirror_beam(Vec3 wv) {{\n"
            "    if (wv.z > Real(0.0)) return {};\n    return {};\n}}\n",
            side(0), side(1));
    }
    return text;
}

/// What the functions of a BSDF call, to be parsed before them.
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

/// Directions to the light on both sides.
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
std::string printed(const std::string& name, Program program, const std::string& stubs, const std::string& text,
                    CodeLanguage language) {
    std::map<std::string, std::string> defines, names;
    syntax::parse(stubs, program, defines);
    const std::size_t known = program.functions.size();
    syntax::parse(text, program, defines);
    for (const auto& table : program.tables) names[table.name] = name + "_" + table.name;
    for (const auto& function : program.functions) names[function.name] = name + "_" + function.name;
    names["sample_light"] = name + "_sample", names["light_pdf"] = name + "_pdf";
    syntax::Printer printer(language, std::move(names));
    std::string all;
    for (const auto& table : program.tables) all += printer.text(table) + "\n";
    for (std::size_t i = known; i < program.functions.size(); ++i) all += printer.text(program.functions[i]) + "\n";
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

std::string bsdf_code(const NamedModel& of, const CodeOptions& options) {
    const BsdfModel& bsdf = bsdf_of(of);
    Program program;
    std::string text = value_text(bsdf, options.sampling) + beams_text(bsdf.beam, program);
    if (options.sampling) text += chance_text(bsdf) + sampling_text(bsdf) + density_text(bsdf);
    return printed(of.name, std::move(program), stubs_of(bsdf, options.sampling), text, options.language);
}

std::string beam_code(const std::string& name, const Beams& beams, CodeLanguage language) {
    Program program;
    const std::string text = beams_text(beams, program);
    return printed(name, std::move(program), "", text, language);
}

std::vector<std::string> bsdf_functions(const NamedModel& of, bool sampling) {
    const Beams& beams = bsdf_of(of).beam;
    std::vector<std::string> names{"bsdf"};
    if (!beams[2].empty()) names.push_back("beam");
    if (!beams[0].empty() || !beams[1].empty()) names.push_back("mirror_beam");
    if (sampling) names.insert(names.end(), {"sample", "pdf"});
    for (std::string& name : names) name = of.name + "_" + name;
    return names;
}

}  // namespace srbf
