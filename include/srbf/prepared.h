// How a BRDF is prepared for evaluation and sampling pair by pair (srbf.h): models, measurements, and BRDFs of your own.
#pragma once
#include <cstring>
#include <functional>
#include <memory>
#include <utility>

#include "srbf/measured.h"
#include "srbf/sampling.h"
#include "srbf/srbf.h"

namespace [[gnu::visibility("default")]] srbf {

/// The density that `sample` samples by; it refers to what `brdf` holds.
const Proposal& proposal(const PreparedBrdf& brdf);

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

/// `evaluate` as a function, which holds a copy of `brdf`.
Evaluate evaluator(PreparedBrdf brdf);

}  // namespace srbf
