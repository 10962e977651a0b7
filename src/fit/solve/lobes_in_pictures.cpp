// What is seen of lobes: the part of LobeProblem that pixels are.
#include <algorithm>
#include <utility>

#include "fit/solve/least_squares.h"
#include "fit/solve/lobes.h"

namespace srbf {
namespace {

/// factor times the sum of what add_gram made of blocks, as a whole matrix.
Eigen::MatrixXd summed(const std::vector<std::vector<double>>& parts, Eigen::Index columns, double factor) {
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(columns, columns);
    for (const auto& part : parts) G += Eigen::Map<const Eigen::MatrixXd>(part.data(), columns, columns);
    return factor * Eigen::MatrixXd(G.selfadjointView<Eigen::Upper>());
}

}  // namespace

void LobeProblem::Coefficients::eliminate(Eigen::MatrixXd& of_x, Eigen::VectorXd& by_x) const {
    if (free.empty()) return;
    const Eigen::MatrixXd A = across(Eigen::all, free);
    Eigen::MatrixXd B = H(free, free);
    B.diagonal() *= 1 + 1e-6;
    srbf::eliminate(B, A, of_x);
    by_x -= A * solved(B, g(free));
}

void LobeProblem::take_moments(bool all) {
    const std::size_t J = std::size_t(lobes_), F = all ? std::size_t(shape_.width() + shape_.directional()) : 0,
                      rows = rows_.view_rows, in_block = k_block / rows;
    moment_.resize(rows_.pixels.blocks() * J * (1 + std::size_t(shape_.width() + shape_.directional())) * k_block);
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
                    multiply(&rows_.light[pixel.light], e, to, rows);
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

Pixels::Colours combined(const Eigen::MatrixXd& beta, std::span<const float* const> values, Aligned<float>& columns,
                         std::size_t count) {
    columns.resize(3 * k_block);
    Pixels::Colours colours;
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::VectorXf of_channel = beta.col(Eigen::Index(c)).cast<float>();
        float* const column = &columns[c * k_block];
        combine({of_channel.data(), values.size()}, values, column, count);
        colours[c] = column;
    }
    return colours;
}

Pixels::Colours LobeProblem::colours(const Eigen::MatrixXd& beta, std::size_t block) {
    thread_local Aligned<float> columns;
    std::vector<const float*> moments;
    for (std::size_t j = 0; j < std::size_t(lobes_); ++j) moments.push_back(moment(block, j));
    return combined(beta, moments, columns, rows_in_block(block, rows_.pixels.count()));
}

double LobeProblem::delta_e() {
    double sum = 0;
    for (std::size_t block = 0; block < rows_.pixels.blocks(); ++block)
        sum += rows_.pixels.delta_e(block, colours(beta_, block));
    return sum / double(rows_.pixels.count());
}

double LobeProblem::pixel_loss(const Eigen::MatrixXd& beta, Coefficients& adapting) {
    const Eigen::Index J = lobes_, columns = 3 * J + 1;
    const std::size_t blocks = rows_.pixels.blocks();
    std::vector<double> errors(blocks);
    std::vector<std::vector<double>> parts(blocks, std::vector<double>(std::size_t(columns * columns)));
    for_each(blocks, [&](std::size_t block) {
        thread_local PixelSlopes slopes;
        thread_local Aligned<float> scratch;
        scratch.resize(std::max(scratch.size(), std::size_t(3 * J) * k_block));
        const std::size_t count = rows_in_block(block, rows_.pixels.count());
        errors[block] = rows_.pixels.errors(block, colours(beta, block), slopes);
        std::vector<const float*> all;
        for (std::size_t component = 0; component < 3; ++component) {
            all.clear();
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t j = 0; j < std::size_t(J); ++j) {
                    float* const column = &scratch[all.size() * k_block];
                    multiply(slopes.by(component)[c], moment(block, j), column, count);
                    all.push_back(column);
                }
            all.push_back(slopes.of(component));
            add_gram(all, parts[block].data(), count);
        }
    });
    const double share = rows_.picture_importance / double(rows_.pixels.count());
    double sum = 0;
    for (const double error : errors) sum += share * error;
    const Eigen::MatrixXd G = summed(parts, columns, share);
    adapting = Coefficients(0, beta.size());
    adapting.H = G.topLeftCorner(3 * J, 3 * J);
    adapting.g = G.topRightCorner(3 * J, 1);
    return sum;
}

// By a few steps of Gauss and Newton: the gradient of what remains is part of `linearise`.
void LobeProblem::fit_to_pixels(const Eigen::MatrixXd& G) {
    constexpr int k_most_steps = 2;
    constexpr double k_tolerance = 1e-6, k_least_share = 0.05;
    const Eigen::Index J = lobes_, C = beta_.cols();
    take_moments(false);
    beta_ = beta_.cwiseMin(beta_limit_.replicate(1, C)).eval();
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
    const std::size_t blocks = rows_.pixels.blocks();
    take_moments(true);
    std::vector<std::vector<double>> parts(blocks, std::vector<double>(std::size_t(columns * columns)));
    for_each(blocks, [&](std::size_t block) {
        thread_local PixelSlopes slopes;
        thread_local Aligned<float> scratch;
        scratch.resize(std::max(scratch.size(), std::size_t(columns + 1) * k_block));
        const auto column = [&](Eigen::Index i) { return &scratch[std::size_t(i) * k_block]; };
        const auto moment_of = [&](Eigen::Index j, Eigen::Index n) {
            return moment(block, std::size_t(J + j * F + n));
        };
        const std::size_t count = rows_in_block(block, rows_.pixels.count());
        rows_.pixels.errors(block, colours(beta_, block), slopes);
        float *const of_lobe = column(columns - 1), *const turned = column(columns);
        const std::vector<const float*> of_one{of_lobe};
        std::vector<const float*> all;
        for (Eigen::Index i = 0; i + 1 < columns; ++i) all.push_back(column(i));
        for (std::size_t component = 0; component < 3; ++component) {
            const std::array<const float*, 3> by_channel = slopes.by(component);
            std::fill_n(column(0), std::size_t(columns - 1) * k_block, 0.f);
            for (Eigen::Index j = 0; j < J; ++j) {
                const Pixels::Triplet beta{beta_(j, 0), beta_(j, 1), beta_(j, 2)};
                combine(std::vector<float>(beta.begin(), beta.end()), by_channel, of_lobe, count);
                for (Eigen::Index n = 0; n < W; ++n) multiply(of_lobe, moment_of(j, n), column(N + j * W + n), count);
                for (Eigen::Index n = 0; n < N * C; ++n) {
                    combine(std::vector{float(x[N + j * W + n])}, of_one, turned, count);
                    add_product(turned, moment_of(j, W + n), column(n / C), count);
                }
                const float* const e = moment(block, std::size_t(j));
                for (std::size_t c = 0; c < 3; ++c) {
                    multiply(by_channel[c], e, column(X + Eigen::Index(c) * J + j), count);
                    if (beta[c] < beta_limit_[j]) continue;
                    for_limit(x, int(j), [&](Eigen::Index i, double by) {
                        combine(std::vector{float(by * beta[c])}, std::vector<const float*>{by_channel[c]}, turned,
                                count);
                        add_product(turned, e, column(i), count);
                    });
                }
            }
            all.push_back(slopes.of(component));
            add_gram(all, parts[block].data(), count);
            all.pop_back();
        }
    });
    const Eigen::MatrixXd G = summed(parts, columns, rows_.picture_importance / double(rows_.pixels.count()));
    H += G.topLeftCorner(X, X);
    g += G.topRightCorner(X, 1);
    adapting.across += G.block(0, X, X, 3 * J);
    adapting.H += G.block(X, X, 3 * J, 3 * J);
    adapting.g += G.block(X, columns - 1, 3 * J, 1);
}

}  // namespace srbf
