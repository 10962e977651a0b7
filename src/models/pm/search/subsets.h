// Subsets of the observations, for the search.
#pragma once
#include <vector>

#include "models/pm/search/search.h"

namespace SRBF_NAMESPACE {

inline constexpr std::size_t k_search_pairs = 2048, k_selection_pairs = 4096, k_polish_pairs = 16384;

/// The first pairs that are rows: few in a search with many candidates, more afterwards, more in the polish, or all.
/// Pictures are observed beside `selection` and `all`. A quick fit, with fewer observations than another's polish,
/// uses `selection` instead of `search`, because its first candidates are its only ones.
enum class RowSet { search, selection, polish, all };

/// The terms of a loss besides the pairs.
struct FurtherTerms {
    bool albedos = true;
    double pictures = 0;  ///< see PackingOptions::picture_importance
};

/// The first observations, in colours: for the search, for the selection, and for the polish. From stage to stage,
/// observations are added at which candidates exceeded the measurement.
class Subsets {
  public:
    /// Keeps a reference to `observations`, which must outlive it.
    explicit Subsets(const Observations& observations, std::size_t search_pairs = k_search_pairs);

    /// Evaluates the candidates at the other observations, and adds the observations at which they exceed the
    /// measurement. Updates the loss to which the weight of integrals is relative.
    void add_exceeded_pairs(const std::vector<Candidate>& candidates, const LobeShape& shape);

    PackedObservations rows(RowSet pairs, const FurtherTerms& terms) const;

    /// The increase of the sum if every integral differs by its luminance in one of three channels.
    double integral_importance() const;
    /// The factor with which the pixels of this candidate cost `k_pixels` times the loss per mean ΔE_ITP.
    double picture_importance(const Candidate& candidate) const;

  private:
    struct Subset {
        Observations observations;
        std::size_t begin;  ///< number of initial observations from `all_`; the others were added
    };
    Subset first_pairs_of(std::size_t pairs) const;
    const Observations& observations(RowSet pairs) const;

    const Observations& all_;
    Subset search_, selection_, polish_;
    double largest_, loss_ = 1;
};

}  // namespace
