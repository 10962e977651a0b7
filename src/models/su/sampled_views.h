// The measurement of each sampled view, in the form that its fit uses.
#pragma once
#include "models/su/view_problem.h"
#include "observe/raw_matrix.h"

namespace SRBF_NAMESPACE {

/// The rows of a raw matrix for each sampled direction, with the weights of an objective.
class SampledViews {
  public:
    /// Keeps a reference to `matrix`, whose arrays must have the sizes that its directions require.
    SampledViews(const RawMatrix& matrix, Objective objective, double theta_max);

    std::size_t count() const { return matrix_.direction.size(); }
    Vec3f direction(std::size_t view) const { return matrix_.direction[view]; }
    /// The number of directions within θmax at which a view has data.
    std::size_t valid(std::size_t view) const;

    /// The rows of a view. Directions of the matrix within θmax have the weights of the objective; directions beyond it
    /// are horizon pairs with small weights, as in `observe`. Further directions (`RawMatrix::DrawnValue`) have the weight
    /// of k_between_views_directions times a uniform density. An objective of pictures adds radiances. The scale is 0
    /// if there is no value above 0 within θmax.
    const ViewRows& rows(std::size_t view) const { return rows_[view]; }

  private:
    /// f of sampled direction `view` at direction `other` of the set.
    const Rgb& f(std::size_t view, std::size_t other) const {
        const bool by_view = matrix_.discretise == Discretise::view;
        return matrix_.f[by_view ? view * count() + other : other * count() + view];
    }
    bool within(Vec3f w) const { return double(w.z) >= cos_max_; }
    /// The light and the viewer, one of which is a sampled direction.
    std::pair<Vec3f, Vec3f> pair(std::size_t view, Vec3f other) const {
        return matrix_.discretise == Discretise::light ? std::pair(direction(view), other)
                                                       : std::pair(other, direction(view));
    }
    std::span<const RawMatrix::DrawnValue> between_of(std::size_t view) const;
    /// The directions of a view with their values: first directions of the matrix, then valid ones between them.
    struct Table {
        std::size_t view;
        std::vector<Vec3f> direction;
        std::vector<Rgb> f;
        std::vector<double> pdf_between;  ///< the density of the directions between [1/sr]
        std::vector<double> solid_angle;  ///< the reciprocal density of all directions [sr]
    };
    Table table_of(std::size_t view) const;
    /// The density of all directions of a view where those between have the density `pdf_between` [1/sr].
    double density(double pdf_between) const;

    struct Weights {
        std::vector<double> row;       ///< the weight of each row of a table
        double energy = 0, total = 0;  ///< Σ w |f|² and Σ w over the directions of the matrix
    };
    Weights weights_of(const Table& table) const;

    ViewRows make_rows(std::size_t view) const;
    /// Adds the radiances that a view reflects under four lights: a uniform one, and broad ones around the mirror
    /// direction, beside the view, and around it.
    void add_radiances(ViewRows& rows, const Table& table) const;

    void find_typical();
    void find_largest();

    const RawMatrix& matrix_;
    Objective objective_;
    double cos_max_;
    double typical_ = 0;  ///< see `typical_value`
    /// For each view, the largest f times the other direction's cosine within θmax, over neighbouring views.
    std::vector<Rgb> largest_;
    std::vector<ViewRows> rows_;
};

}  // namespace
