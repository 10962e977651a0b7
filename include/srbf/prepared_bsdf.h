// A BSDF that owns its data, ready for evaluation and sampling pair by pair on either side.
#pragma once
#include <array>
#include <optional>

#include "srbf/prepared.h"

SRBF_BEGIN

/// A sampled direction to the light, on either side.
struct BsdfSample {
    Vec3f wl;
    /// f |cosθl| / pdf, or the beam's fraction over the probability of choosing it; 0 without a direction
    Rgb weight;
    float pdf = 0;  ///< [1/sr] of a scattered direction; 0 for a beam and if there is no direction
    bool is_beam = false;
};

/// The parts of a BSDF (brdf.h), each ready for a renderer. Copies share them. All functions may be called from
/// several threads at once.
class PreparedBsdf {
  public:
    using PreparedParts = std::array<std::optional<PreparedBrdf>, k_parts>;
    /// Uses one BRDF at the front and the back, without transmission.
    PreparedBsdf(PreparedBrdf both_sides);
    /// A missing part is 0.
    PreparedBsdf(PreparedParts parts, Beams beams);

    /// True if front and back are the same BRDF and there is no transmission.
    bool is_brdf() const { return is_brdf_; }

    friend Rgb value(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);
    friend BsdfSample sample(const PreparedBsdf& bsdf, Vec3f wv, Vec2f u, float selector);
    friend float pdf(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);
    friend ValuePdf value_pdf(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);

  private:
    /// The probabilities of sampling reflection, transmission and their beams, for a viewer.
    struct Chances;
    Chances chances(Vec3f wv) const;
    /// The probability that `sample` chooses this part, which must exist.
    float chance(Part part, Vec3f wv) const;

    PreparedParts parts_;
    Beams beams_;
    bool is_brdf_ = false;
};

/// f(wl, wv) [1/sr] without the beams.
Rgb value(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);
/// Samples a direction for wv on either side. `u` is a point of the unit square, and the selector chooses part and
/// lobe; all are uniform in [0,1). Reflection, transmission and beams are chosen in proportion to their luminance
/// at θv. Unless `is_brdf()`, the first sample or density computes the directional albedos of the parts involved,
/// each as `albedo` of prepared.h does.
BsdfSample sample(const PreparedBsdf& bsdf, Vec3f wv, Vec2f u, float selector);
/// The density of scattered directions [1/sr]. ∫ pdf over the sphere is 1 minus the probabilities of beams and of
/// samples without a direction.
float pdf(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);
/// Returns both `value` and `pdf` of a pair.
ValuePdf value_pdf(const PreparedBsdf& bsdf, Vec3f wl, Vec3f wv);

/// Prepares a model or a measurement, of a BRDF or a BSDF. Each part is prepared by `prepare` of prepared.h with
/// its own sampling density: a BSDF with four parts takes four times as long as a BRDF. A part that also serves the
/// other side unchanged is prepared once.
PreparedBsdf prepare_bsdf(const Model& model, const ProposeOptions& options);
PreparedBsdf prepare_bsdf(const Measured& measured, const ProposeOptions& options);

SRBF_END
