// What is seen of lobes: the part of LobeProblem that pixels are.
#include <algorithm>
#include <utility>

#include "fit/lobes.h"
#include "least_squares.h"

namespace srbf {

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

// By a few steps of Gauss and Newton: the gradient of what remains is part of `linearise`.
void LobeProblem::fit_to_pixels(const Eigen::MatrixXd& G) {
    constexpr int k_most_steps = 2;
    constexpr double k_tolerance = 1e-7, k_least_share = 0.05;
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

}  // namespace srbf
