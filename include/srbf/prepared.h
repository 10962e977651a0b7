// A model prepared for being asked pair by pair: level 3.
#pragma once
#include <cstring>
#include <memory>
#include <span>

#include "srbf/sampling.h"

namespace srbf {

/// A model ready to be asked pair by pair: its numbers in the order in which evaluation takes them, so that the lobes of
/// one pair fill a vector. It owns what it holds, and copies share it: neither the model that it was made from nor another
/// copy need stay. It may be asked from several threads at once, and no answer depends on whether the processor flushes
/// subnormal numbers to 0.
class PreparedModel {
  public:
    struct Contents;
    explicit PreparedModel(std::shared_ptr<const Contents> contents);
    const Contents& contents() const { return *contents_; }
    /// What `sample` draws from; it refers to what this holds.
    const Proposal& proposal() const;

    friend Rgb value(const PreparedModel& model, const Vec3f& wl, const Vec3f& wv);

  private:
    std::shared_ptr<const Contents> contents_;
    const void* model_;  // in them
    void (*value_)(const void* model, const Vec3f& wl, const Vec3f& wv, float* colour);
};

/// The model for its values; the light is drawn by the cosine.
PreparedModel prepare(const Model& model);
/// And for drawing the light by its own proposal, `propose(model, options)`, which takes some 15 ms to make.
PreparedModel prepare(const Model& model, const ProposeOptions& options);

/// f_r(wl, wv) [1/sr]: within 1e-4 of the model's `value` or 1e-6 of its peak; 0 below the horizon, and where a cosine is
/// subnormal.
inline Rgb value(const PreparedModel& model, const Vec3f& wl, const Vec3f& wv) {
    if (!above_horizon(wl, wv)) return {};
    alignas(16) float colour[4];
    model.value_(model.model_, wl, wv, colour);
    Rgb f;
    std::memcpy(&f, colour, sizeof f);  // as it was stored
    return f;
}
/// The same for spans of one length.
void evaluate(const PreparedModel& model, std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> f);
/// The same as a function, which holds a copy of `model`.
Evaluate evaluator(PreparedModel model);

/// Draws a direction to the light, and its density [1/sr], by the proposal.
Vec3f sample(const PreparedModel& model, Vec3f wv, Vec3f u);
float pdf(const PreparedModel& model, Vec3f wl, Vec3f wv);

}  // namespace srbf
