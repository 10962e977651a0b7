#include "observe/surface_problem.h"

#include <algorithm>
#include <cmath>

namespace SRBF_NAMESPACE {
namespace {

constexpr std::size_t k_max_surface_pairs = 16384;

std::size_t output_index(std::size_t i, std::size_t c) { return (3 * (i / k_block) + c) * k_block + i % k_block; }
Rgb output_colour(const SurfaceData::Outputs& outputs, std::size_t i) {
    return {outputs[output_index(i, 0)], outputs[output_index(i, 1)], outputs[output_index(i, 2)]};
}
Pixels::Colours output_columns(const SurfaceData::Outputs& outputs, std::size_t block) {
    const float* const first = &outputs[3 * block * k_block];
    return {first, first + k_block, first + 2 * k_block};
}

/// Adds a row of the Jacobian and its residual to the lower triangle of H, and to g.
void add_jacobian_row(const Eigen::VectorXd& row, double r, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    for (Eigen::Index i = 0; i < row.size(); ++i) {
        if (row[i] == 0) continue;
        g[i] += row[i] * r;
        for (Eigen::Index k = 0; k <= i; ++k) H(i, k) += row[i] * row[k];
    }
}

}  // namespace

SurfaceData::SurfaceData(const Observations& observations, std::size_t n) {
    if (observations.views.empty())
        add_pairs(observations, n);
    else
        add_views(observations, n);
}

void SurfaceData::add_views(const Observations& observations, std::size_t n) {
    std::vector<Pixels::Triplet> reference;
    for (std::size_t v = 0; v < observations.views.size(); v += n) {
        const ObservedView& view = observations.views[v];
        for (const ObservedPixel& pixel : view.pixels) {
            pixel_.push_back({wl_.size() + pixel.first, pixel.weight.size(), light_.size()});
            light_.insert(light_.end(), pixel.weight.begin(), pixel.weight.end());
            Pixels::Triplet sum{};
            for (std::size_t i = 0; i < pixel.weight.size(); ++i)
                for (int c = 0; c < 3; ++c)
                    sum[std::size_t(c)] += double(pixel.weight[i]) * double(view.f[pixel.first + i][c]);
            reference.push_back(sum);
        }
        wl_.insert(wl_.end(), view.wl.begin(), view.wl.end());
        wv_.insert(wv_.end(), view.wl.size(), view.wv);
    }
    pixels_ = Pixels(reference);
}

void SurfaceData::add_pairs(const Observations& observations, std::size_t n) {
    const std::size_t fitted = std::min(observations.fitted_count(), k_max_surface_pairs / n);
    const auto append = [&](auto& column, const auto& source) {
        column.insert(column.end(), source.begin(), source.begin() + std::ptrdiff_t(fitted));
    };
    append(wl_, observations.wl), append(wv_, observations.wv);
    append(f_, observations.f), append(weight_, observations.weight);
}

void SurfaceData::add_pairs(const Observations& observations, std::size_t n, const Evaluate& model, double fraction) {
    std::vector<Rgb> f;
    Outputs outputs;
    PixelSlopes slopes;
    compute_outputs(model, f, outputs);
    const double loss_of_pixels = loss(outputs, slopes);
    add_pairs(observations, n);
    compute_outputs(model, f, outputs);
    const double loss_of_pairs = pair_loss(outputs),
                 scale = loss_of_pairs > 0 ? fraction * loss_of_pixels / loss_of_pairs : 0;
    for (double& weight : weight_) weight *= scale;
}

void SurfaceData::compute_outputs(const Evaluate& model, std::vector<Rgb>& f, Outputs& outputs) const {
    f.resize(wl_.size());
    model(wl_, wv_, f);
    outputs.assign(3 * k_block * (pixels_.blocks() + blocks_for(f_.size())), 0);
    for (std::size_t i = 0; i < pixel_.size(); ++i) {
        std::array<double, 3> sum{};
        const Pixel& pixel = pixel_[i];
        for (std::size_t k = 0; k < pixel.count; ++k)
            for (int c = 0; c < 3; ++c)
                sum[std::size_t(c)] += double(light_[pixel.weight + k]) * double(f[pixel.first + k][c]);
        for (std::size_t c = 0; c < 3; ++c) outputs[output_index(i, c)] = float(sum[c]);
    }
    const std::size_t first = pixels_.blocks() * k_block;
    for (std::size_t i = 0; i < f_.size(); ++i)
        for (int c = 0; c < 3; ++c) outputs[output_index(first + i, std::size_t(c))] = f[wl_.size() - f_.size() + i][c];
}

double SurfaceData::pair_loss(const Outputs& outputs) const {
    const std::size_t first = pixels_.blocks() * k_block;
    double sum = 0;
    for (std::size_t i = 0; i < f_.size(); ++i)
        sum += weight_[i] * squared_distance(f_[i], output_colour(outputs, first + i));
    return sum;
}

double SurfaceData::loss(const Outputs& outputs, PixelSlopes& slopes) const {
    double sum = 0;
    for (std::size_t block = 0; block < pixels_.blocks(); ++block)
        sum += pixels_.errors(block, output_columns(outputs, block), slopes);
    return (pixels_.count() > 0 ? sum / double(pixels_.count()) : 0) + pair_loss(outputs);
}

void SurfaceData::linearise(const Outputs& outputs, const std::vector<Outputs>& derivatives, PixelSlopes& slopes,
                            Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
    const auto n = Eigen::Index(derivatives.size());
    H = Eigen::MatrixXd::Zero(n, n);
    g = Eigen::VectorXd::Zero(n);
    add_pixel_rows(outputs, derivatives, slopes, H, g);
    add_pair_rows(outputs, derivatives, H, g);
    H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
}

void SurfaceData::add_pair_rows(const Outputs& outputs, const std::vector<Outputs>& derivatives, Eigen::MatrixXd& H,
                                Eigen::VectorXd& g) const {
    Eigen::VectorXd row(g.size());
    const std::size_t first = pixels_.blocks() * k_block;
    for (std::size_t i = 0; i < f_.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double root = std::sqrt(weight_[i]);
            const std::size_t index = output_index(first + i, c);
            for (std::size_t p = 0; p < derivatives.size(); ++p)
                row[Eigen::Index(p)] = root * double(derivatives[p][index]);
            add_jacobian_row(row, root * double(outputs[index] - f_[i][int(c)]), H, g);
        }
}

void SurfaceData::add_pixel_rows(const Outputs& outputs, const std::vector<Outputs>& derivatives, PixelSlopes& slopes,
                                 Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
    if (pixels_.count() == 0) return;
    Eigen::VectorXd row(g.size());
    const double fraction = 1 / double(pixels_.count());
    for (std::size_t block = 0; block < pixels_.blocks(); ++block) {
        pixels_.errors(block, output_columns(outputs, block), slopes);
        for (std::size_t i = block * k_block; i < std::min((block + 1) * k_block, pixels_.count()); ++i)
            for (std::size_t component = 0; component < 3; ++component) {
                const auto jacobian = slopes.jacobian_of(component);
                for (std::size_t p = 0; p < derivatives.size(); ++p) {
                    double slope = 0;
                    for (std::size_t c = 0; c < 3; ++c)
                        slope += double(jacobian[c][i % k_block]) * double(derivatives[p][output_index(i, c)]);
                    row[Eigen::Index(p)] = slope;
                }
                add_jacobian_row(row, double(slopes.residual(component)[i % k_block]), H, g);
            }
    }
    H *= fraction;
    g *= fraction;
}

}  // namespace
