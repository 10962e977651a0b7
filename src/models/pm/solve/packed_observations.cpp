#include "models/pm/solve/packed_observations.h"

#include <bit>
#include <cmath>

#include "models/pm/solve/simd_columns.h"

namespace SRBF_NAMESPACE {
namespace {

/// A search uses every ninth node of an integral.
constexpr std::size_t k_integral_step = 9;

}  // namespace

template <typename Value> void PackedObservations::set(std::size_t i, Vec3f l, Vec3f v, double factor, const Value& f) {
    wl[0][i] = l.x, wl[1][i] = l.y, wl[2][i] = l.z;
    wv[0][i] = v.x, wv[1][i] = v.y, wv[2][i] = v.z;
    root_weight[i] = float(factor * scale);
    for (std::size_t c = 0; c < y.size(); ++c) y[c][i] = float(factor * double(f(c)));
}

PackedObservations::PackedObservations(const Observations& observations, const PackingOptions& options) {
    const std::size_t count = observations.fitted_count();
    blocks = blocks_for(count), pairs = count;
    const std::size_t step = options.subsampled_integrals ? k_integral_step : 1;
    std::vector<const ObservedIntegral*> used;
    for (const ObservedIntegral& integral : observations.integrals)
        if (options.integral_importance > 0 && (integral.in_search || !options.subsampled_integrals))
            used.push_back(&integral);
    integrals = used.size();
    double costs = 0;
    for (const ObservedIntegral* integral : used) {
        integral_blocks = std::max(integral_blocks, blocks_for((integral->wl.size() + step - 1) / step));
        costs += integral->is_bound ? 0 : integral->cost;
    }
    const auto has_pixels = [](const ObservedView& view) { return !view.pixels.empty(); };
    if (options.picture_importance > 0 && std::ranges::any_of(observations.views, has_pixels)) {
        picture_importance = options.picture_importance;
        views = observations.views.size(), view_rows = k_row_multiple;
        for (const ObservedView& view : observations.views)
            view_rows = std::max(view_rows, std::bit_ceil(view.wl.size()));
    }
    // Padding rows may have any direction; their weight is 0.
    const std::size_t rows = total_blocks() * k_block;
    for (std::size_t k = 0; k < 3; ++k) {
        wl[k].assign(rows, k == 2 ? 1.f : 0.f);
        wv[k].assign(rows, k == 2 ? 1.f : 0.f);
    }
    const std::size_t C = options.spectra ? observations.wavelengths.size() : 3;
    y.assign(C, Aligned<float>(rows, 0.f));
    root_weight.assign(rows, 0.f);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += observations.weight[i];
    if (sum > 0) scale = 1 / std::sqrt(sum);
    for (std::size_t i = 0; i < count; ++i)
        set(i, observations.wl[i], observations.wv[i], std::sqrt(observations.weight[i]), [&](std::size_t c) {
            return options.spectra ? observations.spectrum[i * C + c] : observations.f[i][int(c)];
        });
    for (std::size_t k = 0; k < integrals; ++k) {
        const ObservedIntegral& integral = *used[k];
        double unit = 0;
        for (std::size_t i = 0; i < integral.wl.size(); i += step)
            unit += integral.weight[i] * double(luminance(integral.f[i]));
        unit = std::max({unit, integral.min_unit / double(step), integral.noise_unit / std::sqrt(double(step))});
        if (!(unit > 0)) continue;
        const double factor = std::sqrt(options.integral_importance * integral.cost / (costs > 0 ? costs : 1)) / unit;
        std::size_t row = (blocks + k * integral_blocks) * k_block;
        for (std::size_t i = 0; i < integral.wl.size(); i += step)
            set(row++, integral.wl[i], integral.wv[i], factor * integral.weight[i],
                [&](std::size_t c) { return integral.f[i][int(c)]; });
    }
    if (views > 0) add_views(observations.views);
}

void PackedObservations::add_views(const std::vector<ObservedView>& observed_views) {
    const std::size_t begin = first_view_block() * k_block;
    std::vector<Pixels::Triplet> colours;
    for (std::size_t k = 0; k < views; ++k) {
        const ObservedView& view = observed_views[k];
        const std::size_t first = begin + k * view_rows;
        for (std::size_t i = 0; i < view.wl.size(); ++i)
            set(first + i, view.wl[i], view.wv, 1, [&](std::size_t c) { return view.f[i][int(c)]; });
        first_pixel.push_back(pixel.size());
        for (const ObservedPixel& observed : view.pixels) {
            const bool is_directional = observed.weight.size() == 1;
            pixel.push_back(
                {is_directional ? first + observed.first : first, is_directional, observed.weight[0], light.size()});
            if (!is_directional) light.resize(light.size() + view_rows);
            Pixels::Triplet colour{};
            for (std::size_t i = 0; i < observed.weight.size(); ++i) {
                if (!is_directional) light[pixel.back().light + observed.first + i] = observed.weight[i];
                for (std::size_t c = 0; c < 3; ++c)
                    colour[c] += double(observed.weight[i]) * double(view.f[observed.first + i][int(c)]);
            }
            colours.push_back(colour);
        }
    }
    first_pixel.push_back(pixel.size());
    pixels = Pixels(colours);
}

Eigen::MatrixXd products_of_columns(const PackedObservations& rows, std::size_t count, bool parallel,
                                    const FillColumns& fill) {
    std::vector<std::vector<double>> parts(rows.chunks());
    rows.for_chunks(parts.size(), parallel, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        const bool is_integral = rows.is_integral(begin);
        parts[chunk].assign(is_integral ? count : count * count, 0.0);
        std::vector<const float*> columns(count);
        for (std::size_t block = begin; block < end; ++block) {
            fill(block, columns);
            if (!is_integral) add_gram(columns, parts[chunk].data(), rows.rows_in(block));
            for (std::size_t i = 0; is_integral && i < count; ++i) parts[chunk][i] += sum(columns[i]);
        }
    });
    // Row-major lower triangles are column-major upper ones.
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(Eigen::Index(count), Eigen::Index(count));
    for (std::size_t chunk = 0; chunk < rows.chunks_of_pairs(); ++chunk)
        G += Eigen::Map<const Eigen::MatrixXd>(parts[chunk].data(), G.rows(), G.cols());
    for (std::size_t chunk = rows.chunks_of_pairs(); chunk < rows.chunks(); ++chunk)
        G.selfadjointView<Eigen::Upper>().rankUpdate(Eigen::Map<const Eigen::VectorXd>(parts[chunk].data(), G.rows()));
    return G.selfadjointView<Eigen::Upper>();
}

}  // namespace
