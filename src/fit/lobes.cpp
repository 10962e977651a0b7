#include "fit/lobes.h"

#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>
#include <utility>

#include "least_squares.h"
#include "parallel.h"

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

template <typename Columns, typename Sums>
Eigen::MatrixXd LobeProblem::gram(std::size_t n, std::size_t scratch_columns, const Columns& columns,
                                  const Sums& sums) const {
    std::vector<std::vector<double>> parts(chunks());  // for pairs products, for a radiance the columns' sums
    for_chunks(chunks(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        if (observes_radiance(begin)) {
            parts[chunk] = sums(begin, end);
            return;
        }
        thread_local Aligned<float> scratch;  // a few hundred kilobytes, allocated once per thread
        scratch.resize(std::max(scratch.size(), scratch_columns * k_block));
        std::vector<const float*> pointers;
        std::vector<double>& part = parts[chunk];
        part.assign(n * n, 0.0);
        for (std::size_t block = begin; block < end; ++block) {
            pointers.clear();
            columns(block, scratch.data(), pointers);
            add_gram(pointers, part.data());
        }
    });
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(Eigen::Index(n), Eigen::Index(n));
    for (const auto& part : parts) {
        if (part.size() == n * n) {
            G += Eigen::Map<const Eigen::MatrixXd>(part.data(), G.rows(), G.cols());
            continue;
        }
        const Eigen::Map<const Eigen::VectorXd> of_radiance(part.data(), G.rows());
        G.selfadjointView<Eigen::Upper>().rankUpdate(of_radiance);
    }
    // Row-major lower triangles are column-major upper ones.
    return G.selfadjointView<Eigen::Upper>();
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
                const auto a = float(std::cos(x[n])), b = float(std::sin(x[n]));
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
    const auto lobes_and_data = [&](std::size_t block, float*, std::vector<const float*>& of_block) {
        for (int j = 0; j < lobes_; ++j) of_block.push_back(lobe(block, j));
        for (const auto& y : rows_.y) of_block.push_back(&y[block * k_block]);
    };
    const Eigen::MatrixXd G = gram(J + C, 0, lobes_and_data, [&](std::size_t begin, std::size_t end) {
        std::vector<double> whole(J + C);
        std::vector<const float*> of_block;
        for (std::size_t block = begin; block < end; ++block) {
            of_block.clear();
            lobes_and_data(block, nullptr, of_block);
            for (std::size_t i = 0; i < whole.size(); ++i) whole[i] += sum(of_block[i]);
        }
        return whole;
    });
    gram_ = G.topLeftCorner(lobes_, lobes_);
    beta_limit_.resize(lobes_);
    for (int j = 0; j < lobes_; ++j) {
        const std::span<const double> of_lobe(x.data() + N + std::size_t(j) * W, W);
        const double factor = log_peak_factor(of_lobe, shape_, offset_[std::size_t(j)]);
        beta_limit_[j] = std::exp(std::min(log_peak_limit_ - std::log(rows_.scale) - factor, 700.0));
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
                const double squares = residual(&rows_.y[c][block * k_block], beta, columns, rest(block, c));
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

// Let D hold the columns E_j s_i (s_i is the factor of weight i), those of the angles, and E_j. The derivative of the
// residual of channel c is −D B_c, with B_c made of β. With respect to angle n it is −Σ_j β_jc E_j p_jn·∂ψ_n/∂angle.
// The columns for it are either these sums, C per angle, or their terms without β, J of them, whichever are fewer. A
// coefficient strictly between its bounds adapts, so that only the component of D orthogonal to those lobes counts
// (Kaufman's approximation). A coefficient at its upper bound follows the bound: β_j E_j is then a lobe of given peak,
// and the peak of exp(p·(ψ − ẑ)) is exp(|p| − p_z).
void LobeProblem::linearise(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const Eigen::Index J = lobes_, N = shape_.variates, C = shape_.components(), W = shape_.width();
    // βᵀ = in_channel × of_lobe, evaluated with the smaller number of sums.
    const Eigen::Index sums = std::min(beta_.cols(), J);
    Eigen::MatrixXd in_channel = beta_.transpose(), of_lobe = in_channel;
    (beta_.cols() < J ? in_channel : of_lobe).setIdentity(sums, sums);
    const Eigen::Index first_angle = W * J, first_e = first_angle + N * sums, columns_d = first_e + J;
    const auto fill = [&](std::size_t block, float* scratch, std::vector<const float*>& columns) {
        const auto next = [&] {
            columns.push_back(scratch);
            return std::exchange(scratch, scratch + k_block);
        };
        for (int j = 0; j < J; ++j)
            for (int i = 0; i < W; ++i) multiply(lobe(block, j), feature(block, i), next());
        float* const sum = scratch + N * sums * Eigen::Index(k_block);
        std::vector<float> weight;
        std::vector<const float*> lobes;
        for (Eigen::Index s = 0; s < sums; ++s)
            for (int n = 0; n < N; ++n) {
                float* const column = next();
                std::fill_n(column, k_block, 0.f);
                for (int k = 0; k < C; ++k) {
                    weight.clear(), lobes.clear();
                    for (int j = 0; j < J; ++j) {
                        const double factor = of_lobe(s, j) * x[N + j * W + n * C + k];
                        if (factor != 0) weight.push_back(float(factor)), lobes.push_back(lobe(block, j));
                    }
                    combine(weight, lobes, sum);
                    add_product(sum, feature(block, int(W + n * C) + k), column);
                }
            }
        for (int j = 0; j < J; ++j) columns.push_back(lobe(block, j));
        for (std::size_t c = 0; c < channels(); ++c) columns.push_back(rest(block, c));
    };
    // For a radiance's blocks only the sums are needed, which are products of lobes and the factors of weights or
    // angles.
    const auto sums_of = [&](std::size_t begin, std::size_t end) {
        const Eigen::Index F = W + shape_.directional();
        Eigen::MatrixXd products = Eigen::MatrixXd::Zero(F, J);  // row-major, read as columns of lobes
        std::vector<double> all(std::size_t(columns_d) + channels());
        std::vector<const float*> lobes, features;
        for (std::size_t block = begin; block < end; ++block) {
            lobes.clear(), features.clear();
            for (int j = 0; j < J; ++j) lobes.push_back(lobe(block, j));
            for (int i = 0; i < F; ++i) features.push_back(feature(block, i));
            add_products(lobes, features, products.data());
            for (int j = 0; j < J; ++j) all[std::size_t(first_e + j)] += sum(lobe(block, j));
            for (std::size_t c = 0; c < channels(); ++c) all[std::size_t(columns_d) + c] += sum(rest(block, c));
        }
        for (Eigen::Index j = 0; j < J; ++j) {
            for (Eigen::Index i = 0; i < W; ++i) all[std::size_t(j * W + i)] = products(i, j);
            for (Eigen::Index s = 0; s < sums; ++s)
                for (Eigen::Index i = 0; i < shape_.directional(); ++i)
                    all[std::size_t(first_angle + s * N + i / C)] +=
                        of_lobe(s, j) * x[N + j * W + i] * products(W + i, j);
        }
        return all;
    };
    const Eigen::MatrixXd G = gram(std::size_t(columns_d) + channels(), std::size_t(first_e) + 1, fill, sums_of);
    const auto DD = G.topLeftCorner(columns_d, columns_d);

    H = Eigen::MatrixXd::Zero(x.size(), x.size());
    g = Eigen::VectorXd::Zero(x.size());
    // With pixels the coefficients of all channels adapt together.
    const bool together = rows_.views > 0;
    Coefficients adapting(x.size(), together ? beta_.size() : 0);
    for (Eigen::Index c = 0; c < beta_.cols(); ++c) {
        std::vector<Eigen::Triplet<double>> entries;
        std::vector<Eigen::Index> passive;
        for (Eigen::Index s = 0; s < sums; ++s)
            for (Eigen::Index n = 0; n < N; ++n) entries.emplace_back(first_angle + s * N + n, n, in_channel(c, s));
        for (Eigen::Index j = 0; j < J; ++j) {
            const double beta = beta_(j, c);
            if (!(beta > 0)) continue;
            for (Eigen::Index i = 0; i < W; ++i) entries.emplace_back(j * W + i, N + j * W + i, beta);
            if (beta < beta_limit_[j]) {
                passive.push_back(first_e + j);
                continue;
            }
            for_limit(x, int(j), [&](Eigen::Index i, double by) { entries.emplace_back(first_e + j, i, by * beta); });
        }
        Eigen::SparseMatrix<double> B(columns_d, x.size());
        B.setFromTriplets(entries.begin(), entries.end());
        const Eigen::MatrixXd BD = B.transpose() * DD;
        H += BD * B;
        g -= B.transpose() * G.block(0, columns_d + c, columns_d, 1);
        if (together) {
            const auto of_channel = Eigen::seqN(c * J, J);
            adapting.across(Eigen::all, of_channel) = BD.rightCols(J);
            adapting.H(of_channel, of_channel) = DD.bottomRightCorner(J, J);
            adapting.g(of_channel) = -G.block(first_e, columns_d + c, J, 1);
            for (const Eigen::Index e : passive) adapting.free.push_back(c * J + e - first_e);
            continue;
        }
        if (passive.empty()) continue;
        const Eigen::MatrixXd BP = BD(Eigen::all, passive);
        Eigen::MatrixXd PP = DD(passive, passive);
        PP.diagonal() *= 1 + 1e-6;
        H -= BP * PP.ldlt().solve(BP.transpose());
    }
    if (together) {
        add_pixels(x, H, g, adapting);
        adapting.eliminate(H, g);
    }
}

std::vector<double> LobeProblem::cost_of_dropping() const { return srbf::cost_of_dropping(gram_, beta_); }

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
                whole[k] += sum_of_squares(of(k, block));
            }
        }
        // Products with the current lobes and with the residuals; row-major, read as columns of candidates.
        Eigen::MatrixXd products = Eigen::MatrixXd::Zero(Eigen::Index(J + C), Eigen::Index(count));
        for (std::size_t block = 0; block < blocks; ++block) {
            rows.clear(), columns.clear();
            for (std::size_t k = 0; k < count; ++k) rows.push_back(of(k, block));
            for (int j = 0; j < lobes_; ++j) columns.push_back(lobe(block, j));
            for (std::size_t c = 0; c < C; ++c) columns.push_back(rest(block, c));
            add_products(rows, columns, products.data());
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
        log_factor += (shape.reciprocal ? 2 : 1) * (std::hypot(p.x, p.y, p.z) - p.z);
    }
    return log_factor;
}

Vec3d vector_of(std::span<const double> of_lobe, const LobeShape& shape, int n) {
    if (shape.axial) return {0, 0, of_lobe[std::size_t(n)]};
    const double* p = &of_lobe[std::size_t(3 * n)];
    return {p[0], p[1], p[2]};
}

}  // namespace srbf
