// The lobes of one sampled view as a separable least-squares problem of its pairs and of its pixels in pictures.
#pragma once
#include <Eigen/Dense>

#include "models/pm/solve/coefficients.h"
#include "models/su/view_lobes.h"

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

/// Lobes on the directions of pairs or pixels: columns of each block.
class LobeColumns {
  public:
    /// Of `lobes` lobes with so many variables, which have these weights.
    void take(const DirectionRows& directions, const Aligned<float>& weight, int lobes, int variables);
    /// The largest exponent of lobe j, which is `lobe` now.
    double take_exponents(int j, const MovingLobe& lobe);
    void exponentiate(int j, double offset);
    void derive(int j, const MovingLobe& lobe);
    const float* value(std::size_t block, Eigen::Index j) const { return &value_[at(block, j, lobes_)]; }
    /// By variable i of all lobes'.
    const float* derivative(std::size_t block, Eigen::Index i) const {
        return &derivative_[at(block, i, lobes_ * variables_)];
    }

  private:
    static std::size_t at(std::size_t block, Eigen::Index column, int columns) {
        return (block * std::size_t(columns) + std::size_t(column)) * k_block;
    }
    const DirectionRows* directions_ = nullptr;
    const Aligned<float>* weight_ = nullptr;
    int lobes_ = 0, variables_ = 0;
    Aligned<float> exponent_, value_, derivative_;  ///< blocks × (J, J, J × variables) × k_block
};

/// Σ w |f − Σ_j β_j G_j|² / Σ w |f|² over the rows of a view, the squared errors of the radiances, and share × the error
/// of each of its pixels, with J lobes G_j normalised to a largest value of 1 on the rows. `Coefficients` are eliminated.
/// The variables x of each lobe are two shifts u along the tangents t of its initial centre, ξ = normalize(ξ_0 + u_1 t_1 +
/// u_2 t_2), log λ, and the shape if there is one. At 0 the derivative by the shape jumps: a fit stays on the side of 0
/// on which it begins.
class ViewProblem {
  public:
    /// `shaped`: lobes have shapes other than 0.
    explicit ViewProblem(int lobes, bool shaped = false);

    /// Lobes of `view`, which must outlive this, with pixels of this `share`; x has these lobes, with shifts 0.
    Eigen::VectorXd start(const ViewRows& view, std::span<const ViewLobe> lobes, double share = 0);
    /// The lobes at x. A shape that ended at 0 has the sign of the other side, for the next fit to try.
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
    /// What pixels of share 1 would add to the loss at x.
    double pixel_errors(const Eigen::VectorXd& x);

  private:
    struct Frame {
        Vec3d centre, along[2];
    };
    bool shaped() const { return variables_ == 4; }
    double shape(const Eigen::VectorXd& x, int j) const { return shaped() ? x[variables_ * j + 3] : 0; }
    double least_shape(int j) const;  ///< −α at most
    /// Lobe j at x.
    MovingLobe moving(const Eigen::VectorXd& x, int j) const;
    /// Upper bounds of the coefficients of a lobe whose largest exponent on the rows is `most`.
    Eigen::RowVector3d limit_of(const MovingLobe& lobe, double most) const;
    void evaluate_in_pixels(const Eigen::VectorXd& x);
    PixelTerm pixel_term(double share) const;
    std::size_t blocks() const { return view_->directions.blocks; }
    float* rest(std::size_t block, Eigen::Index c) { return &rest_[(3 * block + std::size_t(c)) * k_block]; }
    /// The Gram matrix of columns, which `of_block` sets, and of their sums under each light.
    template <typename OfBlock> Eigen::MatrixXd gram(std::size_t columns, const OfBlock& of_block);
    double loss_with_residuals();

    const ViewRows* view_ = nullptr;
    double share_ = 0;
    Vec3f across_;  ///< the tangent across the plane of the view and the normal
    int lobes_, variables_;
    std::vector<Frame> frame_;
    LobeColumns on_rows_, on_pixels_;
    Aligned<float> rest_;         ///< residuals: blocks × 3 × k_block
    std::vector<double> offset_;  ///< logarithms of the factors 1 / G_j was given
    Eigen::MatrixXd lit_;         ///< columns × lights, of the last call of `gram`
    Coefficients coefficients_;
};

}  // namespace srbf
