// The measurement of each sampled view in the form that a fit of that view uses.
#pragma once
#include "fit/data/raw_matrix.h"
#include "fit/objective/point_lights.h"
#include "fit/views/view_problem.h"

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
    /// guards with small weights, as in `observe`. Directions between those of the matrix together weigh as much as
    /// k_between times a uniform density of them. For an objective of pictures radiances and pixels are matched too.
    /// Empty (scale 0) if there is no value above 0 within θmax.
    const ViewRows& rows(std::size_t view) const { return rows_[view]; }

  private:
    ViewRows rows_of(std::size_t view) const;
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
    /// The directions of a view with their values: all of the matrix, then those between them that are valid, whose
    /// densities are known.
    struct Tabulated {
        std::vector<Vec3f> direction;
        std::vector<Rgb> f;
        std::vector<double> pdf_between;
    };
    Tabulated tabulated(std::size_t view) const;
    /// The density of a view's directions, of the matrix and between them, where the latter have this one [1/sr].
    double density(double pdf_between) const;
    /// The solid angles of these directions if all count by their density [sr].
    std::vector<double> solid_angles(std::size_t view, const Tabulated& of) const;
    /// Adds to the weights those of radiance in pictures of each phase; `energy`: Σ w |f|² so far.
    void add_radiance(std::span<double> weights, double energy, std::size_t view, std::span<const Vec3f> directions,
                      std::span<const Rgb> values, std::span<const double> solid_angle) const;
    /// Adds the radiances that a view reflects under four lights: a uniform one, and broad ones about the mirror
    /// direction, beside the view, and about it.
    void add_lights(ViewRows& rows, std::size_t view, std::span<const Vec3f> directions, std::span<const Rgb> values,
                    std::span<const double> solid_angle) const;
    /// Adds the view's pixels under single lights, whose phases (the angles between light and viewer) are uniform.
    void add_pixels(ViewRows& rows, std::size_t view, std::span<const Vec3f> directions, std::span<const Rgb> values,
                    std::span<const double> solid_angle) const;
    /// Finds `white_` and `energies_`.
    void see_pictures();
    double weight(std::size_t view, Vec3f other, const Rgb& f) const;
    /// For an objective of pictures: the weight, before scaling, that keeps radiance above white in order; otherwise 0.
    double highlight_weight(std::size_t view, Vec3f other, const Rgb& f) const;

    const RawMatrix& matrix_;
    Objective objective_;
    double cos_max_;
    double typical_ = 0;         ///< see `typical_value`
    std::vector<double> white_;  ///< of each phase: the f cosθl that pictures of a sphere show as white
    PhaseEnergies energies_;     ///< of pictures
    /// maximum of f times the other direction's cosine, per channel, within θmax, over neighbouring views
    std::vector<Rgb> largest_;
    std::vector<ViewRows> rows_;
};

}  // namespace srbf
