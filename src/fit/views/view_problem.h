// The lobes of one sampled view as a separable least-squares problem.
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
inline constexpr double k_most_depth = 64;
/// The largest α, relative to that of a round lobe of half vectors, (1 − ξ·wv) / (1 + ξ·wv). Where view and centre are
/// close nothing tells across, and an α that differs from view to view would be seen as rings.
inline constexpr double k_most_narrowing = 2;

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
    /// The view's pixels in pictures: rows of which each is a direction to a single light. Others are dark.
    struct Seen {
        DirectionRows directions;
        Aligned<float> exposure;  ///< colour of the pixel over f / scale; 0 where there is none
        Pixels pixels;
    } seen;
    /// Upper bound per lobe and channel: its maximum over the hemisphere times the cosine there, f / scale. Smaller
    /// cosines are replaced by the least cosine.
    std::array<double, 3> largest{};
    double least_cosine = 0;
};

/// Σ w |f − Σ_j β_j G_j|² / Σ w |f|² of one view, with β eliminated by non-negative least squares per channel. The
/// variables of each lobe are two shifts u along the tangents t of its initial centre, ξ = normalize(ξ_0 + u_1 t_1 +
/// u_2 t_2), log λ, and the shape if there is one. At 0 the derivative by the shape jumps: a fit stays on the side of 0
/// on which it begins.
class ViewProblem {
  public:
    /// `shaped`: lobes have shapes other than 0.
    explicit ViewProblem(int lobes, bool shaped = false);

    /// The problem of `view`, which must outlive it, linearised about these lobes: x has these of each lobe, with
    /// shifts 0.
    Eigen::VectorXd start(const ViewRows& view, std::span<const ViewLobe> lobes);
    /// The lobes at x. A shape that ended at 0 has the sign of the other side, for the next fit to try.
    std::vector<ViewLobe> lobes(const Eigen::VectorXd& x) const;

    int count() const { return lobes_; }  ///< J
    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const;
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const;
    /// Step bounds: a lobe moves by at most its width and at most half a radian; its bandwidth changes by at most a
    /// factor of e.
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const;

    // Results of the last call of `loss`, or of the adoption of coefficients:
    /// β_jc of G_j with peak 1 [1/sr].
    double coefficient(int j, int c) const;
    /// First-order estimate of the increase of the loss if lobe j is dropped and the others' β adapt.
    std::vector<double> cost_of_dropping() const;

  private:
    friend class ViewInPictures;
    double least_shape(int j) const;  ///< −α at most
    MovingLobe moving(const Eigen::VectorXd& x, int j) const;
    double shape(const Eigen::VectorXd& x, int j) const { return per_lobe_ == 4 ? x[per_lobe_ * j + 3] : 0; }
    /// Evaluates the lobes at x, in `offset_` the logarithms of their largest values, and the bounds of coefficients.
    void place(const Eigen::VectorXd& x);
    /// Evaluates the lobes and sets the products of their values with each other and with the measurement.
    void take_products();
    /// The Gram matrix of the derivatives by x, the values and the residuals of the channels.
    Eigen::MatrixXd gram_of_derivatives(const Eigen::VectorXd& x);
    /// The loss with the present coefficients.
    double loss_of_coefficients();
    float* part(Aligned<float>& of, std::size_t column, std::size_t block) const {
        return &of[(block * (of.size() / (blocks() * k_block)) + column) * k_block];
    }
    std::size_t blocks() const { return view_->directions.blocks; }
    /// Adds to the Gram matrix of `columns` those of their sums under each light; `of_block` sets the columns.
    template <typename OfBlock> Eigen::MatrixXd gram(std::size_t columns, const OfBlock& of_block);

    const ViewRows* view_ = nullptr;
    Vec3f across_;          ///< the tangent across the plane of the view and the normal
    int lobes_, per_lobe_;  ///< J, variables of each
    struct Frame {
        Vec3d centre, along[2];
    };
    std::vector<Frame> frame_;
    Aligned<float> exponent_, value_, derivative_, rest_;  ///< blocks × (J, J, variables, 3) × k_block
    std::vector<double> offset_;
    Eigen::MatrixXd lit_;  ///< columns × lights, of the last call of `gram`
    // For lobes normalised to a maximum of 1 on the rows:
    Eigen::MatrixXd beta_, limit_;      ///< J × 3
    Eigen::MatrixXd gram_, with_data_;  ///< J × J; J × 3
};

}  // namespace srbf
