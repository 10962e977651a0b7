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

template <typename Body> void LobeProblem::for_each(std::size_t count, const Body& body) const {
    if (parallel_)
        parallel_for(count, body);
    else
        for (std::size_t i = 0; i < count; ++i) body(i);
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
    const Eigen::MatrixXd last = beta_;
    beta_.resize(lobes_, Eigen::Index(C));
    for (Eigen::Index c = 0; c < beta_.cols(); ++c)
        beta_.col(c) = bounded_least_squares(gram_, G.block(0, lobes_ + c, lobes_, 1), beta_limit_);
    if (rows_.views > 0) fit_to_pixels(G, last);

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

// ---- Pixels ----

// The derivative of log β at its upper bound by weight i of lobe j.
template <typename Add> void LobeProblem::for_limit(const Eigen::VectorXd& x, int j, const Add& add) const {
    const int N = shape_.variates, W = shape_.width(), C = shape_.components();
    const double factor = shape_.reciprocal ? 2 : 1;
    for (int n = 0; n < N; ++n) {
        const Vec3d p = vector_of({&x[N + j * W], std::size_t(W)}, shape_, n);
        const double bandwidth = std::hypot(p.x, p.y, p.z);
        if (bandwidth == 0) continue;
        const Eigen::Index last = N + j * W + (n + 1) * C - 1;  // index of p_z
        add(last, factor * (1 - p.z / bandwidth));
        if (shape_.axial) continue;
        add(last - 2, -factor * p.x / bandwidth);
        add(last - 1, -factor * p.y / bandwidth);
    }
}

void LobeProblem::Coefficients::eliminate(Eigen::MatrixXd& of_x, Eigen::VectorXd& by_x) const {
    if (free.empty()) return;
    const Eigen::MatrixXd A = across(Eigen::all, free);
    Eigen::MatrixXd B = H(free, free);
    B.diagonal() *= 1 + 1e-6;
    const Eigen::LDLT<Eigen::MatrixXd> factor(B);
    of_x -= A * factor.solve(A.transpose());
    by_x -= A * factor.solve(g(free));
}

void LobeProblem::take_moments(bool all) {
    const std::size_t J = std::size_t(lobes_), F = all ? std::size_t(shape_.width() + shape_.directional()) : 0,
                      rows = rows_.view_rows, in_block = k_block / rows;
    moment_.resize(pixel_blocks() * J * (1 + std::size_t(shape_.width() + shape_.directional())) * k_block);
    for_each((rows_.views + in_block - 1) / in_block, [&](std::size_t of_views) {
        thread_local Aligned<float> lit;  // light times E_j, of the extended lights
        std::vector<const float*> products_of, columns;
        std::vector<double> products;
        const Aligned<float> ones(rows, 1.f);
        for (std::size_t view = of_views * in_block; view < std::min(rows_.views, (of_views + 1) * in_block); ++view) {
            const std::size_t row = rows_.first_view_block() * k_block + view * rows, block = row / k_block,
                              at = row % k_block, begin = rows_.first_pixel[view], end = rows_.first_pixel[view + 1];
            columns.assign(1, ones.data());
            for (std::size_t i = 0; i < F; ++i) columns.push_back(feature(block, int(i)) + at);
            const auto store = [&](std::size_t p, std::size_t j, std::size_t i, double value) {
                const std::size_t column = i == 0 ? j : J + j * F + i - 1;
                moment(p / k_block, column)[p % k_block] = float(value);
            };
            products_of.clear();
            lit.resize(std::max(lit.size(), (end - begin) * J * rows));
            for (std::size_t p = begin; p < end; ++p) {
                const Rows::Pixel& pixel = rows_.pixel[p];
                for (std::size_t j = 0; j < J; ++j) {
                    const float* const e = lobe(block, int(j)) + at;
                    if (pixel.single) {
                        const std::size_t of_row = pixel.row - row;
                        for (std::size_t i = 0; i <= F; ++i)
                            store(p, j, i, double(pixel.weight) * double(e[of_row]) * double(columns[i][of_row]));
                        continue;
                    }
                    float* const to = &lit[products_of.size() * rows];
                    for (std::size_t i = 0; i < rows; ++i) to[i] = rows_.light[pixel.light + i] * e[i];
                    products_of.push_back(to);
                }
            }
            products.assign(products_of.size() * columns.size(), 0.0);
            add_products(products_of, columns, products.data(), rows);
            const double* product = products.data();
            for (std::size_t p = begin; p < end; ++p)
                for (std::size_t j = 0; !rows_.pixel[p].single && j < J; ++j)
                    for (std::size_t i = 0; i <= F; ++i) store(p, j, i, *product++);
        }
    });
}

Pixels::Triplet LobeProblem::colour(const Eigen::MatrixXd& beta, std::size_t p) {
    Pixels::Triplet colour{};
    for (int j = 0; j < lobes_; ++j) {
        const auto e = double(moment(p / k_block, std::size_t(j))[p % k_block]);
        for (std::size_t c = 0; c < 3; ++c) colour[c] += beta(j, Eigen::Index(c)) * e;
    }
    return colour;
}

double LobeProblem::delta_e() {
    double sum = 0;
    for (std::size_t p = 0; p < rows_.pixel.size(); ++p) sum += rows_.pixels.delta_e(p, colour(beta_, p));
    return sum / double(rows_.pixel.size());
}

double LobeProblem::pixel_loss(const Eigen::MatrixXd& beta, Coefficients& adapting) {
    const std::size_t J = std::size_t(lobes_);
    std::vector<double> parts(pixel_blocks());
    std::vector<Coefficients> slopes(pixel_blocks(), Coefficients(0, beta.size()));
    for_each(pixel_blocks(), [&](std::size_t block) {
        Coefficients& of = slopes[block];
        std::vector<double> e(J);
        for (std::size_t p = block * k_block; p < std::min(rows_.pixel.size(), (block + 1) * k_block); ++p) {
            Pixels::Slope slope;
            parts[block] += rows_.pixels.error(p, colour(beta, p), &slope);
            for (std::size_t j = 0; j < J; ++j) e[j] = double(moment(block, j)[p % k_block]);
            for (std::size_t c = 0; c < 3; ++c) {
                for (std::size_t j = 0; j < J; ++j) of.g[Eigen::Index(c * J + j)] += slope.by_colour[c] * e[j];
                for (std::size_t d = 0; d <= c; ++d) {
                    double product = 0;
                    for (std::size_t i = 0; i < 3; ++i) product += slope.jacobian[i][c] * slope.jacobian[i][d];
                    for (std::size_t j = 0; j < J; ++j) {
                        double* const column = &of.H(Eigen::Index(c * J), Eigen::Index(d * J + j));
                        for (std::size_t k = 0; k < J; ++k) column[k] += product * e[j] * e[k];
                    }
                }
            }
        }
    });
    const double share = rows_.picture_importance / double(rows_.pixel.size());
    double sum = 0;
    for (const double part : parts) sum += share * part;
    adapting = Coefficients(0, beta.size());
    for (const Coefficients& of : slopes) adapting.g += share * of.g, adapting.H += share * of.H;
    adapting.H = Eigen::MatrixXd(adapting.H.selfadjointView<Eigen::Lower>());
    return sum;
}

// From the coefficients of the last call, or those of the pairs alone, by a few steps of Gauss and Newton: the gradient
// of what remains is part of `linearise`.
void LobeProblem::fit_to_pixels(const Eigen::MatrixXd& G, const Eigen::MatrixXd& last) {
    constexpr int k_most_steps = 2;
    constexpr double k_tolerance = 1e-7, k_least_share = 0.05;
    const Eigen::Index J = lobes_, C = beta_.cols();
    take_moments(false);
    if (last.rows() == J && last.cols() == C) beta_ = last.cwiseMin(beta_limit_.replicate(1, C));
    // The sum, its gradient and Hessian.
    const auto loss_at = [&](const Eigen::MatrixXd& beta, double& of_pixels, Coefficients& at) {
        of_pixels = pixel_loss(beta, at);
        double sum = of_pixels;
        for (Eigen::Index c = 0; c < C; ++c) {
            const Eigen::VectorXd of_data = G.block(0, J + c, J, 1), product = gram_ * beta.col(c);
            sum += beta.col(c).dot(product - 2 * of_data) + G(J + c, J + c);
            at.H.block(c * J, c * J, J, J) += gram_;
            at.g.segment(c * J, J) += product - of_data;
        }
        return sum;
    };
    const Eigen::VectorXd most = beta_limit_.replicate(C, 1);
    Coefficients at(0, beta_.size()), further = at;
    double loss = loss_at(beta_, of_pixels_, at);
    for (int step = 0; step < k_most_steps; ++step) {
        const Eigen::Map<const Eigen::VectorXd> now(beta_.data(), beta_.size());
        const Eigen::VectorXd towards = bounded_least_squares(at.H, at.H * now - at.g, most) - now;
        const double predicted = -2 * towards.dot(at.g) - towards.dot(at.H * towards);
        if (!(predicted > k_tolerance * loss)) return;
        bool lowered = false;
        for (double share = 1; share > k_least_share && !lowered; share /= 2) {
            const Eigen::MatrixXd next = beta_ + share * Eigen::Map<const Eigen::MatrixXd>(towards.data(), J, C);
            double of_pixels = 0;
            const double whole = loss_at(next, of_pixels, further);
            lowered = whole < loss;
            if (lowered) beta_ = next, of_pixels_ = of_pixels, loss = whole, std::swap(at, further);
        }
        if (!lowered) return;
    }
}

// The columns of a block of pixels, of which `add_gram` makes the products, are the derivatives of the three components
// of what is seen by x and by the coefficients, and the components' differences.
void LobeProblem::add_pixels(const Eigen::VectorXd& x, Eigen::MatrixXd& H, Eigen::VectorXd& g, Coefficients& adapting) {
    const Eigen::Index J = lobes_, N = shape_.variates, C = shape_.components(), W = shape_.width(),
                       F = W + shape_.directional(), X = x.size(), columns = X + 3 * J + 1;
    take_moments(true);
    std::vector<std::vector<double>> parts(pixel_blocks(), std::vector<double>(std::size_t(columns * columns)));
    for_each(pixel_blocks(), [&](std::size_t block) {
        thread_local Aligned<float> scratch;
        scratch.resize(std::max(scratch.size(), std::size_t(columns + 5) * k_block));
        const auto column = [&](Eigen::Index i) { return &scratch[std::size_t(i) * k_block]; };
        const auto moment_of = [&](Eigen::Index j, Eigen::Index n) {
            return moment(block, std::size_t(J + j * F + n));
        };
        const std::size_t begin = block * k_block, end = std::min(rows_.pixel.size(), begin + k_block);
        std::vector<Pixels::Slope> slopes(k_block);
        for (std::size_t p = begin; p < end; ++p) rows_.pixels.error(p, colour(beta_, p), &slopes[p - begin]);
        float* const by_channel[] = {column(columns), column(columns + 1), column(columns + 2)};
        const std::vector<const float*> channels(std::begin(by_channel), std::end(by_channel));
        float *const of_lobe = column(columns + 3), *const turned = column(columns + 4);
        const std::vector<const float*> of_one{of_lobe};
        std::vector<const float*> all;
        for (Eigen::Index i = 0; i < columns; ++i) all.push_back(column(i));
        for (std::size_t component = 0; component < 3; ++component) {
            std::fill_n(column(0), std::size_t(columns) * k_block, 0.f);
            for (std::size_t p = 0; p < k_block; ++p) {
                for (std::size_t c = 0; c < 3; ++c) by_channel[c][p] = float(slopes[p].jacobian[component][c]);
                column(columns - 1)[p] = float(slopes[p].r[component]);
            }
            for (Eigen::Index j = 0; j < J; ++j) {
                const Pixels::Triplet beta{beta_(j, 0), beta_(j, 1), beta_(j, 2)};
                combine(std::vector<float>(beta.begin(), beta.end()), channels, of_lobe);
                for (Eigen::Index n = 0; n < W; ++n) multiply(of_lobe, moment_of(j, n), column(N + j * W + n));
                for (Eigen::Index n = 0; n < N * C; ++n) {
                    combine(std::vector{float(x[N + j * W + n])}, of_one, turned);
                    add_product(turned, moment_of(j, W + n), column(n / C));
                }
                const float* const e = moment(block, std::size_t(j));
                for (std::size_t c = 0; c < 3; ++c) {
                    multiply(by_channel[c], e, column(X + Eigen::Index(c) * J + j));
                    if (beta[c] < beta_limit_[j]) continue;
                    for_limit(x, int(j), [&](Eigen::Index i, double by) {
                        combine(std::vector{float(by * beta[c])}, std::vector<const float*>{by_channel[c]}, turned);
                        add_product(turned, e, column(i));
                    });
                }
            }
            add_gram(all, parts[block].data());
        }
    });
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(columns, columns);
    for (const auto& part : parts) G += Eigen::Map<const Eigen::MatrixXd>(part.data(), columns, columns);
    G = Eigen::MatrixXd(G.selfadjointView<Eigen::Upper>()) * (rows_.picture_importance / double(rows_.pixel.size()));
    H += G.topLeftCorner(X, X);
    g += G.topRightCorner(X, 1);
    adapting.across += G.block(0, X, X, 3 * J);
    adapting.H += G.block(X, X, 3 * J, 3 * J);
    adapting.g += G.block(X, columns - 1, 3 * J, 1);
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
