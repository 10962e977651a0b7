// Models as functions of Radiance's expression language, `.cal`.

#include <algorithm>
#include <array>

#include "base/errors.h"
#include "brdf/parts.h"
#include "code/added_code.h"
#include "code/defined_names.h"
#include "models/kind/parameters.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

namespace {

constexpr const char* k_pair = "lx,ly,lz,vx,vy,vz";
constexpr const char* k_cal_channels = "rgb";

/// A number as a factor or a summand.
std::string cal_number(double x) { return x < 0 ? fmt::format("({:.9g})", x) : fmt::format("{:.9g}", x); }

/// The exponent of lobe j, in natural logarithm: Σ_n λ (ψ_n·ξ − 1) + log scale + Σ_k κ_k x_k, functions of kernel.glsl.
std::string cal_exponent(const std::string& name, const PmModel& model, int j) {
    std::string sum = cal_number(double(model.log_scale[std::size_t(j)]));
    for (int n = 0; n < model.variates; ++n) {
        const auto i = std::size_t(j * model.variates + n);
        const Vec3f xi = model.centre[i];
        const Parameterization p = model.parameterization[std::size_t(n)];
        const auto dot_centre = [&](char w) {
            return fmt::format("({}*{}x+{}*{}y+{}*{}z)", cal_number(double(xi.x)), w, cal_number(double(xi.y)), w,
                               cal_number(double(xi.z)), w);
        };
        sum += fmt::format("\n    +{}*(({}*{}+{}*{})*{}_n{}(lx*vx+ly*vy+lz*vz)-1)",
                           cal_number(double(model.bandwidth[i])), cal_number(double(p.a)), dot_centre('l'),
                           cal_number(double(p.b)), dot_centre('v'), name, n + 1);
    }
    for (int k = 0; k < features(model.form); ++k)
        sum += fmt::format("\n    +{}*{}_x{}({})",
                           cal_number(double(model.exponent[std::size_t(j * features(model.form) + k)])), name, k + 1,
                           k_pair);
    return sum;
}

/// The functions NAME_r, NAME_g, NAME_b of light and viewer above the horizon.
std::string cal_functions(const std::string& name, const PmModel& model) {
    std::string text;
    for (int n = 0; n < model.variates; ++n) {
        const Parameterization p = model.parameterization[std::size_t(n)];
        const double a = double(p.a), b = double(p.b);
        text +=
            fmt::format("{}_n{}(c)=1/sqrt(if({}+{}*c-1e-12,{}+{}*c,1e-12));\n", name, n + 1, cal_number(a * a + b * b),
                        cal_number(2 * a * b), cal_number(a * a + b * b), cal_number(2 * a * b));
    }
    const std::string feature_texts[] = {
        "log(if(lz*vz-1e-12,lz*vz,1e-12))", fmt::format("0.5*sqrt({}_s({}))-1", name, k_pair),
        fmt::format("0.05-sqrt((lz-vz)*(lz-vz)+0.0625*{0}_a({1})+0.0025)", name, k_pair),
        fmt::format("0-sqrt({}_a({}))", name, k_pair)};
    static_assert(std::size(feature_texts) == std::size(k_terms));
    text += fmt::format("{0}_s({1})=if(2+2*(lx*vx+ly*vy+lz*vz)-1e-12,2+2*(lx*vx+ly*vy+lz*vz),1e-12);\n", name, k_pair);
    text += fmt::format("{0}_a({1})=((lx+vx)*(lx+vx)+(ly+vy)*(ly+vy))/{0}_s({1});\n", name, k_pair);
    for (int k = 0; k < features(model.form); ++k)
        text += fmt::format("{}_x{}({})={};\n", name, k + 1, k_pair, feature_texts[std::size_t(k)]);
    std::array<std::string, 3> sums;
    for (int j = 0; j < model.lobes; ++j) {
        const std::string exponent = cal_exponent(name, model, j);
        if (is_reciprocal(model.form))
            text += fmt::format(
                "{0}_one{1}({2})=exp({3});\n{0}_lobe{1}({2})=0.5*({0}_one{1}({2})+{0}_one{1}(vx,vy,vz,lx,ly,lz));\n",
                name, j + 1, k_pair, exponent);
        else
            text += fmt::format("{}_lobe{}({})=exp({});\n", name, j + 1, k_pair, exponent);
        for (int c = 0; c < 3; ++c)
            sums[std::size_t(c)] +=
                fmt::format("{}{}*{}_lobe{}({})", j ? "\n    +" : "",
                            cal_number(double(model.coefficient[std::size_t(j)][c])), name, j + 1, k_pair);
    }
    for (int c = 0; c < 3; ++c)
        text += fmt::format("{}_{}({})={};\n", name, k_cal_channels[c], k_pair, sums[std::size_t(c)]);
    return text;
}

std::string cal_functions(const std::string& name, const GgxModel& model) {
    std::string text =
        fmt::format("{0}_s({1})=if(2+2*(lx*vx+ly*vy+lz*vz)-1e-12,2+2*(lx*vx+ly*vy+lz*vz),1e-12);\n", name, k_pair);
    text += fmt::format("{0}_w({1})=if(1-0.5*sqrt({0}_s({1})),(1-0.5*sqrt({0}_s({1})))^5,0);\n", name, k_pair);
    std::array<std::string, 3> sums;
    for (int c = 0; c < 3; ++c) sums[std::size_t(c)] = cal_number(double(model.diffuse[c]) / k_pi);
    for (std::size_t i = 0; i < model.lobes.size(); ++i) {
        const GgxModel::Lobe& lobe = model.lobes[i];
        const std::string a2 = cal_number(double(lobe.roughness) * double(lobe.roughness)),
                          rest = cal_number(1 - double(lobe.roughness) * double(lobe.roughness));
        text += fmt::format("{0}_t{1}({2})=((lx+vx)*(lx+vx)+(ly+vy)*(ly+vy)+{3}*(lz+vz)*(lz+vz))/{0}_s({2});\n", name,
                            i + 1, k_pair, a2);
        text += fmt::format(
            "{0}_d{1}({2})={3}/(2*PI*{0}_t{1}({2})*{0}_t{1}({2})*(vz*sqrt({3}+{4}*lz*lz)+lz*sqrt({3}+{4}*vz*vz)));\n",
            name, i + 1, k_pair, a2, rest);
        for (int c = 0; c < 3; ++c)
            sums[std::size_t(c)] += fmt::format("\n    +{0}_d{1}({2})*({3}*(1-{0}_w({2}))+{4}*{0}_w({2}))", name, i + 1,
                                                k_pair, cal_number(double(lobe.f0[c])), cal_number(double(lobe.f90)));
    }
    for (int c = 0; c < 3; ++c)
        text += fmt::format("{}_{}({})={};\n", name, k_cal_channels[c], k_pair, sums[std::size_t(c)]);
    return text;
}

Result<std::string> cal_text(const std::string& name, const BsdfModel& model);
Result<std::string> cal_text(const std::string& name, const Model& model) {
    if (const auto* bsdf = std::get_if<BsdfModel>(&model.model)) return cal_text(name, *bsdf);
    if (const auto* pm = std::get_if<PmModel>(&model.model)) return cal_functions(name, *pm);
    if (const auto* ggx = std::get_if<GgxModel>(&model.model)) return cal_functions(name, *ggx);
    return argument_error(name, "model for Radiance", "one of lobes, or Lambert and GGX",
                          std::string(kind_words(model)));
}

/// The call of a part's channel with Radiance's vectors, whose z has the opposite sign in a BSDF.
std::string cal_call(const std::string& name, const Parts<Model>& parts, Part part, int c) {
    const PartSource<Model> used = part_source(parts, part);
    if (!used.brdf) return "0";
    const Part stored = parts[std::size_t(part)] ? part : counterpart(part);
    // wl = (−ix, iy, |iz|), wv = (−ox, oy, |oz|) in the frame of the part
    const std::string light = "0-ix,iy,if(iz,iz,0-iz)", viewer = "0-ox,oy,if(oz,oz,0-oz)";
    return fmt::format("{}_{}_{}({},{})", name, k_part_names[std::size_t(stored)], k_cal_channels[c],
                       used.is_exchanged ? viewer : light, used.is_exchanged ? light : viewer);
}

Result<std::string> cal_text(const std::string& name, const BsdfModel& model) {
    std::string text;
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (!model.part[p]) continue;
        auto part = cal_text(fmt::format("{}_{}", name, k_part_names[p]), *model.part[p]);
        if (!part) return part.error();
        text += *part;
    }
    for (int c = 0; c < 3; ++c)
        text += fmt::format("{}_{}(ix,iy,iz,ox,oy,oz)=if(iz*oz,\n    if(iz,{},{}),\n    if(iz,{},{}));\n", name,
                            std::string(1, "RGB"[c]), cal_call(name, model.part, Part::reflection_back, c),
                            cal_call(name, model.part, Part::reflection_front, c),
                            cal_call(name, model.part, Part::transmission_back, c),
                            cal_call(name, model.part, Part::transmission_front, c));
    return text;
}

/// Names that Radiance and these functions already use.
constexpr std::string_view k_cal_names[] = {"if",    "select", "rand", "floor", "ceil", "sqrt", "exp",  "log",
                                            "log10", "sin",    "cos",  "tan",   "asin", "acos", "atan", "atan2",
                                            "min",   "max",    "PI",   "lx",    "ly",   "lz",   "vx",   "vy",
                                            "vz",    "ix",     "iy",   "iz",    "ox",   "oy",   "oz"};

/// Adds the names of the functions that begin lines of `text`.
Result<Done> add_functions(std::string_view text, const std::string& owner, DefinedNames& defined) {
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        if (const auto end = line.find('('); !line.starts_with(' ') && end != line.npos)
            if (const auto distinct = defined.add(std::string(line.substr(0, end)), owner); !distinct) return distinct;
        text.remove_prefix(std::min(line.size() + 1, text.size()));
    }
    return Done{};
}

/// The models as functions of Radiance's expression language, the text of a `.cal` file. Each model has the function
/// NAME(ix,iy,iz,ox,oy,oz), the luminance of f [1/sr] for vectors to the light and to the viewer, and NAME_R, NAME_G
/// and NAME_B, its channels. Beams are left out. Positive z is the front of a BRDF. For a BSDF it is the back, with x
/// mirrored, as in WINDOW's XML. Returns an error for a view-by-view model or a surface of OpenPBR.
Result<std::string> radiance_text(std::span<const NamedModel> models, std::string_view, int) {
    std::string text =
        "{ BSDFs by srbf, in 1/sr without the cosine, for bsdf2ttree and other programs of Radiance.\n"
        "NAME(ix,iy,iz, ox,oy,oz) is the luminance, NAME_R, NAME_G and NAME_B are linear sRGB, of unit vectors that "
        "point\n"
        "away from the surface, i to the light and o to the viewer; y is up. A BRDF is that of the side of positive z; "
        "of\n"
        "both sides of a surface positive z is the back, as in the XML of WINDOW. Light that passes unscattered has no "
        "part\n"
        "in it. }\n";
    DefinedNames defined;
    for (const std::string_view reserved : k_cal_names)
        if (std::ranges::find(models, reserved, &NamedModel::name) != models.end())
            return argument_error(std::string(reserved), "name for Radiance", "none of its own", std::string(reserved));
    for (const NamedModel& named : models) {
        const bool is_bsdf = std::holds_alternative<BsdfModel>(named.model->model);
        auto part = cal_text(named.name, *named.model);
        if (!part) return part.error();
        const std::size_t begin = text.size();
        text += *part;
        for (int c = 0; c < 3 && !is_bsdf; ++c)
            text += fmt::format("{0}_{1}(ix,iy,iz,ox,oy,oz)=if(iz,if(oz,{0}_{2}(ix,iy,iz,ox,oy,oz),0),0);\n",
                                named.name, "RGB"[c], k_cal_channels[c]);
        text += fmt::format(
            "{0}(ix,iy,iz,ox,oy,oz)=0.2126*{0}_R(ix,iy,iz,ox,oy,oz)\n    "
            "+0.7152*{0}_G(ix,iy,iz,ox,oy,oz)+0.0722*{0}_B(ix,iy,iz,ox,oy,oz);\n",
            named.name);
        if (const auto distinct = add_functions(std::string_view(text).substr(begin), named.name, defined); !distinct)
            return distinct.error();
    }
    return text;
}

}  // namespace

const CodeExtra& code_of_daylight() {
    static const CodeExtra extra{
        {},
        {{.name = "radiance",
          .summary = "a .cal with functions NAME(ix,iy,iz,ox,oy,oz) of each model, as bsdf2ttree -f takes them",
          .by_part = false,
          .text = radiance_text}},
        [](const CodeOptions&) { return AddedCode{}; }};
    return extra;
}

}  // namespace
