// The measurement of each sampled view in the form that a fit of that view uses.
#pragma once
#include "models/su/view_problem.h"
#include "observe/raw_matrix.h"

namespace srbf {

/// The functions of the sampled directions of a raw matrix, with the weights of an objective.
class SampledViews {
  public:
    /// Keeps a reference to `matrix`, whose arrays must have the sizes that its directions require.
    SampledViews(const RawMatrix& matrix, Objective objective, double theta_max);

    std::size_t count() const { return matrix_.direction.size(); }
    Vec3f direction(std::size_t view) const { return matrix_.direction[view]; }
    /// Number of directions within θmax at which view `view` has data.
    std::size_t valid(std::size_t view) const;

    /// The rows of a view. Directions of the matrix within θmax have the weights of the objective. Those beyond are
    /// horizon pairs with small weights, as in `observe`. Directions between those of the matrix together
    /// weigh as much as k_between_views_directions times a uniform density of them. For an objective of pictures
    /// radiances are matched too.
    /// Empty (scale 0) if there is no value above 0 within θmax.
    const ViewRows& rows(std::size_t view) const { return rows_[view]; }

  private:
    /// f of sampled direction `view` at direction `other` of the set.
    const Rgb& f(std::size_t view, std::size_t other) const {
        const bool by_view = matrix_.discretise == Discretise::view;
        return matrix_.f[by_view ? view * count() + other : other * count() + view];
    }
    bool within(Vec3f w) const { return double(w.z) >= cos_max_; }
    /// A sampled direction and another one as light and viewer.
    std::pair<Vec3f, Vec3f> pair(std::size_t view, Vec3f other) const {
        return matrix_.discretise == Discretise::light ? std::pair(direction(view), other)
                                                       : std::pair(other, direction(view));
    }
    std::span<const RawMatrix::Between> between_of(std::size_t view) const;
    /// The directions of a view with their values: all of the matrix, then those between them that are valid, whose
    /// densities are known.
    struct Table {
        std::size_t view;
        std::vector<Vec3f> direction;
        std::vector<Rgb> f;
        std::vector<double> pdf_between;
        std::vector<double> solid_angle;  ///< if all directions count by their density [sr]
    };
    Table table_of(std::size_t view) const;
    /// The density of a view's directions, of the matrix and between them, where the latter have this one [1/sr].
    double density(double pdf_between) const;

    /// The sums over the rows of a table: Σ w |f|² and Σ w over those of the matrix.
    struct Weights {
        std::vector<double> of_row;
        double energy = 0, whole = 0;
    };
    Weights weights_of(const Table& table) const;

    ViewRows rows_of(std::size_t view) const;
    /// Adds the radiances that a view reflects under four lights: a uniform one, and broad ones about the mirror
    /// direction, beside the view, and about it.
    void add_radiances(ViewRows& rows, const Table& table) const;

    void find_typical();
    void find_largest();

    const RawMatrix& matrix_;
    Objective objective_;
    double cos_max_;
    double typical_ = 0;  ///< see `typical_value`
    /// maximum of f times the other direction's cosine, per channel, within θmax, over neighbouring views
    std::vector<Rgb> largest_;
    std::vector<ViewRows> rows_;
};

}  // namespace srbf
