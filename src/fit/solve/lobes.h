// Lobes as a separable least-squares problem, the interface of Levenberg-Marquardt and of the search.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/solve/gram.h"
#include "parallel.h"
#include "srbf/elementary.h"
#include "srbf/half.h"
#include "srbf/model.h"

namespace srbf {

/// Structure of the lobes of a fit.
struct LobeShape {
    PmForm form = PmForm::gaussian;
    int variates = 0;         ///< N
    bool axial = true;        ///< only centres at +z or −z
    bool reciprocal = false;  ///< a variate is a pair, ψ of (a, b) and of (b, a), with one centre and one bandwidth
    double finest = 0;        ///< least width of any factor of a lobe [rad]; 0: the limit of 16-bit floats

    int components() const { return axial ? 1 : 3; }             ///< C: weights per variate
    int directional() const { return variates * components(); }  ///< weights of all variates of a lobe
    int width() const { return directional() + features(form); }
};

/// The nonlinear parameters of J lobes of N variates. Lobe j is E_j = exp(Σ_n p_jn·(ψ_n − ẑ) + Σ_k κ_jk x_k − o_j): up
/// to a factor a product of Gaussian SRBFs with bandwidths |p_jn| and centres p_jn / |p_jn| and of the form's further
/// factors. o_j normalises its maximum over the rows to 1. An axial lobe has only the third component of p_jn. In a
/// reciprocal lobe ψ_n − ẑ is the sum over the pair.
struct Lobes {
    LobeShape shape;
    std::vector<double> angle;   ///< N: (a_n, b_n) = (cos, sin)
    std::vector<double> weight;  ///< J × (N C + F): p_j1, …, p_jN, κ_j1, …
    int count() const { return shape.variates ? int(weight.size()) / shape.width() : 0; }
    std::span<const double> of(int j) const {
        return {weight.data() + std::size_t(j * shape.width()), std::size_t(shape.width())};
    }
};
/// Lower and upper bound of weight n of a lobe.
struct Interval {
    double least, most;
};
inline Interval weight_range(int n, const LobeShape& shape) {
    const auto most = [&](double by_spacing) {
        return shape.finest > 0 ? std::min(double(k_half_max), by_spacing) : double(k_half_max);
    };
    if (const int k = n - shape.directional(); k >= 0) {
        const ExponentTerm& term = k_terms[std::size_t(k)];
        const double slope = term.is_slope ? most(1 / shape.finest) : double(k_half_max);
        return {std::max(term.least, -slope), std::min(term.most, slope)};
    }
    const double bandwidth = most(elementary::pow(shape.finest, -2));  // |p|, representable in 16 bits
    const double component = shape.axial ? bandwidth : bandwidth / std::sqrt(3.0);
    return {-component, component};
}

/// Σ w |f − Σ_j β_j E_j|² over C channels, over the rows of pairs, plus the squares of sums for radiances. β is
/// eliminated by non-negative least squares per channel. The variables are x = (angles, weights). With views the mean
/// error of their pixels is added, of which β is eliminated by Gauss-Newton steps.
class LobeProblem {
  public:
    /// `parallel`: loops over rows use several threads; the result does not depend on it.
    /// `log_peak_limit`: upper bound on the log of the coefficient of a lobe with peak 1.
    LobeProblem(const Rows& rows, const LobeShape& shape, bool parallel,
                double log_peak_limit = std::numeric_limits<double>::infinity());

    double loss(const Eigen::VectorXd& x);
    void linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g);
    Eigen::VectorXd lower(const Eigen::VectorXd& x) const { return bounds(x.size(), &Interval::least); }
    Eigen::VectorXd upper(const Eigen::VectorXd& x) const { return bounds(x.size(), &Interval::most); }

    /// Step bounds: half a weight plus 2, and half a radian, so that a lobe that is temporarily useless does not
    /// diverge.
    Eigen::VectorXd longest_step(const Eigen::VectorXd& x) const;

    // Results of the last call of `loss`:
    double delta_e();                                      ///< mean ΔE_ITP of the views' pixels
    const Eigen::MatrixXd& beta() const { return beta_; }  ///< J × C, in multiples of `scale`
    const Eigen::MatrixXd& gram() const { return gram_; }  ///< E·E
    double scale() const { return rows_.scale; }
    const std::vector<double>& offset() const { return offset_; }  ///< o_j

    /// The one of `candidates` that would lower the loss most if added; valid after `loss`.
    std::vector<double> best_addition(const std::vector<std::vector<double>>& candidates);

    static Eigen::VectorXd pack(const Lobes& lobes);
    Lobes unpack(const Eigen::VectorXd& x) const;

  private:
    Eigen::VectorXd bounds(Eigen::Index size, double Interval::*side) const;
    float* lobe(std::size_t block, int j) { return &lobe_[(block * std::size_t(lobes_) + std::size_t(j)) * k_block]; }
    float* feature(std::size_t block, int n) {
        return &feature_[(block * std::size_t(shape_.width() + shape_.directional()) + std::size_t(n)) * k_block];
    }
    std::size_t channels() const { return rows_.y.size(); }
    float* rest(std::size_t block, std::size_t c) { return &rest_[(block * channels() + c) * k_block]; }
    bool observes_radiance(std::size_t block) const { return block >= rows_.blocks; }
    /// A chunk consists of k_chunk blocks of pairs, or of the blocks of a radiance, or of a block of views.
    std::size_t chunks_of_pairs() const { return (rows_.blocks + k_chunk - 1) / k_chunk; }
    std::size_t chunks() const { return chunks_of_pairs() + rows_.radiances; }
    std::size_t whole_chunks() const { return chunks() + rows_.whole_blocks() - rows_.first_view_block(); }
    template <typename Body> void for_each(std::size_t count, const Body& body) const {
        if (parallel_)
            parallel_for(count, body);
        else
            for (std::size_t i = 0; i < count; ++i) body(i);
    }
    template <typename Body> void for_chunks(std::size_t count, const Body& body) const;
    /// For each chunk of pairs `count` sums, to which `of_pairs(block, sums)` adds those of a block; for each radiance the
    /// sums of columns over its blocks, `of_radiance(begin, end)`.
    template <typename OfPairs, typename OfRadiance>
    std::vector<std::vector<double>> sums_of_chunks(std::size_t count, const OfPairs& of_pairs,
                                                    const OfRadiance& of_radiance) const;

    /// The sums over rows of which `linearise` makes its equations, over pairs and, as products of sums, over radiances.
    struct DerivativeSums {
        Eigen::Index angle_sums, factors;  ///< S; W + 1
        double unit;                       ///< of the coefficients in all that follows: A and R have it once, U twice
        Eigen::MatrixXd in_channel, across_channels;  ///< channels × S; its square, S × S
        std::vector<double> products;                 ///< (E_j E_k) · (s_i s_l), over pairs
        Eigen::MatrixXd of_radiances;                 ///< of the sums of E_j s_i
        /// of the columns of angles, and of the residuals, with lobes and columns of angles
        Eigen::MatrixXd of_angle, of_rest;
        Eigen::MatrixXd with_lobe;  ///< of E_j U_nj and E_j R_j, J × (N + 1), with the factors of weights
        /// (E_j s_i) · (E_k s_l), where factor 0 is 1, but not both.
        double product(Eigen::Index j, Eigen::Index i, Eigen::Index k, Eigen::Index l) const {
            return products[std::size_t(pair_index(j, k) * (count_of_pairs(factors) - 1) + pair_index(i, l) - 1)] +
                   of_radiances(j * factors + i, k * factors + l);
        }
        /// Unordered pairs of 0..n−1, each with itself too: (0,0), (1,0), (1,1), (2,0), …
        static constexpr Eigen::Index count_of_pairs(Eigen::Index n) { return n * (n + 1) / 2; }
        static constexpr Eigen::Index pair_index(Eigen::Index a, Eigen::Index b) {
            return a < b ? pair_index(b, a) : count_of_pairs(a) + b;
        }
    };
    DerivativeSums sums_of_derivatives(const Eigen::VectorXd& x);

    // Of pixels:
    float* moment(std::size_t block, std::size_t column) {
        const auto of_lobe = std::size_t(1 + shape_.width() + shape_.directional());
        return &moment_[(block * std::size_t(lobes_) * of_lobe + column) * k_block];
    }
    /// Sets the moments of all pixels: Σ light E_j, in column j; with `all` also Σ light E_j times each feature, in J +
    /// j (width + directional) + feature.
    void take_moments(bool all);
    /// Of a block of pixels; valid until the thread's next call.
    Pixels::Colours colours(const Eigen::MatrixXd& beta, std::size_t block);
    /// Second-order terms of the sum in the coefficients, in the order of β's columns.
    struct Coefficients {
        Coefficients(Eigen::Index variables, Eigen::Index count)
            : H(Eigen::MatrixXd::Zero(count, count)),
              across(Eigen::MatrixXd::Zero(variables, count)),
              g(Eigen::VectorXd::Zero(count)) {}
        Eigen::MatrixXd H, across;       ///< Hessian, and with the variables
        Eigen::VectorXd g;               ///< half the gradient
        std::vector<Eigen::Index> free;  ///< strictly between their bounds
        /// Changes the variables' Hessian and gradient to those of a sum to which these coefficients adapt.
        void eliminate(Eigen::MatrixXd& of_x, Eigen::VectorXd& by_x) const;
    };
    /// The pixels' part of the loss for coefficients β, and its terms in them.
    double pixel_loss(const Eigen::MatrixXd& beta, Coefficients& adapting);
    /// Improves β. G: Gram matrix of the lobes and the pairs' data.
    void fit_to_pixels(const Eigen::MatrixXd& G);
    /// Adds the pixels' terms in the variables and coefficients.
    void add_pixels(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g, Coefficients& adapting);
    /// add(variable, derivative of log β_j by it) for a coefficient at its upper bound.
    template <typename Add> void for_limit(const Eigen::VectorXd& x, int j, const Add& add) const;

    const Rows& rows_;
    LobeShape shape_;
    int lobes_ = 0;
    bool parallel_;
    double log_peak_limit_;
    Aligned<float> lobe_, feature_,
        /// blocks × (J, width + directional, C) × k_block: E_j; factors of the weights, d(ψ−ẑ)/dangle; residuals
        rest_;
    Aligned<float> moment_;  ///< pixel blocks × columns × k_block
    double of_pixels_ = 0;   ///< their part of the last loss
    std::vector<double> offset_;
    Eigen::MatrixXd beta_, gram_;  ///< J × C; E·E
    Eigen::VectorXd beta_limit_;   ///< J: bound on β from the bound on peaks
};

/// Log of the factor from β_j in the problem's units to the coefficient of a lobe with peak 1.
double log_peak_factor(std::span<const double> of_lobe, const LobeShape& shape, double offset);
/// Colours of a block of pixels, Σ_j β_jc values[j], in `columns`.
Pixels::Colours combined(const Eigen::MatrixXd& beta, std::span<const float* const> values, Aligned<float>& columns,
                         std::size_t count = k_block);
/// p_n from the weights of a lobe.
Vec3d vector_of(std::span<const double> of_lobe, const LobeShape& shape, int n);

template <typename Add> void LobeProblem::for_limit(const Eigen::VectorXd& x, int j, const Add& add) const {
    const int N = shape_.variates, W = shape_.width(), C = shape_.components();
    const double factor = shape_.reciprocal ? 2 : 1;
    for (int n = 0; n < N; ++n) {
        const Vec3d p = vector_of({&x[N + j * W], std::size_t(W)}, shape_, n);
        const double bandwidth = elementary::hypot(p.x, p.y, p.z);
        if (bandwidth == 0) continue;
        const Eigen::Index last = N + j * W + (n + 1) * C - 1;  // index of p_z
        add(last, factor * (1 - p.z / bandwidth));
        if (shape_.axial) continue;
        add(last - 2, -factor * p.x / bandwidth);
        add(last - 1, -factor * p.y / bandwidth);
    }
}

}  // namespace srbf
