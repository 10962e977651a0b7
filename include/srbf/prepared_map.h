// A map of texels that share their lobes, ready for a renderer.
#pragma once
#include <memory>

#include "srbf/map.h"
#include "srbf/prepared.h"

SRBF_BEGIN

/// A map (map.h) ready for a renderer. Copies share its data. All functions may be called from several threads at once.
class PreparedMap {
  public:
    struct Contents;
    explicit PreparedMap(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {}

    friend PreparedBrdf brdf_at(const PreparedMap& map, Vec2f uv);

  private:
    std::shared_ptr<const Contents> contents_;
};

/// Prepares a map, in approximately 0.1 s per lobe.
PreparedMap prepare_map(const TexelMap& map, const ProposeOptions& options = {});
/// The BRDF at (u, v) of the map, which repeats. Its coefficients are interpolated between the four nearest texels
/// (bilinear), where texel X, Y is at ((X + ½) / width, (Y + ½) / height). It is sampled by a mixture. Its weights at
/// each node are the mean of the weights w_jk of the lobes' own mixtures, each in proportion to the light that the lobe
/// reflects: Σ_j β_j a_j w_jk / Σ_j β_j a_j, with β_j in luminance and a_j the albedo of lobe j. Stretch, power and
/// anisotropy axis come from the mean over the map. Takes a few microseconds.
PreparedBrdf brdf_at(const PreparedMap& map, Vec2f uv);

SRBF_END
