#include "srbf/edit.h"

#include <array>
#include <cmath>

#include "base/errors.h"
#include "base/floating_point.h"
#include "base/half.h"
#include "brdf/values.h"
#include "edit/lobes.h"
#include "models/kind/parameters.h"
#include "models/pm/pm_functions.h"
#include "observe/albedo_bound.h"
#include "srbf/metrics.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr int k_lobes_of_coat = 3, k_bounded_azimuths = 5;
/// An edit whose albedo would exceed the limit by this factor is marked as limited.
constexpr double k_min_stated_excess = 1.001;
template <typename... F> struct Cases : F... { using F::operator()...; };

std::string text(const Rgb& colour) { return fmt::format("{:g},{:g},{:g}", colour.r, colour.g, colour.b); }
double min(const Rgb& c) { return double(std::min({c.r, c.g, c.b})); }

Result<Done> validate(const Edit& edit) {
    const auto require = [](const char* what, double found, double low, double high) {
        return require_range("edit", what, found, low, high);
    };
    const auto require_colour = [](const char* what, const Rgb& found, double high) -> Result<Done> {
        if (is_finite(found) && min(found) >= 0 && largest_of(found) <= high) return Done{};
        return argument_error("edit", what, fmt::format("0 to {:g} in each channel", high), text(found));
    };
    return std::visit(
        Cases{[&](const Roughen& roughen) { return require("factor of the roughness", roughen.factor, 0.1, 10); },
              [&](const Tint& tint) {
                  const auto highlight = require_colour("tint of the highlight", tint.highlight, 10);
                  return highlight ? require_colour("tint of the body", tint.body, 10) : highlight;
              },
              [&](const Saturate& saturate) { return require("factor of the saturation", saturate.factor, 0, 4); },
              [&](const TurnHue& turn) { return require("turn of the hue", turn.degrees, -360, 360); },
              [&](const Coat& coat) -> Result<Done> {
                  for (const auto& valid : {require("roughness of the coat", coat.roughness, 0.02, 1),
                                            require("index of refraction of the coat", coat.ior, 1.05, 3)})
                      if (!valid) return valid;
                  return require_colour("tint of the coat", coat.tint, 1);
              },
              [&](const Rotate& rotate) { return require("turn of the tangent", rotate.degrees, -360, 360); },
              [&](const Reduce& reduce) {
                  return require_range("edit", "number of lobes", reduce.lobes, 1, k_max_fitted_lobes);
              }},
        edit);
}

/// The sum of highlight and body as a function, with the highlight widened.
Evaluate apply_roughening(const HighlightAndBody& parts, double factor) {
    const auto highlight = evaluator(parts.highlight);
    Evaluate wide = apply_roughening(highlight, factor, roughness_of(highlight));
    return [wide, body = evaluator(parts.body)](auto wl, auto wv, auto f) {
        std::vector<Rgb> body_values(f.size());
        wide(wl, wv, f), body(wl, wv, body_values);
        for (std::size_t i = 0; i < f.size(); ++i)
            for (int c = 0; c < 3; ++c) f[i][c] += body_values[i][c];
    };
}

/// An edit in progress.
struct Editor {
    const EditOptions& options;
    const AlbedoBound& bound;
    double asked = 0;       ///< the largest albedo that the edit asks for, as a fraction of the limit
    std::string done = {};  ///< the edit that is done instead, if it is another of its kind

    /// Fits lobes to f. The fit begins with the lobes of the model, or with their highlight widened.
    Result<PmModel> fit(const Evaluate& f, const PmModel& model, double factor, int lobes) {
        const PmModel begin[] = {model, widened(model, factor)};
        asked = bound.excess(f);
        return refit(f, begin, options.lobes.value_or(std::min(lobes, k_max_fitted_lobes)), bound.limit(), options);
    }

    Result<PmModel> operator()(const PmModel& model, const Roughen& roughen) {
        if (roughen.factor == 1) return model;
        return fit(apply_roughening(separate_highlight(model), roughen.factor), model, roughen.factor, model.lobes);
    }
    /// The tint, with factors above 1 reduced until the albedo is within the limit up to 75° from the normal. If single
    /// lobes were lowered instead, the hue would change.
    Tint within_limit(const PmModel& model, const Tint& wanted) const {
        if (largest_of(wanted.highlight) <= 1 && largest_of(wanted.body) <= 1) return wanted;
        const HighlightAndBody parts = separate_highlight(model);
        const std::array<Evaluate, 2> f{evaluator(parts.highlight), evaluator(parts.body)};
        const std::array<Rgb, 2> tint{wanted.highlight, wanted.body};
        double fraction = 1;
        const double limit = bound.limit();
        for (const double view : {0.0, 25.0, 45.0, 60.0, 75.0}) {
            const std::array<Rgb, 2> reflected{albedo(f[0], view * k_degree, k_pi / 2),
                                               albedo(f[1], view * k_degree, k_pi / 2)};
            for (int c = 0; c < 3; ++c) {
                double raised = 0, fixed = 0;
                for (std::size_t k = 0; k < 2; ++k)
                    (largest_of(tint[k]) > 1 ? raised : fixed) += double(tint[k][c] * reflected[k][c]);
                if (raised > 0 && fixed + raised > limit)
                    fraction = std::min(fraction, std::max(limit - fixed, 0.0) / raised);
            }
        }
        const auto within = [&](const Rgb& rgb) { return largest_of(rgb) > 1 ? scaled(float(fraction), rgb) : rgb; };
        return {within(wanted.highlight), within(wanted.body)};
    }
    Result<PmModel> operator()(const PmModel& model, const Tint& tint) {
        const Tint within = within_limit(model, tint);
        asked = bound.excess(evaluator(tinted(model, tint)));
        if (within.highlight != tint.highlight || within.body != tint.body) done = text(within);
        return tinted(model, within);
    }
    Result<PmModel> operator()(const PmModel& model, const Saturate& saturate) const {
        return saturated(model, saturate.factor);
    }
    Result<PmModel> operator()(const PmModel& model, const TurnHue& turn) const {
        return turn_hue(model, turn.degrees * k_degree);
    }
    Result<PmModel> operator()(const PmModel& model, const Coat& coat) {
        // Light that passes the interface twice is spread like light from facets of this slope below it.
        const double slope = coat.roughness * (1 - 1 / coat.ior) / std::sqrt(2.0);
        const HighlightAndBody parts = separate_highlight(model);
        const double roughness = roughness_of(evaluator(parts.highlight));
        const double factor = roughness > 0 ? std::min(elementary::hypot(1, slope / roughness), 10.0) : 1;
        return fit(apply_coat(factor > 1 ? apply_roughening(parts, factor) : evaluator(PmModel(model)), coat), model,
                   factor, model.lobes + k_lobes_of_coat);
    }
    Result<PmModel> operator()(const PmModel& model, const Rotate& rotate) const {
        return rotated(model, rotate.degrees * k_degree);
    }
    Result<PmModel> operator()(const PmModel& model, const Reduce& reduce) const {
        return refit(evaluator(model), std::span(&model, 1), reduce.lobes, bound.limit(), options);
    }
};

Result<const PmModel*> require_pm(const Model& model) {
    if (const auto* pm = std::get_if<PmModel>(&model.model)) return pm;
    return argument_error("edit", "model", "a multivariate model", std::string(kind_words(model)));
}

/// True if the edit needs colours, which a spectral model does not have of its own.
bool is_of_colours(const Edit& edit) { return !std::holds_alternative<Rotate>(edit); }

/// The model in 16-bit floats. Returns an error if a coefficient is too large, or so small that its lobe becomes black.
Result<PmModel> in_halves(const PmModel& model, const char* where) {
    PmModel stored = rounded(model);
    for (std::size_t j = 0; j < stored.coefficient.size(); ++j)
        if (const double beta = largest_of(model.coefficient[j]);
            beta > double(k_half_max) || (beta > 0 && largest_of(stored.coefficient[j]) <= 0))
            return half_range_error(where, "coefficient", beta);
    return stored;
}

/// The provenance of a model without the errors of its fit.
std::map<std::string, std::string> origin(const Model& model) {
    std::map<std::string, std::string> kept{{"generator", "srbf " SRBF_VERSION}};
    for (const char* key : {"source", "exchanged", "max_theta", "edits"})
        if (const auto entry = model.provenance.find(key); entry != model.provenance.end()) kept.insert(*entry);
    return kept;
}

std::string described(const Model& model) {
    const auto entry = [&](const char* key) {
        const auto at = model.provenance.find(key);
        return at == model.provenance.end() ? std::string() : at->second;
    };
    const std::string source = entry("source").empty() ? "a model" : entry("source"), edits = entry("edits");
    return edits.empty() ? source : fmt::format("{} ({})", source, edits);
}

}  // namespace

std::string text(const Edit& edit) {
    return std::visit(Cases{[](const Roughen& roughen) { return fmt::format("roughen {:g}", roughen.factor); },
                            [](const Tint& tint) {
                                return fmt::format("tint highlight {}, body {}", text(tint.highlight), text(tint.body));
                            },
                            [](const Saturate& saturate) { return fmt::format("saturate {:g}", saturate.factor); },
                            [](const TurnHue& turn) { return fmt::format("hue {:g}", turn.degrees); },
                            [](const Coat& coat) {
                                return fmt::format("coat of roughness {:g}, ior {:g}, tint {}", coat.roughness,
                                                   coat.ior, text(coat.tint));
                            },
                            [](const Rotate& rotate) { return fmt::format("rotate {:g}", rotate.degrees); },
                            [](const Reduce& reduce) { return fmt::format("reduce to {} lobes", reduce.lobes); }},
                      edit);
}

Result<Model> edit_model(const Model& model, std::span<const Edit> edits, const EditOptions& options) {
    const StandardArithmetic mode;
    const auto pm = require_pm(model);
    if (!pm) return pm.error();
    PmModel now = **pm;
    const int azimuths = now.axial ? 1 : k_bounded_azimuths;
    const double limit = std::max(1.0, AlbedoBound(1, azimuths).excess(evaluator(now)));
    const AlbedoBound bound(limit, azimuths);
    Model result{now, origin(model)};
    std::string& done = result.provenance["edits"];
    const auto add = [](std::string& list, const std::string& item) { list += (list.empty() ? "" : "; ") + item; };
    for (const Edit& edit : edits) {
        if (const auto valid = validate(edit); !valid) return valid.error();
        if (!now.wavelength.empty() && is_of_colours(edit))
            return argument_error("edit", "model", "one of colours", "a spectral one");
        Editor editor{options, bound};
        auto next = std::visit([&](const auto& chosen) { return editor(now, chosen); }, edit);
        if (!next) return next.error();
        if (const double asked = std::max(editor.asked, bound.excess(evaluator(*next))); asked > k_min_stated_excess)
            add(result.provenance["limited"],
                fmt::format("{}, with an albedo of {:.3g}, to {}", text(edit), limit * asked,
                            editor.done.empty() ? fmt::format("an albedo of {:.3g}", limit) : editor.done));
        next = in_halves(limit_albedo(bound, *std::move(next)), "edit");
        if (!next) return next.error();
        now = *std::move(next);
        add(done, text(edit));
    }
    result.model = std::move(now);
    return result;
}

Result<Model> blend_models(const Model& a, const Model& b, double mix) {
    const StandardArithmetic mode;
    if (const auto valid = require_range("blend", "mix", mix, 0.0, 1.0); !valid) return valid.error();
    const auto pm_a = require_pm(a), pm_b = require_pm(b);
    if (!pm_a || !pm_b) return (pm_a ? pm_b : pm_a).error();
    if ((*pm_a)->wavelength != (*pm_b)->wavelength)
        return argument_error("blend", "models", "the same wavelengths, or colours", "different wavelengths");
    PmModel sum = join_lobes(scaled(**pm_a, float(1 - mix)), scaled(**pm_b, float(mix)));
    for (const auto& valid : {require_range("blend", "variates of both", sum.variates, 1, k_max_variates),
                              require_range("blend", "lobes of both", sum.lobes, 1, k_max_lobes)})
        if (!valid) return valid.error();
    auto mixed = in_halves(sum, "blend");
    if (!mixed) return mixed.error();
    return Model{*std::move(mixed),
                 {{"generator", "srbf " SRBF_VERSION},
                  {"edits", fmt::format("{} and {}, mixed at {:g}", described(a), described(b), mix)}}};
}

}  // namespace
