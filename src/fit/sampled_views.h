// What was measured in each sampled view, as a fit of that view takes it.
#pragma once
#include "fit/view_problem.h"
#include "srbf/fit.h"

namespace srbf {

/// The functions of the sampled directions of a raw matrix, weighted for an objective.
class SampledViews {
  public:
    /// It refers to `matrix`, which has as many values as its directions ask for.
    SampledViews(const RawMatrix& matrix, Objective objective, double theta_max);

    std::size_t count() const { return matrix_.direction.size(); }
    Vec3f direction(std::size_t view) const { return matrix_.direction[view]; }
    /// Directions within θmax at which view `view` has data.
    std::size_t valid(std::size_t view) const;

    /// The rows of a view: those of the matrix within θmax weigh what the objective says; those beyond are guards, which weigh
    /// little, as in `observe`; those between the matrix's directions weigh as much as k_between of an even
    /// density of them. Nothing (scale 0) where there is no value above 0 within θmax.
    ViewRows rows(std::size_t view) const;

  private:
    /// f of sampled direction `view` at direction `other` of the set.
    const Rgb& f(std::size_t view, std::size_t other) const {
        const bool by_view = matrix_.discretise == Discretise::view;
        return matrix_.f[by_view ? view * count() + other : other * count() + view];
    }
    bool within(Vec3f w) const { return double(w.z) >= cos_max_; }
    double weight(std::size_t view, Vec3f other, const Rgb& f) const;

    const RawMatrix& matrix_;
    Objective objective_;
    double cos_max_;
    double mean_ = 0;           ///< of f within both caps
    std::vector<Rgb> largest_;  ///< f times the other direction's cosine, of each channel, within θmax about each view
};

}  // namespace srbf
