#include "models/pm/solve/pixel_term.h"

#include <array>

#include "base/least_squares.h"
#include "base/parallel.h"
#include "models/pm/solve/simd_columns.h"

namespace SRBF_NAMESPACE {

void CoefficientTerms::eliminate(Eigen::MatrixXd& H_x, Eigen::VectorXd& g_x) const {
    if (free.empty()) return;
    srbf::eliminate(H(free, free), across(Eigen::all, free), H_x, g(free), g_x);
}

Pixels::Colours combine_colours(const Eigen::MatrixXd& beta, std::span<const float* const> values,
                                Aligned<float>& columns, std::size_t count) {
    columns.resize(3 * k_block);
    Pixels::Colours colours;
    for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::VectorXf channel_beta = beta.col(Eigen::Index(c)).cast<float>();
        float* const column = &columns[c * k_block];
        combine({channel_beta.data(), values.size()}, values, column, count);
        colours[c] = column;
    }
    return colours;
}

Pixels::Colours PixelTerm::colours(const Eigen::MatrixXd& beta, std::size_t block) const {
    thread_local Aligned<float> columns;
    std::vector<const float*> values;
    for (Eigen::Index j = 0; j < beta.rows(); ++j) values.push_back(lobe(block, j));
    return combine_colours(beta, values, columns, rows_in_block(block, pixels.count()));
}

double PixelTerm::delta_e(const Eigen::MatrixXd& beta) const {
    double sum = 0;
    for (std::size_t block = 0; block < pixels.blocks(); ++block) sum += pixels.delta_e(block, colours(beta, block));
    return sum / double(pixels.count());
}

Eigen::MatrixXd PixelTerm::products(const Eigen::MatrixXd& beta, Eigen::Index X, const AddByLobe& add_by_lobe,
                                    double& term) const {
    const Eigen::Index J = beta.rows(), columns = X + 3 * J + 1;
    std::vector<double> errors(pixels.blocks());
    std::vector<std::vector<double>> parts(errors.size(), std::vector<double>(std::size_t(columns * columns)));
    for_each(errors.size(), parallel, [&](std::size_t block) {
        thread_local PixelSlopes slopes;
        thread_local Aligned<float> scratch;
        scratch.resize(std::max(scratch.size(), std::size_t(columns) * k_block));
        const auto column = [&](Eigen::Index i) { return &scratch[std::size_t(i) * k_block]; };
        float* const lobe_derivative = column(columns - 1);
        const std::size_t count = rows_in_block(block, pixels.count());
        errors[block] = pixels.errors(block, colours(beta, block), slopes);
        std::vector<const float*> gram_columns;
        for (Eigen::Index i = 0; i + 1 < columns; ++i) gram_columns.push_back(column(i));
        for (std::size_t component = 0; component < 3; ++component) {
            const ByChannel by_channel = slopes.jacobian_of(component);
            std::fill_n(scratch.data(), std::size_t(X) * k_block, 0.f);
            for (Eigen::Index j = 0; j < J; ++j) {
                for (Eigen::Index c = 0; c < 3; ++c)
                    multiply(by_channel[std::size_t(c)], lobe(block, j), column(X + c * J + j), count);
                if (X == 0) continue;
                const Eigen::VectorXf lobe_beta = beta.row(j).cast<float>();
                combine({lobe_beta.data(), 3}, by_channel, lobe_derivative, count);
                add_by_lobe(block, j, lobe_derivative, scratch.data());
            }
            gram_columns.push_back(slopes.residual(component));
            add_gram(gram_columns, parts[block].data(), count);
            gram_columns.pop_back();
        }
    });
    term = 0;
    for (const double error : errors) term += cost_per_pixel * error;
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(columns, columns);
    for (const auto& part : parts) G += Eigen::Map<const Eigen::MatrixXd>(part.data(), columns, columns);
    return cost_per_pixel * Eigen::MatrixXd(G.selfadjointView<Eigen::Upper>());
}

double PixelTerm::loss(const Eigen::MatrixXd& beta, CoefficientTerms& by_coefficients) const {
    double term = 0;
    const Eigen::MatrixXd G = products(beta, 0, {}, term);
    by_coefficients = CoefficientTerms(0, beta.size());
    by_coefficients.H = G.topLeftCorner(beta.size(), beta.size());
    by_coefficients.g = G.topRightCorner(beta.size(), 1);
    return term;
}

void PixelTerm::add_derivatives(const Eigen::MatrixXd& beta, const AddByLobe& add_by_lobe, Eigen::MatrixXd& H,
                                Eigen::VectorXd& g, CoefficientTerms& by_coefficients) const {
    const Eigen::Index X = g.size(), B = beta.size();
    double term = 0;
    const Eigen::MatrixXd G = products(beta, X, add_by_lobe, term);
    H += G.topLeftCorner(X, X);
    g += G.topRightCorner(X, 1);
    by_coefficients.across += G.block(0, X, X, B);
    by_coefficients.H += G.block(X, X, B, B);
    by_coefficients.g += G.block(X, X + B, B, 1);
}

void PixelMoments::evaluate(bool with_derivatives) {
    const PackedObservations& rows = basis_.rows();
    const std::size_t views_per_block = k_block / rows.view_rows;
    moment_.resize(pixels().blocks() * std::size_t(basis_.count() * columns_of_lobe()) * k_block);
    for_each((rows.views + views_per_block - 1) / views_per_block, basis_.parallel(), [&](std::size_t group) {
        for (std::size_t view = group * views_per_block; view < std::min(rows.views, (group + 1) * views_per_block);
             ++view)
            for (int order = 0; order < basis_.shape().orders(); ++order) evaluate_view(view, order, with_derivatives);
    });
}

// Under a directional light a pixel is one row, under an extended light the product of the light with the rows of
// its view. The second order adds to the first.
void PixelMoments::evaluate_view(std::size_t view, int order, bool with_derivatives) {
    const PackedObservations& rows = basis_.rows();
    const std::size_t J = std::size_t(basis_.count()), F = with_derivatives ? std::size_t(basis_.factors()) : 0,
                      count = rows.view_rows, row = rows.first_view_block() * k_block + view * count,
                      block = row / k_block, offset = row % k_block;
    const std::span<const PackedObservations::Pixel> pixels(&rows.pixel[rows.first_pixel[view]],
                                                            &rows.pixel[rows.first_pixel[view + 1]]);
    thread_local Aligned<float> lit;  // light times E_j, for the extended lights
    lit.resize(std::max(lit.size(), pixels.size() * J * count));
    const Aligned<float> ones(count, 1.f);
    std::vector<const float*> lit_lobes, columns{ones.data()};
    for (std::size_t i = 0; i < F; ++i) columns.push_back(basis_.factor(block, int(i), order) + offset);
    const auto store = [&](std::size_t p, std::size_t j, std::size_t i, double value) {
        p += rows.first_pixel[view];
        float& stored = moment(p / k_block, Eigen::Index(i == 0 ? j : J + j * F + i - 1))[p % k_block];
        stored = order == 0 ? float(value) : stored + float(value);
    };
    for (std::size_t p = 0; p < pixels.size(); ++p)
        for (std::size_t j = 0; j < J; ++j) {
            const float* const e = basis_.summand(block, int(j), order) + offset;
            if (!pixels[p].is_directional) {
                float* const product = &lit[lit_lobes.size() * count];
                multiply(&rows.light[pixels[p].light], e, product, count);
                lit_lobes.push_back(product);
                continue;
            }
            const std::size_t index = pixels[p].row - row;
            for (std::size_t i = 0; i <= F; ++i)
                store(p, j, i, double(pixels[p].weight) * double(e[index]) * double(columns[i][index]));
        }
    std::vector<double> products(lit_lobes.size() * columns.size(), 0.0);
    add_products(lit_lobes, columns, products.data(), count);
    const double* product = products.data();
    for (std::size_t p = 0; p < pixels.size(); ++p)
        for (std::size_t j = 0; !pixels[p].is_directional && j < J; ++j)
            for (std::size_t i = 0; i <= F; ++i) store(p, j, i, *product++);
}

PixelTerm PixelMoments::term() {
    return {pixels(), basis_.rows().picture_importance / double(pixels().count()), basis_.parallel(),
            [this](std::size_t block, Eigen::Index j) { return moment(block, j); }};
}

PixelTerm::AddByLobe PixelMoments::derivatives(const Eigen::VectorXd& x) {
    return [&, this](std::size_t block, Eigen::Index j, const float* lobe_derivative, float* columns) {
        const LobeShape& shape = basis_.shape();
        const Eigen::Index N = shape.variates, C = shape.components(), W = shape.width();
        const std::size_t count = rows_in_block(block, pixels().count());
        const auto column = [&](Eigen::Index i) { return &columns[std::size_t(i) * k_block]; };
        const auto with_factor = [&](Eigen::Index i) {
            return moment(block, basis_.count() + j * basis_.factors() + i);
        };
        thread_local Aligned<float> scaled(k_block);
        for (Eigen::Index n = 0; n < W; ++n) multiply(lobe_derivative, with_factor(n), column(N + j * W + n), count);
        for (Eigen::Index n = 0; n < N * C; ++n) {
            combine(std::array{float(x[N + j * W + n])}, std::array{lobe_derivative}, scaled.data(), count);
            add_product(scaled.data(), with_factor(W + n), column(n / C), count);
        }
    };
}

}  // namespace
