#include "extras/report/plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "brdf/directions.h"

namespace SRBF_NAMESPACE {
namespace {

/// A list of fits without duplicates. The last fit that is given a role has it.
struct Plan {
    int threads;
    std::vector<FitPlan> fits;

    void pm(PmForm form, int lobes, int variates, Objective objective, std::string role = {}) {
        PmRequest pm;
        pm.form = form, pm.variates = variates, pm.size = LobeCount{lobes};
        add(pm, objective, fmt::format("pm-{}-{}x{}-{}", stored_name(form), lobes, variates, name(objective)),
            std::move(role));
    }
    void su(int lobes, Objective objective, std::string role = {}, SuRequest su = {}) {
        const bool is_plain = su.interpolation == SuInterpolation::plain;
        su.lobes = lobes;
        add(su, objective, fmt::format("su-{}-{}{}", lobes, name(objective), is_plain ? "-plain" : ""),
            std::move(role));
    }
    void ggx(int lobes, Objective objective, std::string role = {}) {
        add(GgxRequest{lobes}, objective, fmt::format("ggx-{}-{}", lobes, name(objective)), std::move(role));
    }
    void openpbr(Objective objective) {
        add(OpenPbrRequest{}, objective, fmt::format("openpbr-{}", name(objective)), {});
    }

    void add(decltype(FitRequest::model) model, Objective objective, std::string id, std::string role) {
        FitRequest request;
        request.model = std::move(model);
        request.objective = objective;
        request.threads = threads;
        for (FitPlan& other : fits)
            if (!role.empty() && other.role == role) other.role.clear();
        const auto existing = std::ranges::find(fits, id, &FitPlan::id);
        if (existing == fits.end())
            fits.push_back({request, std::move(id), std::move(role)});
        else if (!role.empty())
            existing->role = std::move(role);
    }
};

void plan_table(Plan& plan, bool quick) {
    using enum Objective;
    // The fits that are drawn, the size in Tsai 2009, and other sizes and objectives.
    for (const int lobes : {6, 8, 12}) plan.pm(PmForm::extended, lobes, 4, appearance, lobes == 8 ? "pm" : "");
    plan.pm(PmForm::extended, 8, 4, cosine, "pm2");
    plan.su(5, appearance, "su");
    plan.ggx(1, appearance);
    plan.ggx(2, appearance, "ggx");
    plan.openpbr(appearance);
    plan.pm(PmForm::gaussian, 6, 3, raw);
    plan.su(5, raw);
    for (const int lobes : {2, 4, 8}) plan.pm(PmForm::extended, lobes, 4, raw);
    if (quick) return;
    for (const Objective objective : {raw, cosine}) {
        // The plots of error over the number of lobes need these.
        for (const int lobes : {1, 2, 3, 4, 6, 8, 12, 16})
            for (const PmForm form : {PmForm::gaussian, PmForm::extended})
                for (const int variates : {2, 3, 4})
                    if (variates == 4 || objective == raw) plan.pm(form, lobes, variates, objective);
        for (int lobes = 1; lobes <= 8; ++lobes) plan.su(lobes, objective);
        for (const int lobes : {1, 2}) plan.ggx(lobes, objective);
    }
    plan.pm(PmForm::extended, 8, 4, cube_root);
    plan.su(5, cube_root);
    // Tsai 2009 takes the nearest sampled views from an index texture.
    plan.su(5, raw, {}, {.interpolation = SuInterpolation::plain, .index = DirectionMap::cube});
}

void plan_samples(Plan& plan, bool quick) {
    using enum Objective;
    plan.pm(PmForm::extended, 8, 4, appearance, "pm");
    plan.pm(PmForm::extended, 8, 4, cosine, "pm2");
    plan.ggx(1, cube_root);
    plan.ggx(2, cube_root, "ggx");
    plan.pm(PmForm::gaussian, 8, 4, raw);  // size of Krylon Blue in Tsai 2009
    plan.su(4, raw, "su");                 // size of Krylon Blue in Tsai 2009
    if (quick) return;
    plan.su(4, appearance, "su");
    plan.openpbr(appearance);
    for (const Objective objective : {raw, appearance})
        for (const int lobes : {1, 2}) plan.ggx(lobes, objective, objective == appearance && lobes == 2 ? "ggx" : "");
    for (const Objective objective : {raw, cube_root}) {
        for (const int lobes : {1, 2, 3, 4, 6, 8, 12})
            for (const PmForm form : {PmForm::gaussian, PmForm::extended}) plan.pm(form, lobes, 4, objective);
        for (const int lobes : {2, 4, 8}) plan.su(lobes, objective);
    }
}

/// Scans of an instrument, fitted with the objectives relative and appearance by reciprocal models, from which few
/// incidences can be left out.
void plan_scans(Plan& plan, bool quick) {
    using enum Objective;
    for (const int lobes : {3, 6, 9}) plan.pm(PmForm::reciprocal, lobes, 2, relative, lobes == 6 ? "pm" : "");
    plan.pm(PmForm::extended, 8, 4, appearance, "pm2");
    plan.ggx(1, relative);
    plan.ggx(2, relative, "ggx");
    if (quick) return;
    for (const int lobes : {2, 4, 12}) plan.pm(PmForm::reciprocal, lobes, 2, relative);
    for (const Objective objective : {raw, cube_root, appearance}) plan.ggx(2, objective);
}

void plan_least(Plan& plan) {
    plan.pm(PmForm::gaussian, 2, 2, Objective::raw, "pm");
    plan.su(1, Objective::raw, "su", {.directions = 16});
    plan.ggx(1, Objective::cosine, "ggx");
}

/// True if all samples are in the plane of incidence.
bool are_scans(const Measured& measured) {
    const auto* samples = std::get_if<ScatteredSamples>(&measured.table);
    for (std::size_t i = 0; samples != nullptr && i < samples->wl.size(); ++i)
        if (!is_in_plane(samples->wl[i], samples->wv[i])) return false;
    return samples != nullptr;
}

}  // namespace

std::string_view name(Sweep sweep) {
    return sweep == Sweep::whole ? "whole" : sweep == Sweep::quick ? "quick" : "least";
}

std::vector<FitPlan> plan(const Measured& measured, Sweep sweep, int threads) {
    Plan fits_to_make{threads, {}};
    if (sweep == Sweep::least)
        plan_least(fits_to_make);
    else if (are_scans(measured))
        plan_scans(fits_to_make, sweep == Sweep::quick);
    else if (std::holds_alternative<ScatteredSamples>(measured.table))
        plan_samples(fits_to_make, sweep == Sweep::quick);
    else
        plan_table(fits_to_make, sweep == Sweep::quick);
    return std::move(fits_to_make.fits);
}

}  // namespace
