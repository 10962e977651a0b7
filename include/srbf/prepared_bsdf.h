// A BSDF that owns what it needs, ready to be asked pair by pair on either side.
#pragma once
#include <array>
#include <optional>

#include "srbf/prepared.h"

namespace [[gnu::visibility("default")]] srbf {

/// A direction to the light, on either side.
struct BsdfSample {
    Vec3f wl;
    Rgb weight;     ///< f |cosθl| / pdf, or the beam's share over the chance of choosing it; 0 without a direction
    float pdf = 0;  ///< [1/sr] of a scattered direction; 0 of a beam and if there is no direction
    bool is_beam = false;
};

/// The parts of a BSDF (bsdf.h), each ready for a renderer. Copies share them; all functions may be called from several
/// threads at once.
class PreparedBsdf {
  public:
    using PreparedParts = std::array<std::optional<PreparedBrdf>, k_parts>;
    /// A BRDF at the front and the back, through which no light passes.
    PreparedBsdf(PreparedBrdf of_both_sides);
    /// A part that is missing is 0.
    PreparedBsdf(PreparedParts parts, Beams beams);

    /// True if front and back are the same BRDF and no light passes.
    bool is_brdf() const { return is_brdf_; }

    friend Rgb value(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);
    friend BsdfSample sample(const PreparedBsdf& bsdf, Vec3f wv, Vec2f u, float selector);
    friend float pdf(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);

  private:
    /// The chances of sampling from reflection, transmission and their beams, for a viewer.
    struct Chances {
        std::array<Part, 2> part;  ///< of reflection, of transmission
        std::array<float, 2> of_part;
        std::array<Rgb, 2> beam;
        std::array<float, 2> of_beam;
    };
    Chances chances(Vec3f wv) const;

    PreparedParts parts_;
    Beams beams_;
    bool is_brdf_ = false;
};

/// f(wl, wv) [1/sr] without the beams.
Rgb value(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);
/// Samples a direction for wv on either side from a point of the unit square and a selector of part and lobe, all
/// uniform in [0,1). Reflection, transmission and beams are chosen in proportion to their luminance at θv. Unless
/// `is_brdf()`, the first sample or density computes the directional albedos of the parts in question, each as `albedo`
/// of prepared.h does.
BsdfSample sample(const PreparedBsdf& bsdf, Vec3f wv, Vec2f u, float selector);
/// The density of scattered directions [1/sr]; ∫ pdf over the sphere is 1 but for the chances of the beams and of
/// samples without a direction.
float pdf(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);

/// A model or a measurement, of either kind. Each part is prepared by `prepare` of prepared.h with its own sampling
/// density: a BSDF of four parts takes four times as long as a BRDF. A part that answers for the other side without a
/// change is prepared once.
PreparedBsdf prepare_bsdf(const Model& model, const ProposeOptions& options);
PreparedBsdf prepare_bsdf(const Measured& measured, const ProposeOptions& options);

}  // namespace srbf
