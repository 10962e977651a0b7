// The fit of lobes to lit views.
#pragma once
#include "extras/environment/lit_views.h"

namespace SRBF_NAMESPACE {

/// The lobes' parameters x = (p, r), of each lobe except the first, for all views. If `fixed`, r is the same for all.
class LobeTracks {
  public:
    LobeTracks(const std::vector<LitView>& views, const BlurredKernels& kernels, int lobes, bool fixed, int threads);
    const Eigen::VectorXd& operator[](std::size_t view) const { return x_[view]; }

  private:
    Eigen::VectorXd best_of_starts(const LitView& view, int lobes) const;
    Eigen::VectorXd refine(std::size_t v, Eigen::VectorXd x, const Eigen::VectorXd& near) const;
    void sweep();
    void search_roughnesses();

    const std::vector<LitView>& views_;
    const BlurredKernels& kernels_;
    bool fixed_;
    int threads_;
    std::vector<Eigen::VectorXd> x_;
};

/// The fractions of the lobes after the first for all views: one row for each view and lobe, with R, G, B. They
/// minimise the squared errors plus the squared differences between neighbours.
Eigen::MatrixXd fractions_of(const std::vector<LitView>& views, const BlurredKernels& kernels,
                             const LobeTracks& tracks);

}  // namespace
