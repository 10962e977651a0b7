// The lobes of one sampled view as pixels of pictures see them.
#pragma once
#include <Eigen/Dense>

#include "fit/views/view_problem.h"

namespace srbf {

/// The loss of a `ViewProblem` plus share × the error of each of the view's `Pixels`. It is not quadratic in the
/// coefficients and couples the channels, so that these are variables too, after those of the lobes if these are not
/// still: β_jc at 3 j + c, of lobes with a largest value of 1 on the rows at the start.
class ViewInPictures {
  public:
    /// Uses the working memory of `problem`.
    explicit ViewInPictures(ViewProblem& problem) : of_(problem) {}

    /// What each pixel costs if all cost `importance` times as much as the lobes x of `problem`, whose loss it has just
    /// computed, for these; 0 if they have no error.
    double share(const Eigen::VectorXd& x, double loss, double importance);

    /// About the lobes x and their coefficients, of which `problem` has just computed the loss. `share`: of each pixel.
    /// If `only_coefficients`, the lobes remain, and the coefficients are the only variables.
    Eigen::VectorXd start(const Eigen::VectorXd& x, double share, bool only_coefficients = false);

    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const;
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const;
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const;

  private:
    Eigen::Index of_lobes() const { return only_coefficients_ ? 0 : Eigen::Index(of_.lobes_) * of_.per_lobe_; }
    const ViewRows::Seen& seen() const { return of_.view_->seen; }
    std::size_t blocks() const { return seen().directions.blocks; }
    float* part(Aligned<float>& of, std::size_t column, std::size_t block) const {
        return &of[(block * (of.size() / (blocks() * k_block)) + column) * k_block];
    }
    /// Evaluates the lobes at x in the pixels.
    void see(const Eigen::VectorXd& lobes);
    ViewProblem& of_;
    bool only_coefficients_ = false;
    double share_ = 0;  ///< of each pixel
    std::vector<double> offset_;
    Aligned<float> exponent_, value_;  ///< blocks × J × k_block
    std::vector<PixelSlopes> slopes_;  ///< of each block of pixels, at the last loss
};

}  // namespace srbf
