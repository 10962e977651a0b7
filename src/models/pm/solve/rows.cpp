#include "models/pm/solve/rows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace srbf {
namespace {

/// A search sees every so many nodes of an integral.
constexpr std::size_t k_integral_step = 9;

}  // namespace

template <typename Value> void Rows::set(std::size_t i, Vec3f l, Vec3f v, double factor, const Value& f) {
    wl[0][i] = l.x, wl[1][i] = l.y, wl[2][i] = l.z;
    wv[0][i] = v.x, wv[1][i] = v.y, wv[2][i] = v.z;
    root_weight[i] = float(factor * scale);
    for (std::size_t c = 0; c < y.size(); ++c) y[c][i] = float(factor * double(f(c)));
}

Rows::Rows(const Observations& observations, const RowOptions& options) {
    const std::size_t count = observations.fitted_count();
    blocks = blocks_for(count), pairs = count;
    const std::size_t step = options.subsampled_integrals ? k_integral_step : 1;
    std::vector<const ObservedIntegral*> some;
    for (const ObservedIntegral& of : observations.integrals)
        if (options.integral_importance > 0 && (of.in_search || !options.subsampled_integrals)) some.push_back(&of);
    integrals = some.size();
    double costs = 0;
    for (const ObservedIntegral* of : some) {
        integral_blocks = std::max(integral_blocks, blocks_for((of->wl.size() + step - 1) / step));
        costs += of->cost;
    }
    const auto has_pixels = [](const ObservedView& view) { return !view.pixels.empty(); };
    if (options.picture_importance > 0 && !options.spectra && std::ranges::any_of(observations.views, has_pixels)) {
        picture_importance = options.picture_importance;
        views = observations.views.size(), view_rows = k_row_multiple;
        for (const ObservedView& view : observations.views)
            view_rows = std::max(view_rows, std::bit_ceil(view.wl.size()));
    }
    // Padding rows: any direction is fine, the weight is 0.
    const std::size_t rows = whole_blocks() * k_block;
    for (std::size_t k = 0; k < 3; ++k) {
        wl[k].assign(rows, k == 2 ? 1.f : 0.f);
        wv[k].assign(rows, k == 2 ? 1.f : 0.f);
    }
    const std::size_t C = options.spectra ? observations.wavelengths.size() : 3;
    y.assign(C, Aligned<float>(rows, 0.f));
    // Channel c of an observation or of a node of an integral.
    const auto value_of = [C, spectra = options.spectra](const auto& of, std::size_t i) {
        return [&of, i, C, spectra](std::size_t c) { return spectra ? of.spectrum[i * C + c] : of.f[i][int(c)]; };
    };
    root_weight.assign(rows, 0.f);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += observations.weight[i];
    if (sum > 0) scale = 1 / std::sqrt(sum);
    for (std::size_t i = 0; i < count; ++i)
        set(i, observations.wl[i], observations.wv[i], std::sqrt(observations.weight[i]), value_of(observations, i));
    for (std::size_t k = 0; k < integrals; ++k) {
        const ObservedIntegral& seen = *some[k];
        double whole = 0;
        for (std::size_t i = 0; i < seen.wl.size(); i += step) whole += seen.weight[i] * double(luminance(seen.f[i]));
        whole = std::max({whole, seen.least_unit / double(step), seen.noise_unit / std::sqrt(double(step))});
        if (!(whole > 0)) continue;
        const double factor = std::sqrt(options.integral_importance * seen.cost / costs) / whole;
        std::size_t row = (blocks + k * integral_blocks) * k_block;
        for (std::size_t i = 0; i < seen.wl.size(); i += step)
            set(row++, seen.wl[i], seen.wv[i], factor * seen.weight[i], value_of(seen, i));
    }
    if (views > 0) add_views(observations.views);
}

void Rows::add_views(const std::vector<ObservedView>& all) {
    const std::size_t begin = first_view_block() * k_block;
    std::vector<Pixels::Triplet> colours;
    for (std::size_t k = 0; k < views; ++k) {
        const ObservedView& view = all[k];
        const std::size_t first = begin + k * view_rows;
        for (std::size_t i = 0; i < view.wl.size(); ++i)
            set(first + i, view.wl[i], view.wv, 1, [&](std::size_t c) { return view.f[i][int(c)]; });
        first_pixel.push_back(pixel.size());
        for (const ObservedPixel& seen : view.pixels) {
            const bool single = seen.weight.size() == 1;
            pixel.push_back({single ? first + seen.first : first, single, seen.weight[0], light.size()});
            if (!single) light.resize(light.size() + view_rows);
            Pixels::Triplet colour{};
            for (std::size_t i = 0; i < seen.weight.size(); ++i) {
                if (!single) light[pixel.back().light + seen.first + i] = seen.weight[i];
                for (std::size_t c = 0; c < 3; ++c)
                    colour[c] += double(seen.weight[i]) * double(view.f[seen.first + i][int(c)]);
            }
            colours.push_back(colour);
        }
    }
    first_pixel.push_back(pixel.size());
    pixels = Pixels(colours);
}

}  // namespace srbf
