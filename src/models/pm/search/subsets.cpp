#include "models/pm/search/subsets.h"

#include <set>

#include "base/parallel.h"
#include "models/pm/solve/rounding.h"
#include "observe/excess.h"
#include "observe/observations.h"
#include "observe/pair_weights.h"
#include "observe/pairs.h"

namespace SRBF_NAMESPACE {
namespace {

/// Maximum number of exceeded bound pairs that are added for each candidate.
constexpr std::size_t k_max_added = 16;

/// At most `max` elements of `indices`, uniformly spaced.
std::vector<std::size_t> thin_out(const std::vector<std::size_t>& indices, std::size_t max) {
    if (indices.size() <= max) return indices;
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < max; ++k) kept.push_back(indices[k * indices.size() / max]);
    return kept;
}

}  // namespace

Subsets::Subsets(const Observations& observations, std::size_t search_pairs)
    : all_(observations),
      search_(first_pairs_of(observations.f.size() < k_polish_pairs ? k_selection_pairs : search_pairs)),
      selection_(first_pairs_of(k_selection_pairs)),
      polish_(first_pairs_of(k_polish_pairs)),
      largest_(largest_measured(observations)) {
    selection_.observations.views = observations.views;
}

Subsets::Subset Subsets::first_pairs_of(std::size_t pairs) const {
    Observations part = first_pairs(all_, pairs);
    part.wavelengths.clear(), part.spectrum.clear();
    part.integrals = all_.integrals;
    const std::size_t begin = part.f.size();
    return {std::move(part), begin};
}

void Subsets::add_exceeded_pairs(const std::vector<Candidate>& candidates, const LobeShape& shape) {
    const PackedObservations selection_rows(selection_.observations), polish_rows(polish_.observations);
    std::vector<std::vector<std::size_t>> added(candidates.size());
    std::vector<double> loss(candidates.size());
    parallel_for(candidates.size(), [&](std::size_t i) {
        const Lobes& lobes = candidates[i].lobes;
        LobeProblem selection(selection_rows, shape, false), polish(polish_rows, shape, false);
        selection.loss(pack(lobes));
        std::vector<std::size_t> indices =
            exceeded_pairs(all_, search_.begin, to_model(selection, lobes, {}), largest_);
        // Bounds beyond the grid are left to the last stage: candidates often exceed them, and they would displace more
        // important ones.
        std::erase_if(indices, [&](std::size_t k) { return std::min(all_.wl[k].z, all_.wv[k].z) < k_grazing_cosine; });
        added[i] = thin_out(std::move(indices), k_max_added);
        loss[i] = polish.loss(pack(lobes));
    });
    loss_ = *std::min_element(loss.begin(), loss.end());

    std::set<std::size_t> added_indices;
    for (const auto& candidate_pairs : added) added_indices.insert(candidate_pairs.begin(), candidate_pairs.end());
    const std::size_t fitted = all_.fitted_count();
    for (const std::size_t i : added_indices) {
        const double weight = i < fitted ? all_.weight[i] : bound_weight(all_, i, loss_, largest_);
        for (Subset* subset : {&search_, &selection_, &polish_})
            if (i >= subset->begin) subset->observations.add(all_.wl[i], all_.wv[i], all_.f[i], weight);
    }
}

double Subsets::integral_importance() const {
    return std::min(loss_, k_max_albedo_loss) / (3 * all_.integral_error * all_.integral_error);
}

double Subsets::picture_importance(const Candidate& candidate) const {
    constexpr double k_negligible = 1e-9, k_min_delta_e = 1e-3;
    const PackedObservations seen = rows(RowSet::selection, {.pictures = k_negligible});
    LobeProblem problem(seen, candidate.lobes.shape, true);
    problem.loss(pack(candidate.lobes));
    return k_pixels * loss_ / std::max(problem.delta_e(), k_min_delta_e);
}

const Observations& Subsets::observations(RowSet pairs) const {
    switch (pairs) {
        case RowSet::search:
            return search_.observations;
        case RowSet::selection:
            return selection_.observations;
        case RowSet::polish:
            return polish_.observations;
        case RowSet::all:
            break;
    }
    return all_;
}

PackedObservations Subsets::rows(RowSet pairs, const FurtherTerms& terms) const {
    return PackedObservations(observations(pairs),
                              {.integral_importance = terms.albedos ? integral_importance() : 0,
                               .subsampled_integrals = pairs == RowSet::search || pairs == RowSet::selection,
                               .picture_importance = terms.pictures});
}

}  // namespace
