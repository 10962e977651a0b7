// The lobes of one sampled view as a least-squares problem of its pairs and of its pixels in pictures.
#pragma once
#include "fit/views/view_problem.h"

namespace srbf {

/// The loss of a `ViewProblem` plus share × the error of each of the view's `Pixels`. It is not quadratic in the
/// coefficients and couples the channels, so that these are variables too, after those of the lobes unless these are
/// fixed: β_jc at 3 j + c, of lobes that remain normalised as at the start.
class ViewWithPixels {
  public:
    /// `pairs`, whose last loss was at these lobes x, is the start, and evaluates the lobes from then on. `share`: of
    /// each pixel. If `only_coefficients`, the lobes are fixed, and the coefficients are the only variables.
    ViewWithPixels(ViewProblem& pairs, const Eigen::VectorXd& x, double share, bool only_coefficients = false);
    /// The variables at the start.
    Eigen::VectorXd start(const Eigen::VectorXd& x) const;

    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const;
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const;
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const;

    /// The coefficients of the last loss, of lobes with peak 1 [1/sr].
    std::vector<std::array<double, 3>> coefficients() const { return lobes_.coefficients(beta_); }

  private:
    const ViewPixels& pixels() const { return lobes_.view().pixels; }
    std::size_t blocks() const { return pixels().directions.blocks; }
    float* part(Aligned<float>& of, std::size_t j, std::size_t block) const {
        return &of[(block * std::size_t(lobes_.count()) + j) * k_block];
    }
    /// Evaluates the lobes at x in the pixels.
    void evaluate_in_pixels(const Eigen::VectorXd& x);
    /// Add the terms of the pairs, and the upper triangle of those of the pixels.
    void add_pairs(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    void add_pixels(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);

    EvaluatedLobes& lobes_;
    bool only_coefficients_;
    Eigen::Index of_lobes_;  ///< how many variables the lobes have, 0 if they are fixed
    double share_;
    Eigen::MatrixXd beta_;  ///< J × 3
    std::vector<double> offset_;
    Aligned<float> exponent_, value_;  ///< blocks × J × k_block
    std::vector<PixelSlopes> slopes_;  ///< of each block of pixels, at the last loss
};

}  // namespace srbf
