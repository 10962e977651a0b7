// A BRDF that owns what it needs, ready to be asked pair by pair.
#pragma once
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <utility>

#include "srbf/measured.h"
#include "srbf/sampling.h"

namespace [[gnu::visibility("default")]] srbf {

/// A BRDF ready for a renderer: value, batch evaluation, importance sampling with its density, directional albedo. It
/// is made by `prepare` from a model, a measurement or any other BRDF, of which it holds a copy; its own copies share
/// that. Directions are unit vectors, which is not checked. Several threads may call all functions at once, and no
/// result depends on whether the processor flushes subnormal numbers to 0.
class PreparedBrdf {
  public:
    /// Writes R, G, B of f_r and one number to spare to `colour`, which is aligned to 16 bytes.
    using Value = void (*)(const void* brdf, const Vec3f& wl, const Vec3f& wv, float* colour);
    struct Contents;  ///< Value and the rest for one type of BRDF
    explicit PreparedBrdf(std::shared_ptr<const Contents> contents);

    /// The density that `sample` samples by; it refers to what this holds.
    const Proposal& proposal() const;

    friend Rgb value(const PreparedBrdf& brdf, const Vec3f& wl, const Vec3f& wv);
    friend void evaluate(const PreparedBrdf& brdf, std::span<const Vec3f> wl, std::span<const Vec3f> wv,
                         std::span<Rgb> f);
    friend Rgb albedo(const PreparedBrdf& brdf, float cos_v);

  private:
    std::shared_ptr<const Contents> contents_;
    const void* held_;  // in them, as is its function
    Value value_;
};

/// The parts of a prepared BRDF, for a type that this library does not know. The `PreparedBrdf` owns all of it, and
/// its copies share it. Several threads may call both functions at once.
struct BrdfParts {
    /// The BRDF, the first argument of `value`. It is destroyed last: `evaluate` and `proposal` may refer to it.
    std::shared_ptr<const void> held;
    /// f_r of a pair of directions of which `above_horizon` is true. Not null, which is not checked.
    PreparedBrdf::Value value = nullptr;
    /// f_r on arrays of pairs, for `evaluate` and `albedo`; without it these throw `std::bad_function_call`.
    Evaluate evaluate;
    Proposal proposal;  ///< the cosine if it is not set; a `ViewProposal` has to refer to a model in `held`
    /// The directional albedo of a view with cosθv > 0, of which `albedo` is the mean over four azimuths; without it `albedo`
    /// integrates `evaluate`.
    std::function<Rgb(Vec3f wv)> albedo = nullptr;
};
PreparedBrdf prepare(BrdfParts parts);

/// A model (of a BSDF its front; prepared_bsdf.h prepares all of it). The first overload computes a sampling density,
/// `propose(model, options)` and what `refined` makes of it, which takes about 75 ms of one processor core
/// (docs/performance.md). The second samples by the cosine; use it if you only call `value`, `evaluate` or `albedo`.
/// An anisotropic model too has `options.azimuths` = 1 by default; with `k_anisotropic_azimuths` its samples have a
/// smaller variance.
PreparedBrdf prepare(const Model& model, const ProposeOptions& options = {});
PreparedBrdf prepare(const Model& model, CosineProposal by_cosine);
/// A measurement, likewise. What was not measured is NaN in `value` and `evaluate`; `sample`, `pdf` and `albedo` count
/// it as 0.
PreparedBrdf prepare(Measured measured, const ProposeOptions& options = {});
PreparedBrdf prepare(Measured measured, CosineProposal by_cosine);
/// Any other BRDF, of which it takes a copy or what is moved into it. The proposal is for example
/// `propose(evaluator(brdf))`, or `CosineProposal{}`.
template <Brdf B> PreparedBrdf prepare(B brdf, Proposal proposal) {
    auto held = std::make_shared<const B>(std::move(brdf));
    const B& b = *held;
    return prepare(BrdfParts{std::move(held),
                             [](const void* any, const Vec3f& wl, const Vec3f& wv, float* colour) {
                                 const Rgb f = value(*static_cast<const B*>(any), wl, wv);
                                 std::memcpy(colour, &f, sizeof f);
                             },
                             evaluator(b), std::move(proposal)});
}
/// f = reflectance / π, sampled by the cosine.
PreparedBrdf diffuse(Rgb reflectance);

// In the functions below, `wl` and `wv` are unit vectors. This is not checked: another length gives a wrong value
// without an error.

/// f_r(wl, wv) [1/sr], without the cosine: of a model within 1e-4 of its `value` or 1e-6 of its peak. It is 0 if wl.z
/// or wv.z is 0, negative or subnormal, and NaN where a measurement has no value.
inline Rgb value(const PreparedBrdf& brdf, const Vec3f& wl, const Vec3f& wv) {
    if (!above_horizon(wl, wv)) return {};
    alignas(16) float colour[4];
    brdf.value_(brdf.held_, wl, wv, colour);
    Rgb f;
    std::memcpy(&f, colour, sizeof f);  // as it was stored
    return f;
}
/// f_r at pairs of directions, in spans of one length.
void evaluate(const PreparedBrdf& brdf, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// `evaluate` as a function, which holds a copy of `brdf`.
Evaluate evaluator(PreparedBrdf brdf);

/// Samples a direction to the light from independent numbers, uniform in [0,1): a point u and the selector of a lobe.
/// The `pdf` of the result is 0 if wv.z ≤ 0, and if the sample has no direction.
inline LightSample sample(const PreparedBrdf& brdf, Vec3f wv, Vec2f u, float selector) {
    return sample(brdf, brdf.proposal(), wv, u, selector);
}
/// The density of `sample` [1/sr]: 0 if wl.z ≤ 0 or wv.z ≤ 0.
float pdf(const PreparedBrdf& brdf, Vec3f wl, Vec3f wv);

/// Directional albedo ∫ f(wl, wv) cosθl dωl for cosθv in (0, 1], averaged over azimuths. Of a view-by-view model whose sampled
/// direction is the view it is interpolated, as the model is, from the integrals of the lobes: within 1 % or 0.002. Of any
/// other BRDF it is linear in ∜cosθv − √(1 − cosθv) between 129 nodes, sums over 16384 points each: up to 85° within 1 % or
/// 0.002 for the fits of measured materials and for tables. It errs more beyond 85°, for highlights narrower than the points,
/// and for scattered samples, up to a factor of 2 (docs/sampling.md).
/// A cosine of 0, below it or NaN gives 0; above 1 counts as 1. The first call makes the nodes on one thread, and other
/// threads that call it wait: about 0.3 s for a multivariate model or a table (docs/performance.md).
Rgb albedo(const PreparedBrdf& brdf, float cos_v);

}  // namespace srbf
