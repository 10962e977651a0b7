// Edits of multivariate models: each result is a model like any other.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "srbf/model.h"
#include "srbf/progress.h"

SRBF_BEGIN

/// The spread of lobe j about the mirror direction: the mean of sin²θh over the light that it reflects at views 5°, 45°
/// and 70° from the normal, divided by the same mean for Lambert's BRDF with the lobe's albedos at these views. It is 1
/// for a constant, and about α² or less for facets.
double spread(const PmModel& model, int lobe);
/// The fraction of each lobe that belongs to the body; the rest belongs to the highlight. A lobe whose `spread` is
/// below `k_max_highlight_spread` is highlight. From `k_min_body_spread` on it is body. Between the two limits there
/// are three cases. The lobe is highlight if the lobes that are body have less than a twentieth of the albedo. Otherwise
/// it is body if its chromaticity is less than half as far from the body's as from the highlight's. Otherwise its
/// fraction is linear in the spread, from 0 at the first limit to 1 at a spread of 1.
inline constexpr double k_max_highlight_spread = 0.6, k_min_body_spread = 0.88;
std::vector<double> body_fractions(const PmModel& model);

// The edits. Colours are factors of linear R, G, B.

/// Widens the highlight as facets of `factor` times the roughness would: slopes of half vectors are divided by it, at
/// the same angle of the light to the half vector, and GGX facets of the new roughness give the masking. A refit.
struct Roughen {
    double factor = 1;  ///< 0.1..10
};
/// Multiplies the colours of the highlight and of the body, each 0..10.
struct Tint {
    Rgb highlight{1, 1, 1}, body{1, 1, 1};
};
/// Moves the colour of each lobe away from grey of its luminance (factor > 1) or towards it; a channel below 0 counts
/// as 0.
struct Saturate {
    double factor = 1;  ///< 0..4
};
/// Rotates the colour of each lobe about grey, at the same luminance; a channel below 0 counts as 0.
struct TurnHue {
    double degrees = 0;  ///< −360..360
};
/// Covers the surface by a clear dielectric layer with a rough interface. With T the fraction of light that the
/// interface does not reflect, and the directions l', v' refracted at it,
///   ρ = ρ_interface + T(l) T(v) / n² (ρ'(l', v') + ρ_again(l', v')) tint^p,
/// where ρ' is the model with its highlight widened by the rough interface, ρ_again the light that is reflected more
/// than once between base and interface, and p half of 1/cosθ'l + 1/cosθ'v. Symmetric if ρ is. A refit.
struct Coat {
    double roughness = 0.1;  ///< α of the interface, 0.02..1
    double ior = 1.5;        ///< n, 1.05..3
    Rgb tint{1, 1, 1};       ///< transmittance of two passes through the layer along the normal, 0..1
};
/// Rotates the tangent about the normal; an isotropic model stays as it is.
struct Rotate {
    double degrees = 0;  ///< −360..360, from x to y
};
/// Fits fewer lobes to the model.
struct Reduce {
    int lobes = 8;  ///< 1..64
};
using Edit = std::variant<Roughen, Tint, Saturate, TurnHue, Coat, Rotate, Reduce>;
/// The edit in words, for the provenance.
std::string text(const Edit& edit);

struct EditOptions {
    /// Number of lobes of a refit; none: the number of the model, and three more under a coat.
    std::optional<int> lobes = {};
    int threads = 0;  ///< number of threads; 0: all of the machine. The result does not depend on it
    ProgressToken progress = {};
};

/// Applies the edits in their order. Refits minimise the objective appearance (metrics.h) against the edited model's
/// own function. A directional albedo stays at most 1, or the model's largest: where an edit exceeds it, lobes are
/// lowered, and the entry "limited" of the provenance states how far the edit went. A reciprocal model stays
/// reciprocal. The provenance keeps where the model comes from, gets "edits", and loses the errors of the measurement.
/// Returns an error if the model is not multivariate, if edits of colours or refits get a spectral model, if a number
/// is out of range, or if it is cancelled.
Result<Model> edit_model(const Model& model, std::span<const Edit> edits, const EditOptions& options = {});

/// (1 − mix) a + mix b, with the lobes and variates of both: an exact sum, before coefficients are rounded. Models of
/// different forms become one of the form that has all their terms; a reciprocal model beside one that is not becomes
/// twice as many lobes and variates. Returns an error if mix is outside 0..1, if the models are not both multivariate
/// or have spectra at different wavelengths, or if they have more than 8 variates or 1024 lobes together.
Result<Model> blend_models(const Model& a, const Model& b, double mix);

SRBF_END
