// Preparation of BRDFs for evaluation and sampling pair by pair (srbf.h): models, measurements, and BRDFs of your own.
#pragma once
#include <cstring>
#include <functional>
#include <memory>
#include <utility>

#include "srbf/measured.h"
#include "srbf/sampling.h"
#include "srbf/srbf.h"

SRBF_BEGIN

/// The density from which `sample` samples. It refers to data that `brdf` holds.
const Proposal& proposal(const PreparedBrdf& brdf);

/// The parts of a prepared BRDF, for types that this library does not know. The `PreparedBrdf` owns all of them,
/// and its copies share them. Several threads may call both functions at once.
struct BrdfParts {
    /// The BRDF, the first argument of `value`. It is destroyed last: `evaluate` and `proposal` may refer to it.
    std::shared_ptr<const void> held;
    /// f_r of a pair of directions for which `above_horizon` is true. Must not be null, which is not checked.
    PreparedBrdf::Value value = nullptr;
    /// f_r on arrays of pairs, for `evaluate` and `albedo`; if it is not set, these throw `std::bad_function_call`.
    Evaluate evaluate;
    Proposal proposal;  ///< the cosine by default; a `ViewProposal` must refer to a model in `held`
    /// The directional albedo of a view with cosθv > 0; `albedo` is its mean over four azimuths. If it is null,
    /// `albedo` integrates `evaluate`.
    std::function<Rgb(Vec3f wv)> albedo = nullptr;
};
PreparedBrdf prepare(BrdfParts parts);

/// Prepares a model, or the front of a BSDF (prepared_bsdf.h prepares its front and back). The first overload computes
/// a sampling density by `propose`, which takes about 50 ms of a core. The second samples by the cosine, for use
/// without `sample`. Samples of anisotropic models have a smaller variance with `k_anisotropic_azimuths`.
PreparedBrdf prepare(const Model& model, const ProposeOptions& options = {});
PreparedBrdf prepare(const Model& model, CosineProposal by_cosine);
/// Prepares a measurement in the same way. Values that were not measured are NaN in `value` and `evaluate`;
/// `sample`, `pdf` and `albedo` count them as 0.
PreparedBrdf prepare(Measured measured, const ProposeOptions& options = {});
PreparedBrdf prepare(Measured measured, CosineProposal by_cosine);
/// Prepares any other BRDF, which is copied or moved. The proposal is for example `propose(evaluator(brdf))`, or
/// `CosineProposal{}`.
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

/// `evaluate` as a function that holds a copy of `brdf`.
Evaluate evaluator(PreparedBrdf brdf);

SRBF_END
