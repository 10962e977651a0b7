// The limit on the directional albedo of a fit.
#pragma once
#include <limits>
#include <optional>

#include "brdf/directions.h"
#include "observe/observations.h"
#include "srbf/models/pm.h"

namespace SRBF_NAMESPACE {

/// The cost of a bound relative to the cost of all observed albedos together.
inline constexpr double k_albedo_bound_cost = 8;

/// The limit on the directional albedo of a channel that a fit of this form has by default; infinity: there is none.
constexpr double default_albedo_limit(PmForm form) {
    return is_reciprocal(form) ? 1 : std::numeric_limits<double>::infinity();
}

/// The largest directional albedo of a channel measured at views up to 80°; beyond, values are quotients by small cosines.
double max_measured_albedo(const Observations& observations);

/// Limits the directional albedo of a fit at views from the normal to cosθv = 0.001, in every channel.
class AlbedoBound {
  public:
    /// Fine: more views, with albedos by `albedo_quadrature`.
    enum class Resolution { coarse, fine };
    /// `azimuths`: number of azimuths of the views; one is enough for isotropic models.
    AlbedoBound(double limit, int azimuths, Resolution resolution = Resolution::coarse);

    double limit() const { return limit_; }

    /// The albedo of each channel at each view, as a fraction of the limit.
    std::vector<double> albedos(const Evaluate& model) const;
    /// The largest of these albedos.
    double excess(const Evaluate& model) const;
    /// Adds to the observations, as integrals with the limit as their value, the albedos that `model` exceeds, and
    /// raises the costs of earlier ones that it still exceeds. Returns their number.
    std::size_t add_exceeded(Observations& observations, const Evaluate& model);

  private:
    struct View {
        Vec3f wv;
        Quadrature light;                     ///< its weights include cosθl
        std::optional<std::size_t> integral;  ///< its index in the observations
    };
    /// The albedo of `view` as an integral within the limit, for values of the model there.
    ObservedIntegral bound_of(const View& view, std::vector<Rgb> values, double albedo) const;

    double limit_;
    std::vector<View> views_;
};

/// `model` with lobes lowered until its albedo is within the limit, for a fit that still exceeds it. In the view with
/// the largest albedo, the lobe that has the largest fraction of its own albedo there is lowered, and so on. So a lobe
/// that rises only at the horizon does not darken the others. Near the limit, views between are checked as well.
PmModel limit_albedo(const AlbedoBound& bound, PmModel model);

}  // namespace
