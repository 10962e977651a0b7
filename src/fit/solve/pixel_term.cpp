#include "fit/solve/pixel_term.h"

#include <algorithm>
#include <array>

#include "fit/solve/columns.h"
#include "fit/solve/least_squares.h"
#include "parallel.h"

namespace srbf {
namespace {

/// factor times the sum of what add_gram made of blocks, as a whole matrix.
Eigen::MatrixXd summed(const std::vector<std::vector<double>>& parts, Eigen::Index columns, double factor) {
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(columns, columns);
    for (const auto& part : parts) G += Eigen::Map<const Eigen::MatrixXd>(part.data(), columns, columns);
    return factor * Eigen::MatrixXd(G.selfadjointView<Eigen::Upper>());
}

}  // namespace

void Coefficients::eliminate(Eigen::MatrixXd& of_x, Eigen::VectorXd& by_x) const {
    if (free.empty()) return;
    srbf::eliminate(H(free, free), across(Eigen::all, free), of_x, g(free), by_x);
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

void PixelTerm::evaluate(bool with_derivatives) {
    const Rows& rows = basis_.rows();
    const std::size_t in_block = k_block / rows.view_rows;
    moment_.resize(pixels().blocks() * std::size_t(basis_.count() * columns_of_lobe()) * k_block);
    for_each((rows.views + in_block - 1) / in_block, basis_.parallel(), [&](std::size_t of_views) {
        for (std::size_t view = of_views * in_block; view < std::min(rows.views, (of_views + 1) * in_block); ++view)
            evaluate_view(view, with_derivatives);
    });
}

// Under a single light a pixel is one row, under an extended one the product of its lights with the rows of its view.
void PixelTerm::evaluate_view(std::size_t view, bool with_derivatives) {
    const Rows& rows = basis_.rows();
    const std::size_t J = std::size_t(basis_.count()), F = with_derivatives ? std::size_t(basis_.factors()) : 0,
                      count = rows.view_rows, row = rows.first_view_block() * k_block + view * count,
                      block = row / k_block, at = row % k_block;
    const std::span<const Rows::Pixel> pixels(&rows.pixel[rows.first_pixel[view]],
                                              &rows.pixel[rows.first_pixel[view + 1]]);
    thread_local Aligned<float> lit;  // light times E_j, of the extended lights
    lit.resize(std::max(lit.size(), pixels.size() * J * count));
    const Aligned<float> ones(count, 1.f);
    std::vector<const float*> lit_lobes, columns{ones.data()};
    for (std::size_t i = 0; i < F; ++i) columns.push_back(basis_.factor(block, int(i)) + at);
    const auto store = [&](std::size_t p, std::size_t j, std::size_t i, double value) {
        p += rows.first_pixel[view];
        moment(p / k_block, Eigen::Index(i == 0 ? j : J + j * F + i - 1))[p % k_block] = float(value);
    };
    for (std::size_t p = 0; p < pixels.size(); ++p)
        for (std::size_t j = 0; j < J; ++j) {
            const float* const e = basis_.lobe(block, int(j)) + at;
            if (!pixels[p].single) {
                float* const to = &lit[lit_lobes.size() * count];
                multiply(&rows.light[pixels[p].light], e, to, count);
                lit_lobes.push_back(to);
                continue;
            }
            const std::size_t of_row = pixels[p].row - row;
            for (std::size_t i = 0; i <= F; ++i)
                store(p, j, i, double(pixels[p].weight) * double(e[of_row]) * double(columns[i][of_row]));
        }
    std::vector<double> products(lit_lobes.size() * columns.size(), 0.0);
    add_products(lit_lobes, columns, products.data(), count);
    const double* product = products.data();
    for (std::size_t p = 0; p < pixels.size(); ++p)
        for (std::size_t j = 0; !pixels[p].single && j < J; ++j)
            for (std::size_t i = 0; i <= F; ++i) store(p, j, i, *product++);
}

Pixels::Colours PixelTerm::colours(const Eigen::MatrixXd& beta, std::size_t block) {
    thread_local Aligned<float> columns;
    std::vector<const float*> moments;
    for (Eigen::Index j = 0; j < basis_.count(); ++j) moments.push_back(moment(block, j));
    return combined(beta, moments, columns, rows_in_block(block, pixels().count()));
}

double PixelTerm::delta_e(const Eigen::MatrixXd& beta) {
    double sum = 0;
    for (std::size_t block = 0; block < pixels().blocks(); ++block)
        sum += pixels().delta_e(block, colours(beta, block));
    return sum / double(pixels().count());
}

double PixelTerm::loss(const Eigen::MatrixXd& beta, Coefficients& by_coefficients) {
    const Eigen::Index J = basis_.count(), columns = 3 * J + 1;
    std::vector<double> errors(pixels().blocks());
    std::vector<std::vector<double>> parts(errors.size(), std::vector<double>(std::size_t(columns * columns)));
    for_each(errors.size(), basis_.parallel(), [&](std::size_t block) {
        thread_local PixelSlopes slopes;
        thread_local Aligned<float> scratch;
        scratch.resize(std::max(scratch.size(), std::size_t(3 * J) * k_block));
        const std::size_t count = rows_in_block(block, pixels().count());
        errors[block] = pixels().errors(block, colours(beta, block), slopes);
        std::vector<const float*> all;
        for (std::size_t component = 0; component < 3; ++component) {
            all.clear();
            for (std::size_t c = 0; c < 3; ++c)
                for (Eigen::Index j = 0; j < J; ++j) {
                    float* const column = &scratch[all.size() * k_block];
                    multiply(slopes.by(component)[c], moment(block, j), column, count);
                    all.push_back(column);
                }
            all.push_back(slopes.of(component));
            add_gram(all, parts[block].data(), count);
        }
    });
    const double share = basis_.rows().picture_importance / double(pixels().count());
    double sum = 0;
    for (const double error : errors) sum += share * error;
    const Eigen::MatrixXd G = summed(parts, columns, share);
    by_coefficients = Coefficients(0, beta.size());
    by_coefficients.H = G.topLeftCorner(3 * J, 3 * J);
    by_coefficients.g = G.topRightCorner(3 * J, 1);
    return sum;
}

void PixelTerm::set_columns(const Eigen::VectorXd& x, const Eigen::MatrixXd& beta, const Eigen::VectorXd& limit,
                            std::size_t block, const std::array<const float*, 3>& by_channel, float* columns) {
    const LobeShape& shape = basis_.shape();
    const Eigen::Index J = basis_.count(), N = shape.variates, C = shape.components(), W = shape.width(),
                       F = basis_.factors(), X = x.size();
    const std::size_t count = rows_in_block(block, pixels().count());
    const auto column = [&](Eigen::Index i) { return &columns[std::size_t(i) * k_block]; };
    const auto moment_of = [&](Eigen::Index j, Eigen::Index i) { return moment(block, J + j * F + i); };
    float *const of_lobe = column(X + 3 * J), *const turned = column(X + 3 * J + 1);
    const std::vector<const float*> of_one{of_lobe};
    std::fill_n(columns, std::size_t(X + 3 * J) * k_block, 0.f);
    for (Eigen::Index j = 0; j < J; ++j) {
        const Pixels::Triplet of_j{beta(j, 0), beta(j, 1), beta(j, 2)};
        combine(std::vector<float>(of_j.begin(), of_j.end()), by_channel, of_lobe, count);
        for (Eigen::Index n = 0; n < W; ++n) multiply(of_lobe, moment_of(j, n), column(N + j * W + n), count);
        for (Eigen::Index n = 0; n < N * C; ++n) {
            combine(std::vector{float(x[N + j * W + n])}, of_one, turned, count);
            add_product(turned, moment_of(j, W + n), column(n / C), count);
        }
        const float* const e = moment(block, j);
        for (std::size_t c = 0; c < 3; ++c) {
            multiply(by_channel[c], e, column(X + Eigen::Index(c) * J + j), count);
            if (of_j[c] < limit[j]) continue;
            for (const auto& [i, by] : slopes_of_limit(x, shape, j)) {
                combine(std::vector{float(by * of_j[c])}, std::vector<const float*>{by_channel[c]}, turned, count);
                add_product(turned, e, column(i), count);
            }
        }
    }
}

// The columns of a block of pixels, of which `add_gram` makes the products, are the derivatives of the three components
// of ΔE_ITP by x and by the coefficients, and the components' differences.
void PixelTerm::add_derivatives(const Eigen::VectorXd& x, const Eigen::MatrixXd& beta, const Eigen::VectorXd& limit,
                                Eigen::MatrixXd& H, Eigen::VectorXd& g, Coefficients& by_coefficients) {
    const Eigen::Index J = basis_.count(), X = x.size(), columns = X + 3 * J + 1;
    evaluate(true);
    std::vector<std::vector<double>> parts(pixels().blocks(), std::vector<double>(std::size_t(columns * columns)));
    for_each(parts.size(), basis_.parallel(), [&](std::size_t block) {
        thread_local PixelSlopes slopes;
        thread_local Aligned<float> scratch;
        scratch.resize(std::max(scratch.size(), std::size_t(columns + 1) * k_block));
        pixels().errors(block, colours(beta, block), slopes);
        std::vector<const float*> all;
        for (Eigen::Index i = 0; i + 1 < columns; ++i) all.push_back(&scratch[std::size_t(i) * k_block]);
        for (std::size_t component = 0; component < 3; ++component) {
            set_columns(x, beta, limit, block, slopes.by(component), scratch.data());
            all.push_back(slopes.of(component));
            add_gram(all, parts[block].data(), rows_in_block(block, pixels().count()));
            all.pop_back();
        }
    });
    const Eigen::MatrixXd G = summed(parts, columns, basis_.rows().picture_importance / double(pixels().count()));
    H += G.topLeftCorner(X, X);
    g += G.topRightCorner(X, 1);
    by_coefficients.across += G.block(0, X, X, 3 * J);
    by_coefficients.H += G.block(X, X, 3 * J, 3 * J);
    by_coefficients.g += G.block(X, columns - 1, 3 * J, 1);
}

}  // namespace srbf
