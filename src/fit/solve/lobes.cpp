#include "fit/solve/lobes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fit/solve/least_squares.h"
#include "parallel.h"
#include "srbf/elementary.h"

namespace srbf {
namespace {

constexpr float k_nothing = -std::numeric_limits<float>::infinity();

}  // namespace

LobeProblem::LobeProblem(const Rows& rows, const LobeShape& shape, bool parallel, double log_peak_limit)
    : rows_(rows),
      shape_(shape),
      parallel_(parallel),
      log_peak_limit_(log_peak_limit),
      feature_(rows.whole_blocks() * std::size_t(shape.width() + shape.directional()) * k_block),
      rest_(rows.whole_blocks() * rows.y.size() * k_block) {
    if (features(shape.form) == 0) return;
    for (std::size_t block = 0; block < rows_.whole_blocks(); ++block)
        further_features(rows_, block, features(shape.form), feature(block, shape.directional()));
}

Eigen::VectorXd LobeProblem::bounds(Eigen::Index size, double Interval::*side) const {
    const Interval angles{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Eigen::VectorXd b(size);
    b.head(shape_.variates).setConstant(angles.*side);
    for (Eigen::Index i = shape_.variates; i < size; ++i)
        b[i] = weight_range(int(i - shape_.variates) % shape_.width(), shape_).*side;
    return b;
}

Eigen::VectorXd LobeProblem::longest_step(const Eigen::VectorXd& x) const {
    Eigen::VectorXd longest = 0.5 * x.cwiseAbs().array() + 2;
    longest.head(shape_.variates).setConstant(0.5);
    return longest;
}

Eigen::VectorXd LobeProblem::pack(const Lobes& lobes) {
    Eigen::VectorXd x(Eigen::Index(lobes.angle.size() + lobes.weight.size()));
    std::copy(lobes.angle.begin(), lobes.angle.end(), x.begin());
    std::copy(lobes.weight.begin(), lobes.weight.end(), x.begin() + Eigen::Index(lobes.angle.size()));
    return x;
}

Lobes LobeProblem::unpack(const Eigen::VectorXd& x) const {
    const auto weights = x.begin() + shape_.variates;
    return {shape_, {x.begin(), weights}, {weights, x.end()}};
}

template <typename Body> void LobeProblem::for_chunks(std::size_t count, const Body& body) const {
    for_each(count, [&](std::size_t chunk) {
        if (chunk < chunks_of_pairs())
            return body(chunk, chunk * k_chunk, std::min((chunk + 1) * k_chunk, rows_.blocks));
        if (chunk >= chunks()) {
            const std::size_t block = rows_.first_view_block() + chunk - chunks();
            return body(chunk, block, block + 1);
        }
        const std::size_t begin = rows_.blocks + (chunk - chunks_of_pairs()) * rows_.radiance_blocks;
        body(chunk, begin, begin + rows_.radiance_blocks);
    });
}

template <typename OfPairs, typename OfRadiance>
std::vector<std::vector<double>> LobeProblem::sums_of_chunks(std::size_t count, const OfPairs& of_pairs,
                                                             const OfRadiance& of_radiance) const {
    std::vector<std::vector<double>> parts(chunks());
    for_chunks(chunks(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        if (observes_radiance(begin)) {
            parts[chunk] = of_radiance(begin, end);
            return;
        }
        parts[chunk].assign(count, 0.0);
        for (std::size_t block = begin; block < end; ++block) of_pairs(block, parts[chunk]);
    });
    return parts;
}

double LobeProblem::loss(const Eigen::VectorXd& x) {
    lobes_ = (int(x.size()) - shape_.variates) / shape_.width();
    const std::size_t J = std::size_t(lobes_), N = std::size_t(shape_.variates), W = std::size_t(shape_.width());
    lobe_.resize(rows_.whole_blocks() * J * k_block);
    offset_.assign(J, 0.0);
    std::vector<float> weight(J * W);
    for (std::size_t i = 0; i < J * W; ++i) weight[i] = float(x[Eigen::Index(N + i)]);

    std::vector<std::vector<float>> largest(whole_chunks(), std::vector<float>(J, k_nothing));
    for_chunks(whole_chunks(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        Aligned<float> swapped(shape_.reciprocal ? std::size_t(shape_.components()) * k_block : 0),
            swapped_by_angle(swapped.size());
        std::vector<const float*> s;
        for (std::size_t block = begin; block < end; ++block) {
            s.clear();
            for (int n = 0; n < shape_.variates; ++n) {
                const auto a = float(elementary::cos(x[n])), b = float(elementary::sin(x[n]));
                float *at = feature(block, n * shape_.components()),
                      *by_angle = feature(block, shape_.width() + n * shape_.components());
                const auto features = shape_.axial ? axial_feature : general_features;
                features(rows_, block, a, b, at, by_angle);
                if (!shape_.reciprocal) continue;
                features(rows_, block, b, a, swapped.data(), swapped_by_angle.data());
                for (std::size_t i = 0; i < swapped.size(); ++i) {
                    at[i] += swapped[i];
                    by_angle[i] -= swapped_by_angle[i];  // the angle of (b, a) is π/2 minus that of (a, b)
                }
            }
            for (int n = 0; n < shape_.width(); ++n) s.push_back(feature(block, n));
            for (int j = 0; j < lobes_; ++j) {
                const std::span<const float> of_lobe(&weight[std::size_t(j) * W], W);
                float& most = largest[chunk][std::size_t(j)];
                most = std::max(most, exponent(rows_, block, of_lobe, s, lobe(block, j)));
            }
        }
    });
    for (std::size_t j = 0; j < J; ++j) {
        float most = k_nothing;
        for (const auto& of_chunk : largest) most = std::max(most, of_chunk[j]);
        offset_[j] = double(most);
    }
    for_chunks(whole_chunks(), [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block)
            for (int j = 0; j < lobes_; ++j) exponentiate(rows_, block, float(offset_[std::size_t(j)]), lobe(block, j));
    });

    const std::size_t C = channels();
    const auto lobes_and_data = [&](std::size_t block) {
        std::vector<const float*> of_block;
        for (int j = 0; j < lobes_; ++j) of_block.push_back(lobe(block, j));
        for (const auto& y : rows_.y) of_block.push_back(&y[block * k_block]);
        return of_block;
    };
    const auto parts = sums_of_chunks((J + C) * (J + C),
                                      [&](std::size_t block, std::vector<double>& products) {
                                          add_gram(lobes_and_data(block), products.data(), rows_.rows_in(block));
                                      },
                                      [&](std::size_t begin, std::size_t end) {
                                          std::vector<double> whole(J + C);
                                          for (std::size_t block = begin; block < end; ++block) {
                                              const auto of_block = lobes_and_data(block);
                                              for (std::size_t i = 0; i < whole.size(); ++i)
                                                  whole[i] += sum(of_block[i]);
                                          }
                                          return whole;
                                      });
    // Row-major lower triangles are column-major upper ones.
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(Eigen::Index(J + C), Eigen::Index(J + C));
    for (std::size_t chunk = 0; chunk < chunks_of_pairs(); ++chunk)
        G += Eigen::Map<const Eigen::MatrixXd>(parts[chunk].data(), G.rows(), G.cols());
    for (std::size_t chunk = chunks_of_pairs(); chunk < chunks(); ++chunk)
        G.selfadjointView<Eigen::Upper>().rankUpdate(Eigen::Map<const Eigen::VectorXd>(parts[chunk].data(), G.rows()));
    G = Eigen::MatrixXd(G.selfadjointView<Eigen::Upper>());
    gram_ = G.topLeftCorner(lobes_, lobes_);
    beta_limit_.resize(lobes_);
    for (int j = 0; j < lobes_; ++j) {
        const std::span<const double> of_lobe(x.data() + N + std::size_t(j) * W, W);
        const double factor = log_peak_factor(of_lobe, shape_, offset_[std::size_t(j)]);
        beta_limit_[j] = elementary::exp(std::min(log_peak_limit_ - elementary::log(rows_.scale) - factor, 700.0));
    }
    // With pixels the coefficients of the last call are a better start than those of the pairs alone.
    if (rows_.views == 0 || beta_.rows() != lobes_ || beta_.cols() != Eigen::Index(C)) {
        beta_.resize(lobes_, Eigen::Index(C));
        for (Eigen::Index c = 0; c < beta_.cols(); ++c)
            beta_.col(c) = bounded_least_squares(gram_, G.block(0, lobes_ + c, lobes_, 1), beta_limit_);
    }
    if (rows_.views > 0) fit_to_pixels(G);

    std::vector<double> sums(chunks(), 0.0);
    for_chunks(chunks(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<float> beta(J);
        std::vector<const float*> columns(J);
        std::vector<double> radiance(C, 0.0);
        for (std::size_t block = begin; block < end; ++block) {
            for (int j = 0; j < lobes_; ++j) columns[std::size_t(j)] = lobe(block, j);
            for (std::size_t c = 0; c < C; ++c) {
                for (int j = 0; j < lobes_; ++j) beta[std::size_t(j)] = float(beta_(j, Eigen::Index(c)));
                const double squares =
                    residual(&rows_.y[c][block * k_block], beta, columns, rest(block, c), rows_.rows_in(block));
                if (observes_radiance(block))
                    radiance[c] += sum(rest(block, c));
                else
                    sums[chunk] += squares;
            }
        }
        for (const double difference : radiance) sums[chunk] += difference * difference;
    });
    double whole = of_pixels_;
    for (const double part : sums) whole += part;
    return whole;
}

// The derivative of the residual of channel c by weight i of lobe j is −β_jc E_j s_i, with s_i the factor of the weight; by
// angle n it is −A_nc, A_nc = Σ_j β_jc E_j p_jn·∂ψ_n/∂angle. A coefficient strictly between its bounds adapts, so that only
// the component of derivatives orthogonal to those lobes counts (Kaufman's approximation). A coefficient at its upper bound
// follows the bound: β_j E_j is then a lobe of given peak, and the peak of exp(p·(ψ − ẑ)) is exp(|p| − p_z).
void LobeProblem::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = lobes_, N = shape_.variates, W = shape_.width();
    const auto C = Eigen::Index(channels());
    const DerivativeSums sums = sums_of_derivatives(x);
    const auto weight = [&](Eigen::Index j, Eigen::Index i) { return N + j * W + i; };

    H = Eigen::MatrixXd::Zero(x.size(), x.size());
    g = Eigen::VectorXd::Zero(x.size());
    const Eigen::MatrixXd of_channels = beta_ * beta_.transpose();
    for (Eigen::Index k = 0; k < J; ++k)
        for (Eigen::Index l = 0; l < W; ++l)
            for (Eigen::Index j = 0; j < J; ++j)
                for (Eigen::Index i = 0; i < W; ++i)
                    H(weight(j, i), weight(k, l)) = of_channels(j, k) * sums.product(j, 1 + i, k, 1 + l);
    for (Eigen::Index j = 0; j < J; ++j)
        for (Eigen::Index i = 0; i < W; ++i) {
            for (Eigen::Index n = 0; n < N; ++n)
                H(n, weight(j, i)) = H(weight(j, i), n) = sums.unit * sums.unit * sums.with_lobe(j * (N + 1) + n, i);
            g[weight(j, i)] = -sums.unit * sums.with_lobe(j * (N + 1) + N, i);
        }
    for (Eigen::Index n = 0; n < N; ++n) {
        for (Eigen::Index m = 0; m < N; ++m)
            for (Eigen::Index s = 0; s < sums.angle_sums; ++s)
                for (Eigen::Index t = 0; t < sums.angle_sums; ++t)
                    H(n, m) +=
                        sums.unit * sums.unit * sums.across_channels(s, t) * sums.of_angle(s * N + n, J + t * N + m);
        for (Eigen::Index c = 0; c < C; ++c)
            for (Eigen::Index s = 0; s < sums.angle_sums; ++s)
                g[n] -= sums.unit * sums.in_channel(c, s) * sums.of_rest(c, J + s * N + n);
    }

    // With pixels the coefficients of all channels adapt together.
    const bool together = rows_.views > 0;
    Coefficients adapting(x.size(), together ? beta_.size() : 0);
    for (Eigen::Index c = 0; c < C; ++c) {
        Eigen::MatrixXd with_lobes(x.size(), J);  // derivatives · E_k
        for (Eigen::Index k = 0; k < J; ++k) {
            for (Eigen::Index n = 0; n < N; ++n) {
                with_lobes(n, k) = 0;
                for (Eigen::Index s = 0; s < sums.angle_sums; ++s)
                    with_lobes(n, k) += sums.unit * sums.in_channel(c, s) * sums.of_angle(s * N + n, k);
            }
            for (Eigen::Index j = 0; j < J; ++j)
                for (Eigen::Index i = 0; i < W; ++i)
                    with_lobes(weight(j, i), k) = beta_(j, c) * sums.product(j, 1 + i, k, 0);
        }
        std::vector<Eigen::Index> passive;
        for (Eigen::Index j = 0; j < J; ++j) {
            if (!(beta_(j, c) > 0)) continue;
            if (beta_(j, c) < beta_limit_[j]) {
                passive.push_back(j);
                continue;
            }
            // The derivative by x_i has by β_jc E_j more.
            Eigen::VectorXd bound = Eigen::VectorXd::Zero(x.size());
            for_limit(x, int(j), [&](Eigen::Index i, double by) { bound[i] = by * beta_(j, c); });
            H += bound * with_lobes.col(j).transpose() + with_lobes.col(j) * bound.transpose() +
                 gram_(j, j) * bound * bound.transpose();
            g -= sums.of_rest(c, j) * bound;
            with_lobes += bound * gram_.row(j);
        }
        if (together) {
            const auto of_channel = Eigen::seqN(c * J, J);
            adapting.across(Eigen::all, of_channel) = with_lobes;
            adapting.H(of_channel, of_channel) = gram_;
            adapting.g(of_channel) = -sums.of_rest.block(c, 0, 1, J).transpose();
            for (const Eigen::Index j : passive) adapting.free.push_back(c * J + j);
            continue;
        }
        if (passive.empty()) continue;
        Eigen::MatrixXd among = gram_(passive, passive);
        among.diagonal() *= 1 + 1e-6;
        eliminate(among, with_lobes(Eigen::all, passive), H);
    }
    if (together) {
        add_pixels(x, H, g, adapting);
        adapting.eliminate(H, g);
    }
}

// (E_j s_i) · (E_k s_l) = (E_j E_k) · (s_i s_l) with s_0 = 1: the products of a pair of lobes with a pair of factors are
// computed once, whichever lobe goes with which factor. (E_j · E_k are known from the loss.) Of the products with the
// derivatives by angles and with the residuals r_c only sums over channels are needed: (E_j U_nj) · s_i and (E_j R_j) · s_i
// with U_nj = Σ_c β_jc A_nc and R_j = Σ_c β_jc r_c. A_nc are sums of fewer columns where there are more channels than
// lobes: in_channel × A with in_channel × of_lobe = βᵀ.
LobeProblem::DerivativeSums LobeProblem::sums_of_derivatives(const Eigen::VectorXd& x) {
    const Eigen::Index J = lobes_, N = shape_.variates, C = shape_.components(), W = shape_.width(),
                       rests = Eigen::Index(channels()), S = std::min(rests, J);
    DerivativeSums sums;
    sums.angle_sums = S, sums.factors = W + 1;
    // Coefficients in a unit of their own: floats hold products of two of them, whatever the unit of the data.
    const double largest = beta_.size() > 0 ? beta_.maxCoeff() : 0;
    sums.unit = largest > 0 ? largest : 1;
    const Eigen::MatrixXd beta = beta_ / sums.unit;
    sums.in_channel = beta.transpose();
    Eigen::MatrixXd of_lobe = sums.in_channel;
    (rests < J ? sums.in_channel : of_lobe).setIdentity(S, S);
    sums.across_channels = sums.in_channel.transpose() * sums.in_channel;
    const Eigen::MatrixXd lobes_to_angles = of_lobe.transpose() * sums.across_channels;  // U of A: J × S

    const Eigen::Index pairs = DerivativeSums::count_of_pairs(J),
                       factor_pairs = DerivativeSums::count_of_pairs(W + 1) - 1, others = S * N + rests,
                       columns = J + S * N;
    // Row s × W + k: the weights of lobes in A of sum s by weight k; row j: those of A and of the residuals for lobe j.
    using Weights = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto row_of = [](const Weights& all, Eigen::Index row) {
        return std::span<const float>(&all(row, 0), std::size_t(all.cols()));
    };
    Weights of_angles(S * W, J);
    for (Eigen::Index s = 0; s < S; ++s)
        for (Eigen::Index k = 0; k < W; ++k)
            for (Eigen::Index j = 0; j < J; ++j) of_angles(s * W + k, j) = float(of_lobe(s, j) * x[N + j * W + k]);
    const Weights for_angles = lobes_to_angles.cast<float>(), for_rests = beta.cast<float>();
    const auto of_pairs = [&](std::size_t block, std::vector<double>& to) {
        constexpr Eigen::Index k_at_once = 48;  // pairs of lobes, whose products stay in the cache
        const std::size_t count = rows_.rows_in(block);
        thread_local Aligned<float> scratch;  // a few hundred kilobytes, allocated once per thread
        scratch.resize(
            std::max(scratch.size(), std::size_t(factor_pairs + k_at_once + 1 + S * N + J * (N + 1)) * k_block));
        float* free = scratch.data();
        const auto next = [&] { return std::exchange(free, free + k_block); };
        double* at = to.data();

        std::vector<const float*> factors, of_lobes, factors_alone;
        for (int i = 0; i < W; ++i) {
            factors_alone.push_back(feature(block, i));
            factors.push_back(feature(block, i));
            for (int l = 0; l <= i; ++l) {
                multiply(feature(block, i), feature(block, l), free, count);
                factors.push_back(next());
            }
        }
        float* const products = free;
        const auto add_these = [&] {
            add_products(of_lobes, factors, at, count);
            at += Eigen::Index(of_lobes.size()) * factor_pairs;
            of_lobes.clear();
        };
        for (int j = 0; j < J; ++j)
            for (int k = 0; k <= j; ++k) {
                float* const product = products + of_lobes.size() * k_block;
                multiply(lobe(block, j), lobe(block, k), product, count);
                of_lobes.push_back(product);
                if (Eigen::Index(of_lobes.size()) == k_at_once) add_these();
            }
        add_these();
        free += k_at_once * Eigen::Index(k_block);

        float* const column = next();
        std::vector<const float*> lobes, angles, residuals;
        for (int j = 0; j < J; ++j) lobes.push_back(lobe(block, j));
        for (std::size_t c = 0; c < channels(); ++c) residuals.push_back(rest(block, c));
        for (Eigen::Index s = 0; s < S; ++s)
            for (Eigen::Index n = 0; n < N; ++n) {
                float* const angle = next();
                angles.push_back(angle);
                for (Eigen::Index k = n * C; k < (n + 1) * C; ++k) {
                    const bool is_first = k == n * C;
                    combine(row_of(of_angles, s * W + k), lobes, feature(block, int(W + k)), is_first ? angle : column,
                            count);
                    if (!is_first)
                        combine(std::array{1.f, 1.f}, std::array<const float*, 2>{angle, column}, angle, count);
                }
            }
        std::vector<const float*> with, rows = angles, all = lobes;
        all.insert(all.end(), angles.begin(), angles.end());
        rows.insert(rows.end(), residuals.begin(), residuals.end());
        add_products(rows, all, at, count);
        at += others * columns;

        rows.clear();
        for (Eigen::Index j = 0; j < J; ++j) {
            const auto add_row = [&](std::span<const float> weight, std::span<const float* const> of) {
                combine(weight, of, lobes[std::size_t(j)], free, count);
                rows.push_back(next());
            };
            for (Eigen::Index n = 0; n < N; ++n) {
                with.clear();
                for (Eigen::Index s = 0; s < S; ++s) with.push_back(angles[std::size_t(s * N + n)]);
                add_row(row_of(for_angles, j), with);
            }
            add_row(row_of(for_rests, j), residuals);
        }
        add_products(rows, factors_alone, at, count);
    };
    // For a radiance's blocks only the columns' sums are needed, which are products of lobes and the factors of weights or
    // angles.
    const auto of_radiance = [&](std::size_t begin, std::size_t end) {
        const Eigen::Index F = W + shape_.directional();
        std::vector<double> products(std::size_t(J * (1 + F)));
        std::vector<double> all(std::size_t(J * (W + 1) + others));
        const Aligned<float> one(k_block, 1.f);
        std::vector<const float*> lobes, factors;
        double* const of_rest = &all[std::size_t(J * (W + 1) + S * N)];
        for (std::size_t block = begin; block < end; ++block) {
            lobes.clear();
            factors.assign(1, one.data());
            for (int j = 0; j < J; ++j) lobes.push_back(lobe(block, j));
            for (int i = 0; i < F; ++i) factors.push_back(feature(block, i));
            add_products(lobes, factors, products.data());
            for (std::size_t c = 0; c < channels(); ++c) of_rest[c] += sum(rest(block, c));
        }
        for (Eigen::Index j = 0; j < J; ++j) {
            const double* const of_this = &products[std::size_t(j * (1 + F))];
            std::copy_n(of_this, W + 1, &all[std::size_t(j * (W + 1))]);
            for (Eigen::Index s = 0; s < S; ++s)
                for (Eigen::Index k = 0; k < shape_.directional(); ++k)
                    all[std::size_t(J * (W + 1) + s * N + k / C)] +=
                        of_lobe(s, j) * x[N + j * W + k] * of_this[1 + W + k];
        }
        return all;
    };

    const Eigen::Index of_factors = pairs * factor_pairs, of_others = others * columns, of_rows = J * (N + 1) * W;
    const auto parts = sums_of_chunks(std::size_t(of_factors + of_others + of_rows), of_pairs, of_radiance);
    Eigen::VectorXd whole = Eigen::VectorXd::Zero(of_factors + of_others + of_rows);
    for (std::size_t chunk = 0; chunk < chunks_of_pairs(); ++chunk)
        whole += Eigen::Map<const Eigen::VectorXd>(parts[chunk].data(), whole.size());
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    sums.products.assign(whole.begin(), whole.begin() + of_factors);
    const Eigen::Map<const RowMajor> of_angles_and_rests(&whole[of_factors], others, columns),
        with_lobe(&whole[of_factors + of_others], J * (N + 1), W);
    sums.of_angle = of_angles_and_rests.topRows(S * N), sums.of_rest = of_angles_and_rests.bottomRows(rests);
    sums.with_lobe = with_lobe;

    const auto radiances = Eigen::Index(rows_.radiances), weighted = J * (W + 1);
    Eigen::MatrixXd of_radiances(weighted + others, radiances);
    for (Eigen::Index k = 0; k < radiances; ++k)
        of_radiances.col(k) =
            Eigen::Map<const Eigen::VectorXd>(parts[chunks_of_pairs() + std::size_t(k)].data(), weighted + others);
    sums.of_radiances = Eigen::MatrixXd::Zero(weighted, weighted);
    if (radiances > 0) sums.of_radiances.selfadjointView<Eigen::Upper>().rankUpdate(of_radiances.topRows(weighted));
    sums.of_radiances = Eigen::MatrixXd(sums.of_radiances.selfadjointView<Eigen::Upper>());
    for (Eigen::Index k = 0; k < radiances; ++k) {
        const auto of_weights = of_radiances.col(k).head(weighted),
                   angles = of_radiances.col(k).segment(weighted, S * N), residuals = of_radiances.col(k).tail(rests);
        Eigen::VectorXd all(columns);
        for (Eigen::Index j = 0; j < J; ++j) all[j] = of_weights[j * (W + 1)];
        all.tail(S * N) = angles;
        sums.of_angle += angles * all.transpose();
        sums.of_rest += residuals * all.transpose();
        for (Eigen::Index j = 0; j < J; ++j) {
            const auto factors = of_weights.segment(j * (W + 1) + 1, W);
            for (Eigen::Index n = 0; n < N; ++n)
                for (Eigen::Index s = 0; s < S; ++s)
                    sums.with_lobe.row(j * (N + 1) + n) +=
                        lobes_to_angles(j, s) * angles[s * N + n] * factors.transpose();
            sums.with_lobe.row(j * (N + 1) + N) += beta.row(j).dot(residuals.transpose()) * factors.transpose();
        }
    }
    return sums;
}

std::vector<double> LobeProblem::best_addition(const std::vector<std::vector<double>>& candidates) {
    // The values of a group of candidates on all blocks fit in the cache.
    constexpr std::size_t group = 16;
    const std::size_t blocks = rows_.blocks, J = std::size_t(lobes_), C = channels();
    Aligned<float> added(group * blocks * k_block);
    const auto of = [&](std::size_t k, std::size_t block) { return &added[(k * blocks + block) * k_block]; };
    const Eigen::LDLT<Eigen::MatrixXd> factor(ridged(gram_));
    std::vector<double> best;
    double best_gain = -1;
    for (std::size_t first = 0; first < candidates.size(); first += group) {
        const std::size_t count = std::min(group, candidates.size() - first);
        std::vector<double> whole(count, 0.0);  // squared norms of the candidates
        std::vector<const float*> s, rows, columns;
        for (std::size_t k = 0; k < count; ++k) {
            const std::vector<float> weight(candidates[first + k].begin(), candidates[first + k].end());
            float offset = k_nothing;
            for (std::size_t block = 0; block < blocks; ++block) {
                s.clear();
                for (int n = 0; n < shape_.width(); ++n) s.push_back(feature(block, n));
                offset = std::max(offset, exponent(rows_, block, weight, s, of(k, block)));
            }
            for (std::size_t block = 0; block < blocks; ++block) {
                exponentiate(rows_, block, offset, of(k, block));
                whole[k] += sum_of_squares(of(k, block), rows_.rows_in(block));
            }
        }
        // Products with the current lobes and with the residuals; row-major, read as columns of candidates.
        Eigen::MatrixXd products = Eigen::MatrixXd::Zero(Eigen::Index(J + C), Eigen::Index(count));
        for (std::size_t block = 0; block < blocks; ++block) {
            rows.clear(), columns.clear();
            for (std::size_t k = 0; k < count; ++k) rows.push_back(of(k, block));
            for (int j = 0; j < lobes_; ++j) columns.push_back(lobe(block, j));
            for (std::size_t c = 0; c < C; ++c) columns.push_back(rest(block, c));
            add_products(rows, columns, products.data(), rows_.rows_in(block));
        }
        for (std::size_t k = 0; k < count; ++k) {
            if (!(whole[k] > 1e-60)) continue;
            const auto shared = products.col(Eigen::Index(k)).head(lobes_);
            double across = whole[k];
            if (lobes_ > 0) across -= shared.dot(factor.solve(shared));
            across = std::max(across, 1e-4 * whole[k]);
            const double gain =
                products.col(Eigen::Index(k)).tail(Eigen::Index(C)).cwiseMax(0.0).squaredNorm() / across;
            if (gain > best_gain) best_gain = gain, best = candidates[first + k];
        }
    }
    return best;
}

double log_peak_factor(std::span<const double> of_lobe, const LobeShape& shape, double offset) {
    double log_factor = -offset;
    for (int n = 0; n < shape.variates; ++n) {
        const Vec3d p = vector_of(of_lobe, shape, n);
        log_factor += (shape.reciprocal ? 2 : 1) * (elementary::hypot(p.x, p.y, p.z) - p.z);
    }
    return log_factor;
}

Vec3d vector_of(std::span<const double> of_lobe, const LobeShape& shape, int n) {
    if (shape.axial) return {0, 0, of_lobe[std::size_t(n)]};
    const double* p = &of_lobe[std::size_t(3 * n)];
    return {p[0], p[1], p[2]};
}

}  // namespace srbf
