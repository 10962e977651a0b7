// The lobes of one sampled view on its rows: what a loss and its derivatives are made of.
#pragma once
#include <Eigen/Dense>

#include "fit/views/view_lobes.h"

namespace srbf {

/// The nonlinear parameters of a lobe.
struct ViewLobe {
    Vec3d centre;
    double bandwidth = 0;
    double shape = 0;  ///< τ or −α; the sign of 0 tells which of them a fit may raise
};
inline constexpr double k_least_bandwidth = 1e-3;  ///< lower bound in a fit: constant within 0.2 %
/// The largest τ: at 45° the lobe is 3e-12 of its value along the normal, less than any 16-bit float resolves.
inline constexpr double k_most_depth = 64;
/// The largest α, relative to that of a round lobe of half vectors, (1 − ξ·wv) / (1 + ξ·wv). Where view and centre are
/// close nothing tells across, and an α that differs from view to view would be seen as rings.
inline constexpr double k_most_narrowing = 2;

/// A view's pixels in pictures: rows of which each is a direction to a single light. Others are dark.
struct ViewPixels {
    DirectionRows directions;
    Aligned<float> exposure;  ///< colour of the pixel over f / scale; 0 where there is none
    Pixels reference;
};

/// The weighted measurement of one sampled view.
struct ViewRows {
    DirectionRows directions;
    Vec3f view{0, 0, 1};              ///< whose tangent across lobes are narrowed along
    Aligned<float> root_weight;       ///< √w, Σ w = 1; 0 where nothing was measured
    std::array<Aligned<float>, 3> y;  ///< √w f / scale for each channel; their squares sum to 1
    /// Of each radiance that is also matched: Σ light √w f / scale over the rows is the reflected radiance under some
    /// light, in units of which an error of 1 adds 1 to the loss. Where nothing was measured it is dark.
    std::vector<Aligned<float>> lights;
    double scale = 0;  ///< 0: no data to fit
    ViewPixels pixels;
    /// Upper bound per lobe and channel: its maximum over the hemisphere times the cosine there, f / scale. Smaller
    /// cosines are replaced by the least cosine.
    std::array<double, 3> largest{};
    double least_cosine = 0;
};

/// J lobes G_j of a view, on its rows normalised to a largest value of 1, with coefficients β_jc of each channel. The
/// variables x of each lobe are two shifts u along the tangents t of its initial centre, ξ = normalize(ξ_0 + u_1 t_1 +
/// u_2 t_2), log λ, and the shape if there is one. At 0 the derivative by the shape jumps: a fit stays on the side of 0
/// on which it begins.
class EvaluatedLobes {
  public:
    /// `shaped`: lobes have shapes other than 0.
    EvaluatedLobes(int lobes, bool shaped);

    /// Lobes of `view`, which must outlive this; x has these, with shifts 0.
    Eigen::VectorXd start(const ViewRows& view, std::span<const ViewLobe> lobes);
    /// The lobes at x. A shape that ended at 0 has the sign of the other side, for the next fit to try.
    std::vector<ViewLobe> lobes(const Eigen::VectorXd& x) const;
    /// Bounds of a step from x.
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const;
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const;
    /// Step bounds: a lobe moves by at most its width and at most half a radian; its bandwidth changes by at most a
    /// factor of e.
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const;
    /// Lobe j at x.
    MovingLobe moving(const Eigen::VectorXd& x, int j) const;

    int count() const { return lobes_; }          ///< J
    int variables() const { return variables_; }  ///< of each lobe
    const ViewRows& view() const { return *view_; }

    /// Evaluates the lobes at x.
    void evaluate(const Eigen::VectorXd& x);
    /// The same, normalised as at another x, of which these are the `offset`; false if a lobe has become too large.
    bool evaluate(const Eigen::VectorXd& x, const std::vector<double>& offset);

    // What follows is for the last x that was evaluated:
    const std::vector<double>& offset() const { return offset_; }    ///< logarithms of the factors 1 / G_j was given
    const Eigen::MatrixXd& limit() const { return limit_; }          ///< J × 3: upper bounds of β
    const Eigen::MatrixXd& gram() const { return gram_; }            ///< J × J: G · G
    const Eigen::MatrixXd& with_data() const { return with_data_; }  ///< J × 3: G · y
    /// Σ w |f − Σ_j β_j G_j|² / Σ w |f|², and the squared errors of the radiances.
    double loss_of(const Eigen::MatrixXd& beta);
    /// The Gram matrix of the derivatives by x, the values, and the channels' residuals of the last loss.
    Eigen::MatrixXd gram_of_derivatives(const Eigen::VectorXd& x);
    /// Coefficients of lobes with peak 1 [1/sr].
    std::vector<std::array<double, 3>> coefficients(const Eigen::MatrixXd& beta) const;

  private:
    struct Frame {
        Vec3d centre, along[2];
    };
    bool shaped() const { return variables_ == 4; }
    double shape(const Eigen::VectorXd& x, int j) const { return shaped() ? x[variables_ * j + 3] : 0; }
    double least_shape(int j) const;  ///< −α at most
    /// Sets the exponents of the lobes at x, `offset_` and `limit_`.
    void take_exponents(const Eigen::VectorXd& x);
    /// Upper bounds of the coefficients of a lobe whose largest exponent on the rows is `most`.
    Eigen::RowVector3d limit_of(const MovingLobe& lobe, double most) const;
    /// Sets the values of the lobes and their products with each other and with the measurement.
    void take_products();
    float* part(Aligned<float>& of, std::size_t column, std::size_t block) const {
        return &of[(block * (of.size() / (blocks() * k_block)) + column) * k_block];
    }
    std::size_t blocks() const { return view_->directions.blocks; }
    /// Adds to the Gram matrix of `columns` those of their sums under each light; `of_block` sets the columns.
    template <typename OfBlock> Eigen::MatrixXd gram(std::size_t columns, const OfBlock& of_block);

    const ViewRows* view_ = nullptr;
    Vec3f across_;  ///< the tangent across the plane of the view and the normal
    int lobes_, variables_;
    std::vector<Frame> frame_;
    Aligned<float> exponent_, value_, derivative_, residual_;  ///< blocks × (J, J, variables, 3) × k_block
    std::vector<double> offset_;
    Eigen::MatrixXd lit_;  ///< columns × lights, of the last call of `gram`
    Eigen::MatrixXd limit_, gram_, with_data_;
};

/// Row-major lower triangles of n columns, as from add_gram, as a symmetric matrix.
Eigen::MatrixXd symmetric(const std::vector<double>& triangle, Eigen::Index n);

}  // namespace srbf
