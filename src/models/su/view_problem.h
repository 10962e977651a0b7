// The lobes of one sampled view as a separable least-squares problem of its pairs.
#pragma once
#include <Eigen/Dense>

#include "brdf/frame.h"
#include "models/pm/solve/coefficients.h"
#include "models/su/view_lobes.h"

namespace srbf {

/// The nonlinear parameters of a lobe.
struct ViewLobe {
    Vec3d centre;
    double bandwidth = 0;
};
inline constexpr double k_least_bandwidth = 1e-3;  ///< lower bound in a fit: constant within 0.2 %

/// The weighted measurement of one sampled view.
struct ViewRows {
    DirectionRows directions;
    Aligned<float> root_weight;       ///< √w, Σ w = 1; 0 where nothing was measured
    std::array<Aligned<float>, 3> y;  ///< √w f / scale for each channel; their squares sum to 1
    /// Each radiance that is also matched has a row: Σ light √w f / scale over the rows is the reflected radiance under some
    /// light, in units of which an error of 1 adds 1 to the loss. Where nothing was measured it is dark.
    std::vector<Aligned<float>> lights;
    double scale = 0;  ///< 0: no data to fit
    /// Upper bound per lobe and channel: its maximum over the hemisphere times the cosine there, f / scale. Smaller
    /// cosines are replaced by the least cosine.
    std::array<double, 3> largest{};
    double least_cosine = 0;
};

/// Σ w |f − Σ_j β_j G_j|² / Σ w |f|² over the rows of a view, and the squared errors of its radiances, with J lobes G_j
/// normalised to a largest value of 1 on the rows. `Coefficients` are eliminated. The variables x of each lobe are two shifts u along the tangents t of its initial
/// centre, ξ = normalize(ξ_0 + u_1 t_1 + u_2 t_2), and log λ.
class ViewProblem {
  public:
    explicit ViewProblem(int lobes);

    /// Lobes of `view`, which must outlive this; x has these lobes, with shifts 0.
    Eigen::VectorXd start(const ViewRows& view, std::span<const ViewLobe> lobes);
    /// The lobes at x.
    std::vector<ViewLobe> lobes(const Eigen::VectorXd& x) const;

    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    /// Bounds of a step from x.
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const;
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const;
    /// Step bounds: a lobe moves by at most its width and at most half a radian; its bandwidth changes by at most a
    /// factor of e.
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const;

    // Results of the last call of `loss`:
    /// Coefficients of lobes with peak 1 [1/sr].
    std::vector<std::array<double, 3>> coefficients() const;
    /// First-order estimate of the increase of the loss if lobe j is dropped and the others' β adapt.
    std::vector<double> cost_of_dropping() const;

  private:
    static constexpr int k_variables = 3;  ///< of a lobe
    struct Frame {
        Vec3d centre, along[2];
    };
    /// A bound or a step of every lobe.
    Eigen::VectorXd for_each_lobe(double shift, double log_bandwidth) const;
    /// Lobe j at x.
    MovingLobe moving(const Eigen::VectorXd& x, int j) const;
    /// Upper bounds of the coefficients of a lobe whose largest exponent on the rows is `most`.
    Eigen::RowVector3d limit_of(const MovingLobe& lobe, double most) const;
    std::size_t blocks() const { return view_->directions.blocks; }
    /// A block has the exponents of lobe j, its values, and their derivatives by variable i of all lobes'.
    float* exponent(std::size_t block, Eigen::Index j) { return &exponent_[at(block, j, lobes_)]; }
    float* value(std::size_t block, Eigen::Index j) { return &value_[at(block, j, lobes_)]; }
    float* derivative(std::size_t block, Eigen::Index i) { return &derivative_[at(block, i, k_variables * lobes_)]; }
    float* rest(std::size_t block, Eigen::Index c) { return &rest_[at(block, c, 3)]; }
    static std::size_t at(std::size_t block, Eigen::Index column, int columns) {
        return (block * std::size_t(columns) + std::size_t(column)) * k_block;
    }
    /// The Gram matrix of columns, which `of_block` sets, and of their sums under each light.
    template <typename OfBlock> Eigen::MatrixXd gram(std::size_t columns, const OfBlock& of_block);
    double loss_with_residuals();

    const ViewRows* view_ = nullptr;
    int lobes_;
    std::vector<Frame> frame_;
    Aligned<float> exponent_, value_, derivative_, rest_;  ///< rest: residuals of the channels
    std::vector<double> offset_;                           ///< logarithms of the factors 1 / G_j was given
    Eigen::MatrixXd lit_;                                  ///< columns × lights, of the last call of `gram`
    Coefficients coefficients_;
};

}  // namespace srbf
