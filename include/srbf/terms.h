// The terms that a lobe's exponent has beside its Gaussian SRBFs, and the forms made of them: level 3.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace srbf {

/// Term κ_jk x_k(wl, wv) of the exponent of lobe j. The feature x_k is line k of kernel.glsl's pm_further_features.
struct ExponentTerm {
    std::string_view symbol;      ///< of κ_jk, in print
    std::string_view factor;      ///< e^{κ_jk x_k}, in print
    std::string_view definition;  ///< of a symbol in the factor, in print; may be empty
    double least, most;           ///< bounds of κ_jk in a fit; where `least` is 0, κ_jk ≥ 0 in files too
    bool is_slope;                ///< a fit to samples ε [rad] apart bounds |κ_jk| by 1/ε, too
    bool is_sharp;  ///< κ_jk starts as a bandwidth does: 0, 0.3 to 6e4 or -100 to -0.3; else 0, ±0.1 to ±10
};
inline constexpr std::array<ExponentTerm, 4> k_terms{{
    {"κ", "(cosθl cosθv)^κ", "", 0, 64, false, false},
    {"μ", "e^(μ(l·h - 1))", "", -1000, 1000, true, false},
    {"γ", "e^(-γδ)", "δ = √((cosθl - cosθv)² + sin²θh/16 + 1/400) - 1/20", -1000, 1000, true, false},
    {"σ", "e^(-σ sinθh)", "", -1000, 65504, true, true},
}};

/// What a lobe of a multivariate model is made of; the numbers of 16 bits are for J lobes of N variates.
enum class PmForm {
    gaussian,  ///< Gaussian SRBFs alone, as Tsai 2009 defines them: axial J(3+N)+2N, general J(3+3N)+2N
    horizon,   ///< and (cosθl cosθv)^κ, κ ≥ 0, always with a log scale: axial J(3+N+2)+2N
    extended,  ///< and e^{μ(l·h−1) − γδ − σ sinθh}, δ as in `k_terms`: axial J(3+N+5)+2N
};
/// A form has the first terms of the table.
struct FormRow {
    PmForm form;
    std::string_view name;
    std::string_view stored;  ///< its name in model files and reports
    std::size_t terms;
    std::string_view summary;  ///< what it adds to the form before it, in ASCII
};
inline constexpr std::array<FormRow, 3> k_form_rows{{
    {PmForm::gaussian, "gaussian", "source", 0, "as Tsai 2009 defines them"},
    {PmForm::horizon, "horizon", "horizon", 1, "and an exponent of cos(theta_l) cos(theta_v)"},
    {PmForm::extended, "extended", "extended", 4, "and three more"},
}};
inline constexpr auto k_forms = [] {
    std::array<PmForm, k_form_rows.size()> forms{};
    for (std::size_t i = 0; i < forms.size(); ++i) forms[i] = k_form_rows[i].form;
    return forms;
}();
constexpr const FormRow& row_of(PmForm form) { return k_form_rows[std::size_t(form)]; }
static_assert([] {
    for (std::size_t i = 0; i < k_form_rows.size(); ++i)
        if (std::size_t(k_form_rows[i].form) != i || k_form_rows[i].terms > k_terms.size()) return false;
    return k_form_rows.back().terms == k_terms.size();
}());

/// F: how many exponents a lobe of that form has beside its bandwidths.
constexpr int features(PmForm form) { return int(row_of(form).terms); }
constexpr std::string_view name(PmForm form) { return row_of(form).name; }
constexpr std::string_view stored_name(PmForm form) { return row_of(form).stored; }
/// By either name.
constexpr std::optional<PmForm> form_named(std::string_view text) {
    for (const FormRow& row : k_form_rows)
        if (row.name == text || row.stored == text) return row.form;
    return std::nullopt;
}

}  // namespace srbf
