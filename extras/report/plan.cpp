#include "extras/report/plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "brdf/directions.h"

namespace SRBF_NAMESPACE {
namespace {

/// A list of fits without duplicates.
class Plan {
  public:
    explicit Plan(int threads) : threads_(threads) {}

    void pm(PmForm form, int lobes, int variates, Objective objective, std::string role = {}) {
        PmRequest pm;
        pm.form = form, pm.variates = variates, pm.size = LobeCount{lobes};
        add(pm, objective, fmt::format("pm-{}-{}x{}-{}", stored_name(form), lobes, variates, name(objective)),
            std::move(role));
    }
    /// A reciprocal model for scans, from which few incidences can be left out.
    void reciprocal(int lobes, Objective objective, std::string role = {}) {
        PmRequest pm;
        pm.form = PmForm::reciprocal, pm.variates = 2, pm.size = LobeCount{lobes};
        add(pm, objective, fmt::format("pm-reciprocal-{}x2-{}", lobes, name(objective)), std::move(role));
    }
    void su(int lobes, Objective objective, std::string role = {}, int directions = SuRequest{}.directions) {
        SuRequest su;
        su.lobes = lobes, su.directions = directions;
        add(su, objective, fmt::format("su-{}-{}", lobes, name(objective)), std::move(role));
    }
    /// As in Tsai 2009: plain interpolation of the nearest sampled views from an index texture.
    void su_by_texture(int lobes, Objective objective) {
        SuRequest su;
        su.lobes = lobes, su.interpolation = SuInterpolation::plain, su.index = DirectionMap::cube;
        add(su, objective, fmt::format("su-{}-{}-plain", lobes, name(objective)), {});
    }
    void ggx(int lobes, Objective objective, std::string role = {}) {
        add(GgxRequest{lobes}, objective, fmt::format("ggx-{}-{}", lobes, name(objective)), std::move(role));
    }
    /// The parameters of OpenPBR Surface.
    void openpbr(Objective objective) {
        add(OpenPbrRequest{}, objective, fmt::format("openpbr-{}", name(objective)), {});
    }
    std::vector<PlannedFit> fits;

  private:
    void add(decltype(FitRequest::model) model, Objective objective, std::string id, std::string role) {
        FitRequest request;
        request.model = std::move(model), request.objective = objective, request.threads = threads_;
        for (PlannedFit& other : fits)
            if (!role.empty() && other.role == role) other.role.clear();
        const auto existing = std::ranges::find(fits, id, &PlannedFit::id);
        if (existing == fits.end())
            fits.push_back({request, std::move(id), std::move(role)});
        else if (!role.empty())
            existing->role = std::move(role);
    }
    int threads_;
};

void plan_table(Plan& plan, bool quick) {
    using enum Objective;
    // The fits that are drawn, the size in Tsai 2009, and sizes and objectives besides the default.
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
        plan.pm(PmForm::gaussian, 8, 4, objective);
        plan.pm(PmForm::extended, 6, 4, objective);
        plan.pm(PmForm::extended, 8, 4, objective);
        plan.su(5, objective);
        plan.ggx(1, objective);
        plan.ggx(2, objective);
    }
    plan.pm(PmForm::extended, 8, 4, cube_root);
    plan.su_by_texture(5, raw);
    // For the plots of error over the number of lobes.
    for (const int lobes : {1, 2, 3, 4, 6, 8, 12, 16})
        for (const PmForm form : {PmForm::gaussian, PmForm::extended, PmForm::reciprocal}) {
            for (const int variates : {2, 3, 4}) plan.pm(form, lobes, variates, raw);
            plan.pm(form, lobes, 4, cosine);
        }
    for (int lobes = 1; lobes <= 8; ++lobes) plan.su(lobes, raw), plan.su(lobes, cosine);
    plan.su(5, cube_root);
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
    plan.su(4, cube_root);
    plan.su(4, appearance, "su");
    plan.openpbr(appearance);
    for (const Objective objective : {raw, appearance}) {
        plan.ggx(1, objective);
        plan.ggx(2, objective, objective == appearance ? "ggx" : "");
    }
    for (const Objective objective : {raw, cube_root}) {
        for (const int lobes : {1, 2, 3, 4, 6, 8, 12}) {
            plan.pm(PmForm::gaussian, lobes, 4, objective);
            plan.pm(PmForm::extended, lobes, 4, objective);
        }
        for (const int lobes : {2, 4, 8}) plan.su(lobes, objective);
    }
}

/// Scans of an instrument, fitted with the objectives relative and appearance.
void plan_scans(Plan& plan, bool quick) {
    using enum Objective;
    for (const int lobes : {3, 6, 9}) plan.reciprocal(lobes, relative, lobes == 6 ? "pm" : "");
    plan.pm(PmForm::extended, 8, 4, appearance, "pm2");
    plan.ggx(1, relative);
    plan.ggx(2, relative, "ggx");
    if (quick) return;
    for (const int lobes : {2, 4, 12}) plan.reciprocal(lobes, relative);
    for (const Objective objective : {raw, cube_root, appearance}) plan.ggx(2, objective);
}

void plan_least(Plan& plan) {
    plan.pm(PmForm::gaussian, 2, 2, Objective::raw, "pm");
    plan.su(1, Objective::raw, "su", 16);
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

std::vector<PlannedFit> plan(const Measured& measured, Sweep sweep, int threads) {
    Plan fits_to_make(threads);
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

}  // namespace srbf
