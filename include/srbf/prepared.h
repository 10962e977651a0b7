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

    /// What `sample` draws from; it refers to what this holds.
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

/// What a prepared BRDF is made of, for a type that this library does not know.
struct BrdfParts {
    std::shared_ptr<const void> held;
    PreparedBrdf::Value value = nullptr;
    Evaluate evaluate;  ///< of what is held
    Proposal proposal;
};
PreparedBrdf prepare(BrdfParts parts);

/// A model (of a BSDF its front; all of it: prepared_bsdf.h), sampled by its proposal, `propose(model, options)`, which
/// takes some 55 ms to make (docs/performance.md); or by the cosine, for those who ask for values alone.
PreparedBrdf prepare(const Model& model, const ProposeOptions& options = {});
PreparedBrdf prepare(const Model& model, CosineProposal by_cosine);
/// A measurement, likewise; what was not measured is NaN in `value`, and 0 in all else.
PreparedBrdf prepare(Measured measured, const ProposeOptions& options = {});
PreparedBrdf prepare(Measured measured, CosineProposal by_cosine);
/// Any other BRDF, of which it takes a copy or what is moved into it.
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
/// f = reflectance / π.
PreparedBrdf diffuse(Rgb reflectance);

/// f_r(wl, wv) [1/sr]: within 1e-4 of the model's `value` or 1e-6 of its peak; 0 below the horizon, and where a cosine
/// is subnormal.
inline Rgb value(const PreparedBrdf& brdf, const Vec3f& wl, const Vec3f& wv) {
    if (!above_horizon(wl, wv)) return {};
    alignas(16) float colour[4];
    brdf.value_(brdf.held_, wl, wv, colour);
    Rgb f;
    std::memcpy(&f, colour, sizeof f);  // as it was stored
    return f;
}
/// The same for spans of one length.
void evaluate(const PreparedBrdf& brdf, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// The same as a function, which holds a copy of `brdf`.
Evaluate evaluator(PreparedBrdf brdf);

/// Samples a direction to the light from independent numbers, uniform in [0,1): a point u and the selector of a lobe.
inline LightSample sample(const PreparedBrdf& brdf, Vec3f wv, Vec2f u, float selector) {
    return sample(brdf, brdf.proposal(), wv, u, selector);
}
/// Its density [1/sr]; 0 below the horizon.
float pdf(const PreparedBrdf& brdf, Vec3f wl, Vec3f wv);

/// Directional albedo ∫ f(wl, wv) cosθl dωl for cosθv in (0, 1], averaged over azimuths: linear in
/// ∜cosθv − √(1 − cosθv) between 129 nodes, within 1 % or 0.002 at every cosine for the fits of measured materials.
/// The first call makes the nodes, which takes some tens of milliseconds.
Rgb albedo(const PreparedBrdf& brdf, float cos_v);

}  // namespace srbf
