// The terms of a lobe's exponent besides its Gaussian SRBFs, and the forms with these terms.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "srbf/version.h"

SRBF_BEGIN

/// A term κ_jk x_k(wl, wv) of the exponent of lobe j. The feature x_k is line k of `pm_further_features` in
/// kernel.glsl.
struct ExponentTerm {
    std::string_view symbol;      ///< symbol of κ_jk in output
    std::string_view factor;      ///< e^{κ_jk x_k} in output
    std::string_view definition;  ///< definition of a symbol of the factor in output; may be empty
    double min, max;              ///< bounds of κ_jk in a fit; if `min` is 0, κ_jk ≥ 0 in files too
    double min_if_reciprocal;     ///< least κ_jk of a reciprocal form: steeper lobes have ridges beyond θmax
    bool is_slope;                ///< a fit to samples ε [rad] apart also bounds |κ_jk| by 1/ε
    bool is_sharp;                ///< a fit draws initial κ_jk from the wide range of bandwidths
};
inline constexpr std::array<ExponentTerm, 4> k_terms{{
    {"κ", "(cosθl cosθv)^κ", "", 0, 64, 0, false, false},
    {"μ", "e^(μ(l·h - 1))", "", -1000, 1000, -1000, true, false},
    {"γ", "e^(-γδ)", "δ = √((cosθl - cosθv)² + sin²θh/16 + 1/400) - 1/20", -1000, 1000, -64, true, false},
    {"σ", "e^(-σ sinθh)", "", -1000, 65504, -1000, true, true},
}};

/// The factors of a lobe. The sizes are in 16-bit numbers, for J lobes of N variates.
enum class PmForm {
    gaussian,  ///< Gaussian SRBFs alone, as Tsai 2009 defines them: axial J(3+N)+2N, general J(3+3N)+2N
    horizon,  ///< also (cosθl cosθv)^κ, κ ≥ 0, always with a log scale: axial J(3+N+2)+2N; only read, never fitted
    extended,    ///< all terms, always with a log scale: axial J(3+N+5)+2N
    reciprocal,  ///< the mean of an extended sum and of the same with light and viewer exchanged: the same size
};
/// The name of `PmForm::gaussian` in model files and reports, where it is kept for the sake of old ones.
inline constexpr std::string_view k_gaussian_in_files = "source";
/// A form has the first `terms` terms of `k_terms`.
struct FormRow {
    PmForm form;
    std::string_view name;
    std::string_view stored;  ///< the name in model files and reports
    std::size_t terms;
    bool is_reciprocal;        ///< f(ωl, ωv) = f(ωv, ωl)
    int lobes, variates;       ///< J and N of a fit by default
    std::string_view summary;  ///< what it adds to the previous form, in ASCII
};
inline constexpr std::array<FormRow, 4> k_form_rows{{
    {PmForm::gaussian, "gaussian", k_gaussian_in_files, 0, false, 8, 4, "as Tsai 2009 defines them"},
    {PmForm::horizon, "horizon", "horizon", 1, false, 8, 4, "also a power of cos(theta_l) cos(theta_v)"},
    {PmForm::extended, "extended", "extended", 4, false, 8, 4, "also powers of cosines and three further factors"},
    {PmForm::reciprocal, "reciprocal", "reciprocal", 4, true, 9, 3, "also the mean with light and viewer exchanged"},
}};
/// The default form of a fit to a table.
inline constexpr PmForm k_default_form = PmForm::reciprocal;
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

/// True if `fit` offers the form.
constexpr bool is_fitted(PmForm form) { return form != PmForm::horizon; }

/// F: the number of exponents of a lobe of that form besides its bandwidths.
constexpr int features(PmForm form) { return int(row_of(form).terms); }
/// True if light and viewer may be exchanged in models of that form: f(ωl, ωv) = f(ωv, ωl).
constexpr bool is_reciprocal(PmForm form) { return row_of(form).is_reciprocal; }
constexpr std::string_view name(PmForm form) { return row_of(form).name; }
constexpr std::string_view stored_name(PmForm form) { return row_of(form).stored; }
/// The form with this name, the one in text or the stored one.
constexpr std::optional<PmForm> form_named(std::string_view text) {
    for (const FormRow& row : k_form_rows)
        if (row.name == text || row.stored == text) return row.form;
    return std::nullopt;
}

SRBF_END
