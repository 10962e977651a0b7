// Fits of BSDFs, part by part.

#include "base/errors.h"
#include "base/files.h"
#include "base/floating_point.h"
#include "brdf/directions.h"
#include "brdf/parts.h"
#include "brdf/values.h"
#include "fit/requests.h"
#include "generated/fit/extra_fits.h"
#include "measured/tables.h"
#include "models/bsdf/bsdf_functions.h"
#include "models/ggx/ggx_kind.h"
#include "srbf/elementary.h"
#include "srbf/fit.h"

namespace SRBF_NAMESPACE {
namespace {

/// Directions of the pairs at which parts are compared with their counterparts.
constexpr int k_compared = 256;
constexpr double k_compared_theta = 80 * k_degree;
/// Angles of incidence of directional-hemispherical sums where a measurement has none [degrees].
constexpr double k_incidences[] = {0, 10, 20, 30, 40, 50, 60, 70, 80};

/// A part as it was measured.
struct Input {
    Evaluate f;  ///< none: nothing
    std::shared_ptr<const Measured> measured;
    const PatchFitter* patch_fit() const { return measured ? patch_fit_of(*measured) : nullptr; }
};
using Inputs = std::array<Input, k_parts>;

/// Values at all pairs of some directions, [1/sr]; NaN counts as 0.
std::vector<Rgb> sampled(const Evaluate& f) {
    const auto directions = fibonacci_directions(k_compared, k_compared_theta);
    std::vector<Rgb> values, row(directions.size());
    for (const Vec3f& w : directions) {
        f(directions, std::vector(directions.size(), w), row);
        for (Rgb& value : row) values.push_back(is_finite(value) ? value : Rgb{});
    }
    return values;
}

/// The energy of the difference of values at these pairs, weighted with both cosines.
double energy_between(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    const auto directions = fibonacci_directions(k_compared, k_compared_theta);
    double energy = 0;
    for (std::size_t v = 0, k = 0; v < directions.size(); ++v)
        for (std::size_t l = 0; l < directions.size(); ++l, ++k)
            energy += cosines(directions[v], directions[l]) * squared_distance(a[k], b[k]);
    return energy;
}
double energy(const std::vector<Rgb>& a) { return energy_between(a, std::vector<Rgb>(a.size())); }

/// True if the model of the front part may be used for the back part.
bool is_same_part(const Input& front, const Input& back, Part part) {
    const auto a = sampled(front.f), b = sampled(is_transmission(part) ? exchanged(back.f) : back.f);
    return energy_between(a, b) <= k_same_part * energy(a);
}

/// A black model, for a part whose counterpart is not black.
Model black() { return {GgxModel{{}, {GgxModel::Lobe{}}}, {}}; }

std::vector<Hemispherical> hemispherical(const Input& input, const Evaluate& fitted, const Beams& beams, Part part) {
    if (const PatchFitter* patch = input.patch_fit()) return patch->hemispherical(*input.measured, fitted, beams, part);
    std::vector<Hemispherical> sums;
    for (const double degrees : k_incidences) {
        const double theta = degrees * k_degree,
                     beam_fraction = double(fraction_at(beams, part, to_float(spherical(theta, 0.0))).g);
        const auto sum = [&](const Evaluate& f) {
            return double(albedo(exchanged(f), theta, k_pi / 2).g) + beam_fraction;
        };
        sums.push_back({theta, 0, sum(input.f), sum(fitted)});
    }
    return sums;
}

Result<FitOutcome> fit_part(const Input& input, Part part, FitRequest request, const ProgressToken& progress) {
    auto* pm = std::get_if<PmRequest>(&request.model);
    if (pm && is_transmission(part) && !pm->form) pm->form = PmForm::extended;
    const auto fit_input = [&] {
        if (input.patch_fit()) return input.patch_fit()->fit(*input.measured, request, progress);
        return input.measured ? srbf::fit(*input.measured, request, progress) : srbf::fit(input.f, request, progress);
    };
    auto fitted = fit_input();
    if (fitted) return fitted;
    Error error = fitted.error();
    error.what = std::string(name(part)) + ": " + error.what;
    return error;
}

/// Fits the parts that are neither black nor like their counterparts, and puts their models into `model`.
Result<std::vector<PartFit>> fit_parts(const Inputs& inputs, BsdfModel& model, const FitRequest& request,
                                       const ProgressToken& progress) {
    std::array<bool, k_parts> is_black;
    for (std::size_t p = 0; p < k_parts; ++p) is_black[p] = !inputs[p].f || !(energy(sampled(inputs[p].f)) > 0);
    std::vector<PartFit> parts;
    for (std::size_t p = 0; p < k_parts; ++p) {
        if (!inputs[p].f) continue;
        const Part part = Part(p);
        const auto other = std::size_t(counterpart(part));
        PartFit& fit = parts.emplace_back();
        fit.part = part;
        fit.black = is_black[p];
        if (fit.black) {
            if (!is_black[other]) model.part[p] = std::make_shared<const Model>(black());  // otherwise none is stored
        } else if (is_back(part) && model.part[other] && is_same_part(inputs[other], inputs[p], part)) {
            fit.answered_by = counterpart(part);
        } else {
            auto fitted =
                fit_part(inputs[p], part, request, progress.subrange(double(p) / k_parts, double(p + 1) / k_parts));
            if (!fitted) return fitted.error();
            fit.outcome = *std::move(fitted);
            model.part[p] = std::make_shared<const Model>(Model{fit.outcome.model.model, {}});
        }
    }
    return parts;
}

/// Compares a part with the model's values for it.
void measure(PartFit& fit, const Input& input, const BsdfModel& bsdf) {
    const PartSource<Model> used = part_source(bsdf.part, fit.part);
    const Evaluate fitted = [&](auto wl, auto wv, auto f) {
        if (!used.brdf)
            std::ranges::fill(f, Rgb{});
        else if (used.is_exchanged)
            evaluate(*used.brdf, wv, wl, f);
        else
            evaluate(*used.brdf, wl, wv, f);
    };
    fit.hemispherical = hemispherical(input, fitted, bsdf.beam, fit.part);
    if (const PatchFitter* patch = input.patch_fit()) {
        fit.squared_error_ratio = patch->error_ratio(*input.measured, fitted);
    } else if (!fit.black) {
        const auto a = sampled(input.f);
        fit.squared_error_ratio = energy_between(a, sampled(fitted)) / energy(a);
    }
}

/// True if the sums have several azimuths of incidence.
bool has_several_azimuths(const std::vector<Hemispherical>& sums) {
    return std::ranges::any_of(sums, [](const Hemispherical& sum) { return sum.phi != 0; });
}

/// The largest sums of reflection and transmission of light from one side.
void add_largest_sums(BsdfOutcome& outcome) {
    for (const PartFit& a : outcome.parts)
        for (const PartFit& b : outcome.parts) {
            if (is_transmission(a.part) || !is_transmission(b.part) || is_back(a.part) != is_back(b.part)) continue;
            const bool has_one_azimuth = has_several_azimuths(a.hemispherical) != has_several_azimuths(b.hemispherical);
            for (const Hemispherical& r : a.hemispherical)
                for (const Hemispherical& t : b.hemispherical) {
                    if (r.theta != t.theta || (r.phi != t.phi && !has_one_azimuth)) continue;
                    outcome.max_measured = std::max(outcome.max_measured, r.measured + t.measured);
                    outcome.max_fitted = std::max(outcome.max_fitted, r.fitted + t.fitted);
                }
        }
}

Result<BsdfOutcome> fit_inputs(const Inputs& inputs, const Beams& beams, const FitRequest& request,
                               const ProgressToken& progress) {
    if (std::holds_alternative<OpenPbrRequest>(request.model))
        return argument_error("fit", "model", "pm, su or ggx, since a surface of OpenPBR scatters light to one side",
                              "openpbr");
    const StandardArithmetic mode;
    const auto start = std::chrono::steady_clock::now();
    BsdfModel model;
    model.beam = beams;
    auto parts = fit_parts(inputs, model, request, progress);
    if (!parts) return parts.error();
    for (const std::size_t p : {0, 1})  // a reflection that has f of the other side, but not its beam
        if (inputs[p].f && !model.part[p] && beams[p].empty() && !beams[1 - p].empty()) model.beam[p] = {{0}, {Rgb{}}};
    // Beams are rounded as they are stored.
    auto stored = read_model(write_model({std::move(model), {}}), "fit");
    if (!stored) return stored.error();
    BsdfOutcome outcome{*std::move(stored), *std::move(parts), seconds_since(start), 0, 0};
    for (PartFit& fit : outcome.parts)
        measure(fit, inputs[std::size_t(fit.part)], std::get<BsdfModel>(outcome.model.model));
    add_largest_sums(outcome);
    auto& provenance = outcome.model.provenance;
    provenance["generator"] = "srbf " SRBF_VERSION;
    provenance["seed"] = fmt::format("{}", request.seed);
    for (const PartFit& part : outcome.parts)
        provenance[fmt::format("error_ratio_of_{}", name(part.part))] = fmt::format("{:.4g}", part.squared_error_ratio);
    return outcome;
}

}  // namespace

const PatchFitter* patch_fit_of(const Measured& part) {
    for (const std::span<const PatchFitter> fits : k_extra_fits)
        for (const PatchFitter& fit : fits)
            if (fit.is_of(part)) return &fit;
    return nullptr;
}

void end_mirrors(Beams& beams, const std::array<Evaluate, k_parts>& parts) {
    for (const std::size_t p : {0, 1}) {
        Beam& mirror = beams[p];
        if (mirror.empty() || mirror.theta.back() == float(k_pi / 2) || mirror.fraction.back() == Rgb{}) continue;
        Rgb end{1, 1, 1};
        for (const std::size_t part : {p, parts[2 + p] ? 2 + p : 3 - p}) {
            if (!parts[part]) continue;
            const Rgb scattered = albedo(exchanged(parts[part]), double(mirror.theta.back()), k_pi / 2);
            for (int c = 0; c < 3; ++c) end[c] = std::clamp(end[c] - scattered[c], 0.f, 1.f);
        }
        mirror.theta.push_back(float(k_pi / 2));
        mirror.fraction.push_back(end);
        if (!mirror.azimuths.empty()) mirror.azimuths.push_back(1);
    }
}

Result<BsdfOutcome> fit_bsdf(const Measured& measured, const FitRequest& request, const ProgressToken& progress) {
    const auto* table = std::get_if<BsdfTable>(&measured.table);
    if (!table) return argument_error("fit", "measurement", "reflection and transmission", "a BRDF");
    Inputs inputs;
    Beams beams = table->band().beam;
    for (std::size_t p = 0; p < k_parts; ++p) {
        const auto& part = table->band().part[p];
        if (!part) continue;
        inputs[p] = {evaluator(*part), part};
        const auto* evaluated = std::get_if<EvaluatedTable>(&part->table);
        const bool has_beam = evaluated && evaluated->functions && evaluated->functions->separated_beam;
        if (auto separated = has_beam ? evaluated->functions->separated_beam() : std::nullopt) {
            inputs[p] = {std::move(separated->rest), nullptr};
            beams[p] = std::move(separated->beam);
        }
    }
    end_mirrors(beams, {inputs[0].f, inputs[1].f, inputs[2].f, inputs[3].f});
    unite_transmissions(beams);
    try {
        auto outcome = fit_inputs(inputs, beams, request, progress);
        if (!outcome) return with_source(outcome.error(), measured);
        name_source(outcome->model, measured);
        if (const auto& band = table->band().name; !band.empty()) outcome->model.provenance["band"] = band;
        return outcome;
    } catch (const std::bad_alloc&) {
        return out_of_memory_error(measured.source);
    }
}

Result<BsdfOutcome> fit_bsdf(const std::array<Evaluate, k_parts>& parts, const FitRequest& request,
                             const ProgressToken& progress) {
    Inputs inputs;
    for (std::size_t p = 0; p < k_parts; ++p) inputs[p].f = parts[p];
    return fit_inputs(inputs, {}, request, progress);
}

}  // namespace
