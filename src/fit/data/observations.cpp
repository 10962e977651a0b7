#include "fit/data/observations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "srbf/directions.h"

namespace srbf {

void Observations::add(Vec3f l, Vec3f v, const Rgb& value, double its_weight, std::span<const float> its_spectrum) {
    wl.push_back(l), wv.push_back(v), f.push_back(value), weight.push_back(its_weight);
    spectrum.insert(spectrum.end(), its_spectrum.begin(), its_spectrum.end());
}

void Observations::exchange(std::size_t i, std::size_t k) {
    if (i == k) return;
    std::swap(wl[i], wl[k]), std::swap(wv[i], wv[k]), std::swap(f[i], f[k]), std::swap(weight[i], weight[k]);
    const std::size_t C = wavelengths.size();
    std::swap_ranges(spectrum.begin() + std::ptrdiff_t(i * C), spectrum.begin() + std::ptrdiff_t((i + 1) * C),
                     spectrum.begin() + std::ptrdiff_t(k * C));
}

void Observations::shuffle(std::mt19937_64& random) {
    for (std::size_t i = f.size(); i-- > 1;) exchange(i, std::size_t(uniform(random) * double(i + 1)));
}

void Observations::resize(std::size_t count) {
    wl.resize(count), wv.resize(count), f.resize(count), weight.resize(count);
    spectrum.resize(count * wavelengths.size());
}

void Observations::normalise() {
    const double energy = energy_of(f, weight);
    if (energy > 0)
        for (double& w : weight) w /= energy;
}

Observations beginning(const Observations& observations, std::size_t count) {
    count = std::min(count, observations.fitted());
    const auto first = [&](const auto& of) {
        return std::remove_cvref_t<decltype(of)>(of.begin(), of.begin() + std::ptrdiff_t(count));
    };
    Observations some;
    some.objective = observations.objective, some.typical = observations.typical;
    some.radiance_error = observations.radiance_error;
    some.wavelengths = observations.wavelengths;
    const std::size_t C = observations.wavelengths.size();
    some.spectrum.assign(observations.spectrum.begin(), observations.spectrum.begin() + std::ptrdiff_t(count * C));
    some.wl = first(observations.wl), some.wv = first(observations.wv);
    some.f = first(observations.f), some.weight = first(observations.weight);
    if (!observations.point_light_weight.empty()) some.point_light_weight = first(observations.point_light_weight);
    some.normalise();
    return some;
}

Result<Done> validate(const Observations& observations, std::size_t parameters) {
    const std::size_t count = observations.f.size();
    if (observations.wl.size() != count || observations.wv.size() != count || observations.weight.size() != count)
        return Error{"fit", {}, "observations", "arrays of one length", "different lengths"};
    if (const std::size_t phases = observations.point_light_weight.size();
        phases > 0 && phases + observations.checks != count)
        return Error{"fit", {}, "phase weights", "none, or those of all observations but the checks", "others"};
    const std::size_t C = observations.wavelengths.size();
    bool has_spectra = observations.spectrum.size() == C * count;
    for (const RadianceObservation& seen : observations.radiances)
        has_spectra = has_spectra && seen.spectrum.size() == C * seen.f.size();
    if (!has_spectra || (C > 0 && !are_wavelengths(observations.wavelengths)))
        return Error{"fit", {}, "observations", "spectra at all of them, at increasing wavelengths", "others"};
    if (!std::ranges::all_of(observations.spectrum, [](float f) { return std::isfinite(f); }))
        return Error{"fit", {}, "observations", "finite spectra", "others"};
    if (observations.checks > count)
        return Error{"fit", {}, "checks", fmt::format("at most {}", count), fmt::format("{}", observations.checks)};
    const std::size_t values = 3 * (count - observations.checks);
    if (values < parameters)
        return Error{
            "fit", {}, "observations", fmt::format("at least {} values", parameters), fmt::format("{}", values)};
    for (const SeenView& view : observations.views) {
        bool valid = view.f.size() == view.wl.size() && view.wl.size() <= k_most_view_directions &&
                     std::ranges::all_of(view.f, [](const Rgb& f) { return is_finite(f); });
        for (const SeenPixel& pixel : view.pixels)
            valid = valid && !pixel.weight.empty() && pixel.first < view.wl.size() &&
                    pixel.weight.size() <= view.wl.size() - pixel.first &&
                    std::ranges::all_of(pixel.weight, [](float w) { return std::isfinite(w); });
        if (!valid)
            return Error{"fit",
                         {},
                         "views",
                         fmt::format("at most {} directions, and pixels of these", k_most_view_directions),
                         "others"};
    }
    for (std::size_t i = 0; i < count; ++i)
        if (!is_finite(observations.f[i]) || !(observations.weight[i] >= 0) || !std::isfinite(observations.weight[i]))
            return Error{"fit", i, "observation", "finite values and a weight of at least 0", "another"};
    const auto end_of_fitted = observations.weight.begin() + std::ptrdiff_t(count - observations.checks);
    if (std::none_of(observations.weight.begin(), end_of_fitted, [](double w) { return w > 0; }))
        return Error{"fit", {}, "observations", "a weight above 0", "none"};
    return Done{};
}

}  // namespace srbf
