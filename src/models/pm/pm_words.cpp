// Descriptions of a multivariate model for programs and people.

#include <cmath>
#include <set>

#include "base/half.h"
#include "brdf/info_rows.h"
#include "models/kind/parameters.h"
#include "models/pm/pm_functions.h"
#include "models/pm/pm_kind.h"
#include "srbf/elementary.h"
#include "srbf/model.h"

namespace SRBF_NAMESPACE {
namespace {

/// Lists the factors of a lobe other than its variates.
void add_terms(std::string& text, std::span<const ExponentTerm> terms) {
    if (terms.empty()) return;
    text += "  A lobe is also multiplied by";
    for (const ExponentTerm& term : terms) fmt::format_to(std::back_inserter(text), " {}", term.factor);
    for (const ExponentTerm& term : terms)
        if (!term.definition.empty()) fmt::format_to(std::back_inserter(text), ",\n  {}", term.definition);
    text += ".\n";
}

/// Adds a table of the lobes, one per row.
void add_table(std::string& text, const PmModel& model) {
    fmt::format_to(std::back_inserter(text), "\n  {:>4}  {:>31}  {:>10}", "lobe", "coefficient R, G, B", "log scale");
    for (int n = 0; n < model.variates; ++n)
        fmt::format_to(std::back_inserter(text), "  {:>{}}", fmt::format("λ{}", n + 1), model.axial ? 10 : 26);
    const std::span<const ExponentTerm> terms = std::span(k_terms).first(row_of(model.form).terms);
    for (const ExponentTerm& term : terms) fmt::format_to(std::back_inserter(text), "  {:>9}", term.symbol);
    fmt::format_to(std::back_inserter(text), "\n");
    for (int j = 0; j < model.lobes; ++j) {
        const Rgb beta = model.coefficient[std::size_t(j)];
        fmt::format_to(std::back_inserter(text), "  {:>4}  {:>9.4g}  {:>9.4g}  {:>9.4g}  {:>10.4g}", j + 1, beta.r,
                       beta.g, beta.b, model.log_scale[std::size_t(j)]);
        for (int n = 0; n < model.variates; ++n) {
            const auto i = std::size_t(j * model.variates + n);
            const Vec3f xi = model.centre[i];
            if (model.axial)
                fmt::format_to(std::back_inserter(text), "  {:>10.5g}",
                               xi.z < 0 ? -model.bandwidth[i] : model.bandwidth[i]);
            else
                fmt::format_to(std::back_inserter(text), "  {:>26}",
                               fmt::format("{:.4g} at ({:.2f}, {:.2f}, {:.2f})", model.bandwidth[i], xi.x, xi.y, xi.z));
        }
        for (int k = 0; k < features(model.form); ++k)
            fmt::format_to(std::back_inserter(text), "  {:>9.4g}",
                           model.exponent[std::size_t(j * features(model.form) + k)]);
        fmt::format_to(std::back_inserter(text), "\n");
    }
    if (model.axial) fmt::format_to(std::back_inserter(text), "  A bandwidth λ below 0 is that of a lobe about -z.\n");
    add_terms(text, terms);
}

/// The form that is named, or the first one with as many terms as there are exponents. Refuses `exponent` if there is
/// no such form.
PmForm form_of(ParameterReader& reader) {
    std::set<std::size_t> known;
    std::vector<std::string_view> names;  // the forms with this number of terms
    for (const FormRow& row : k_form_rows) {
        known.insert(row.terms);
        if (row.terms == reader.length('F')) names.push_back(row.name);
    }
    if (!names.empty()) return *form_named(reader.word("form", names, names[0]));
    reader.refuse("exponent", fmt::format("shape [J, F], F one of {}", fmt::join(known, ", ")),
                  fmt::format("F = {}", reader.length('F')));
    return {};
}

/// Compensates in the coefficients for the rounding of log scales.
void round_log_scales(PmModel& model, std::vector<float>& coefficient) {
    const std::size_t channels = coefficient.size() / std::max<std::size_t>(model.log_scale.size(), 1);
    for (std::size_t i = 0; i < coefficient.size(); ++i) {
        const float s = std::clamp(model.log_scale[i / channels], -k_half_max, k_half_max);
        coefficient[i] *= elementary::exp(s - from_half(to_half(s)));
    }
}

}  // namespace

std::string Kind<PmModel>::summary(const PmModel& model) {
    return fmt::format("pm, form {}, {} lobes, {} variates, {}{}", srbf::name(model.form), model.lobes, model.variates,
                       model.axial ? "axial" : "general",
                       model.wavelength.empty() ? "" : fmt::format(", {} wavelengths", model.wavelength.size()));
}

void Kind<PmModel>::add_rows(std::string& text, const PmModel& model) {
    add_row(text, "model",
            fmt::format("pm: parameterized multivariate SRBFs, form {}, {} centres", srbf::name(model.form),
                        model.axial ? "axial" : "general"));
    add_row(text, "size",
            fmt::format("{} lobes × {} variates, {} bytes", model.lobes, model.variates, payload_bytes(model)));
    if (!model.wavelength.empty()) add_row(text, "wavelengths", wavelengths_text(model.wavelength));
    for (int n = 0; n < model.variates; ++n) {
        const Parameterization p = model.parameterization[std::size_t(n)];
        add_row(text, fmt::format("ψ{}", n + 1), fmt::format("normalize({:.5g} wl + {:.5g} wv)", p.a, p.b));
    }
    add_table(text, model);
    if (is_reciprocal(model.form)) text += "  f is the mean of this sum and of the same with wl and wv exchanged.\n";
}

Parameters Kind<PmModel>::members(const PmModel& model) {
    return {{"form", std::string(stored_name(model.form))},
            {"lobes", model.lobes},
            {"variates", model.variates},
            {"axial", model.axial},
            {"reciprocal", is_reciprocal(model)}};
}

Parameters Kind<PmModel>::parameters(const PmModel& model) {
    const auto J = std::size_t(model.lobes), N = std::size_t(model.variates), C = model.wavelength.size();
    Parameters parameters{{"form", std::string(srbf::name(model.form))},
                          {"axial", model.axial},
                          {"coefficient", array_of({J, 3}, model.coefficient)},
                          {"log_scale", array_of({J}, model.log_scale)},
                          {"centre", array_of({J, N, 3}, model.centre)},
                          {"bandwidth", array_of({J, N}, model.bandwidth)},
                          {"parameterization", array_of({N, 2}, model.parameterization)},
                          {"exponent", array_of({J, std::size_t(features(model.form))}, model.exponent)}};
    if (C > 0) parameters.push_back({"wavelength", array_of({C}, model.wavelength)});
    if (C > 0) parameters.push_back({"spectrum", array_of({J, C}, model.spectrum)});
    return parameters;
}

bool Kind<PmModel>::matches(const ParameterReader& reader) { return reader.has("parameterization"); }

PmModel Kind<PmModel>::from_parameters(ParameterReader& reader) {
    PmModel model;
    model.bandwidth = reader.numbers("bandwidth", "JN");
    model.parameterization = reader.vectors<Parameterization>("parameterization", "N2");
    const std::size_t J = reader.length('J'), N = reader.length('N');
    model.lobes = int(J), model.variates = int(N);
    const bool is_spectral = reader.has("spectrum");
    std::vector<float> coefficient;
    if (!is_spectral || reader.has("coefficient")) coefficient = reader.numbers("coefficient", "J3");
    model.log_scale = reader.has("log_scale") ? reader.numbers("log_scale", "J") : std::vector<float>(J);
    model.centre = reader.has("centre") ? reader.units("centre", "JN3") : std::vector<Vec3f>(J * N, {0, 0, 1});
    if (reader.has("exponent")) model.exponent = reader.numbers("exponent", "JF");
    if (is_spectral)
        model.wavelength = reader.numbers("wavelength", "C"), coefficient = reader.numbers("spectrum", "JC");
    model.form = form_of(reader);
    const bool is_along_z = std::ranges::all_of(model.centre, [](const Vec3f& xi) { return std::abs(xi.z) == 1; });
    model.axial = reader.flag("axial", is_along_z);
    if (model.axial && !is_along_z) reader.refuse("centre", "(0, 0, 1) or (0, 0, -1) of an axial model", "");
    if (reader.error()) return model;
    round_log_scales(model, coefficient);
    if (is_spectral)
        model.spectrum = std::move(coefficient);
    else
        model.coefficient = split_rows<Rgb>(coefficient);
    return model;
}

std::string Kind<PmModel>::formula_text(const PmModel&, const NumberText&) {
    return "    return pm_value(pm, wl, wv);\n";
}

}  // namespace
