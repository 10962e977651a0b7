// The fit of one sampled view's lobes as a separable least-squares problem.
#pragma once
#include <Eigen/Dense>

#include "brdf/directions.h"
#include "models/pm/solve/coefficients.h"
#include "models/su/view_lobes.h"

namespace SRBF_NAMESPACE {

/// The nonlinear parameters of a lobe.
struct ViewLobe {
    Vec3d centre;
    double bandwidth = 0;
};
inline constexpr double k_min_bandwidth = 1e-3;  ///< lower bound in fits: the lobe is constant within 0.2 %

/// The weighted measurement of one sampled view.
struct ViewRows {
    DirectionRows directions;
    Aligned<float> root_weight;       ///< √w, Σ w = 1; 0 where nothing was measured
    std::array<Aligned<float>, 3> y;  ///< √w f / scale for each channel; their squares sum to 1
    /// For each radiance to be matched, a column: Σ light √w f / scale over the rows is the reflected radiance under a
    /// light, scaled so that an error of 1 adds 1 to the loss. Light is 0 where nothing was measured.
    std::vector<Aligned<float>> lights;
    double scale = 0;  ///< 0 if there are no data
    /// Upper bound on a lobe's maximum over the hemisphere times the cosine there, divided by scale, for each channel.
    /// Smaller cosines count as `min_cosine`.
    std::array<double, 3> largest{};
    double min_cosine = 0;
};

/// Minimises Σ w |f − Σ_j β_j G_j|² / Σ w |f|² over the rows of a view, plus the squared errors of its radiances, with
/// J lobes G_j normalised to a largest value of 1 on the rows. The coefficients β are eliminated. The variables x of
/// each lobe are two shifts u along the tangents t of its initial centre, ξ = normalize(ξ_0 + u_1 t_1 + u_2 t_2), and
/// log λ.
class ViewProblem {
  public:
    explicit ViewProblem(int lobes);

    /// Begins with a view, which must outlive this, and initial lobes. Returns their x, with shifts 0.
    Eigen::VectorXd start(const ViewRows& view, std::span<const ViewLobe> lobes);
    std::vector<ViewLobe> lobes(const Eigen::VectorXd& x) const;

    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const;
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const;
    /// A lobe moves by at most 1.5 of its widths and half a radian; its bandwidth changes by at most a factor of e.
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const;

    // Results of the last call of `loss`:
    /// Coefficients of lobes with peak 1 [1/sr].
    std::vector<std::array<double, 3>> coefficients() const;
    /// For each lobe, an estimate of the increase of the loss if it is dropped and the others' β adapt.
    std::vector<double> cost_of_dropping() const;

  private:
    static constexpr int k_variables = 3;  ///< number of variables of a lobe
    struct Frame {
        Vec3d centre, along[2];
    };
    /// Repeats bounds for the variables of each lobe.
    Eigen::VectorXd for_each_lobe(double shift, double log_bandwidth) const;
    MovingLobe moving_lobe(const Eigen::VectorXd& x, int j) const;
    /// Upper bounds on the coefficients of a lobe whose largest exponent on the rows is `max`.
    Eigen::RowVector3d coefficient_limits(const MovingLobe& lobe, double max) const;
    std::size_t blocks() const { return view_->directions.blocks; }
    // Columns of a block: exponents and values of lobe j, derivatives by variable i, residuals of channel c.
    float* exponent(std::size_t block, Eigen::Index j) { return &exponent_[offset(block, j, lobes_)]; }
    float* value(std::size_t block, Eigen::Index j) { return &value_[offset(block, j, lobes_)]; }
    float* derivative(std::size_t block, Eigen::Index i) {
        return &derivative_[offset(block, i, k_variables * lobes_)];
    }
    float* residual_of(std::size_t block, Eigen::Index c) { return &residual_[offset(block, c, 3)]; }
    static std::size_t offset(std::size_t block, Eigen::Index column, int columns) {
        return (block * std::size_t(columns) + std::size_t(column)) * k_block;
    }
    /// The Gram matrix of columns, and of their sums under each light. `add_columns(block, columns)` appends the
    /// columns.
    template <typename AddColumns> Eigen::MatrixXd gram(std::size_t count, const AddColumns& add_columns);
    double loss_with_residuals();

    const ViewRows* view_ = nullptr;
    int lobes_;
    std::vector<Frame> frame_;
    Aligned<float> exponent_, value_, derivative_, residual_;
    std::vector<double> log_scale_;  ///< the largest exponent of each lobe on the rows, by which it is normalised
    Eigen::MatrixXd lit_;            ///< sums of columns under lights in the last call of `gram`, columns × lights
    Coefficients coefficients_;
};

}  // namespace
