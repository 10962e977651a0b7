// Tracks: lobes of one view, followed through all others.
#pragma once
#include <cstdint>
#include <functional>

#include "models/su/fit_view.h"
#include "models/su/sampled_views.h"

namespace srbf {

struct TrackFits {
    std::vector<ViewFit> view;  ///< empty where there is no data
    double share = 0;           ///< what a pixel of any view costs
};
/// The fit of each view to its pairs and pixels. Neighbouring views that are fitted each for itself often have different
/// lobes of like loss, and the edge between them shows as a ring. So the fits of a few views are followed through all
/// others, smoothed by taking means over the views nearby, and each view takes one of these tracks: those with the least
/// sum of the losses and of the visible errors that edges between neighbours are. `done` is told how much has been done,
/// the number of views in all; it returns false to stop, and all fits are empty then.
TrackFits fit_tracks(const SampledViews& views, int lobes, bool shaped, std::uint64_t seed,
                     const std::function<bool(double)>& done);
/// The number of tracks, by which the work of `fit_tracks` is measured.
inline constexpr std::size_t k_tracks = 5;

/// The path a_0, a_1, … that minimises Σ cost_i(a_i) + Σ between_i(a_i, a_i+1), the cost of an edge from i to i+1, by
/// Viterbi's algorithm.
std::vector<std::size_t> viterbi_path(std::span<const Eigen::VectorXd> cost, std::span<const Eigen::MatrixXd> between);
/// The path with its larger edges faded: where what either side shows can be continued across an edge, more and more
/// of at most `most` views take the other side's, in turn, so that views interpolated or seen together show a mean of
/// both.
std::vector<std::size_t> faded(const std::vector<std::size_t>& path, std::span<const Eigen::VectorXd> cost,
                               std::span<const Eigen::MatrixXd> between, std::size_t most);

}  // namespace srbf
