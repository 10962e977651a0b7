#include "observe/observations.h"

#include <fmt/format.h>

#include "brdf/directions.h"
#include "srbf/elementary.h"

namespace SRBF_NAMESPACE {

void Observations::add(Vec3f l, Vec3f v, const Rgb& value, double value_weight, std::span<const float> value_spectrum) {
    wl.push_back(l);
    wv.push_back(v);
    f.push_back(value);
    weight.push_back(value_weight);
    spectrum.insert(spectrum.end(), value_spectrum.begin(), value_spectrum.end());
}

bool Observations::is_noisy() const {
    return std::ranges::any_of(integrals, [](const ObservedIntegral& integral) { return integral.noise_unit > 0; });
}

bool Observations::is_grey() const {
    return std::ranges::all_of(f, [](const Rgb& value) { return value.r == value.g && value.g == value.b; });
}

void Observations::append(const Observations& added) {
    const auto extend = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    extend(wl, added.wl);
    extend(wv, added.wv);
    extend(f, added.f);
    extend(weight, added.weight);
    if (!wavelengths.empty()) extend(spectrum, added.spectrum);
}

void Observations::swap_rows(std::size_t i, std::size_t k) {
    if (i == k) return;
    std::swap(wl[i], wl[k]);
    std::swap(wv[i], wv[k]);
    std::swap(f[i], f[k]);
    std::swap(weight[i], weight[k]);
    const std::size_t C = wavelengths.size();
    std::swap_ranges(spectrum.begin() + std::ptrdiff_t(i * C), spectrum.begin() + std::ptrdiff_t((i + 1) * C),
                     spectrum.begin() + std::ptrdiff_t(k * C));
}

void Observations::shuffle(std::mt19937_64& random) {
    for (std::size_t i = f.size(); i-- > 1;) swap_rows(i, std::size_t(uniform(random) * double(i + 1)));
}

void Observations::resize(std::size_t count) {
    wl.resize(count);
    wv.resize(count);
    f.resize(count);
    weight.resize(count);
    spectrum.resize(count * wavelengths.size());
}

void Observations::normalise() {
    const double energy = energy_of(f, weight);
    if (energy > 0)
        for (double& w : weight) w /= energy;
}

double loss_of(const Observations& observations, const Evaluate& fitted) {
    const std::size_t count = observations.fitted_count();
    std::vector<Rgb> f(count);
    fitted(std::span(observations.wl).first(count), std::span(observations.wv).first(count), f);
    double loss = 0;
    for (std::size_t i = 0; i < count; ++i) loss += observations.weight[i] * squared_distance(observations.f[i], f[i]);
    return loss;
}

std::array<double, 3> mean_value(const Observations& observations) {
    double weight = 0;
    std::array<double, 3> mean{};
    for (std::size_t i = 0; i < observations.fitted_count(); ++i) {
        weight += observations.weight[i];
        for (int c = 0; c < 3; ++c) mean[std::size_t(c)] += observations.weight[i] * double(observations.f[i][c]);
    }
    for (double& channel : mean) channel = weight > 0 ? channel / weight : 0;
    return mean;
}

double largest_square(const Observations& observations) {
    double largest = 0;
    for (std::size_t i = 0; i < observations.f.size(); ++i)
        largest = std::max(largest, square_of(observations.f[i]) *
                                        elementary::square(cosines(observations.wl[i], observations.wv[i])));
    return largest;
}

double horizon_weight(Vec3f wl, Vec3f wv, double importance, std::size_t count, double largest_square) {
    const double area = cosines(wl, wv);
    return importance * area * area / (double(count) * largest_square);
}

Observations first_pairs(const Observations& observations, std::size_t count) {
    count = std::min(count, observations.fitted_count());
    Observations selected;
    selected.objective = observations.objective;
    selected.typical = observations.typical;
    selected.integral_error = observations.integral_error;
    selected.wavelengths = observations.wavelengths;
    const auto copy_first = [](auto& to, const auto& from, std::size_t numbers) {
        to.assign(from.begin(), from.begin() + std::ptrdiff_t(numbers));
    };
    copy_first(selected.wl, observations.wl, count);
    copy_first(selected.wv, observations.wv, count);
    copy_first(selected.f, observations.f, count);
    copy_first(selected.weight, observations.weight, count);
    copy_first(selected.spectrum, observations.spectrum, count * observations.wavelengths.size());
    selected.normalise();
    return selected;
}

Result<Done> validate(const Observations& observations, std::size_t parameters) {
    const std::size_t fitted = observations.fitted_count();
    const auto refuse = [](const char* what, std::string expected, std::string found) {
        return Error{"fit", {}, what, std::move(expected), std::move(found)};
    };
    if (3 * fitted < parameters)
        return refuse("observations", fmt::format("at least {} values", parameters), fmt::format("{}", 3 * fitted));
    for (std::size_t i = 0; i < observations.f.size(); ++i)
        if (!is_finite(observations.f[i]) || !(observations.weight[i] >= 0) || !std::isfinite(observations.weight[i]))
            return Error{"fit", i, "observation", "finite values and a weight of at least 0",
                         fmt::format("{:g}, {:g}, {:g} and {:g}", observations.f[i].r, observations.f[i].g,
                                     observations.f[i].b, observations.weight[i])};
    if (std::ranges::none_of(std::span(observations.weight).first(fitted), [](double w) { return w > 0; }))
        return refuse("observations", "a weight above 0", "none");
    if (!std::ranges::all_of(observations.spectrum, [](float f) { return std::isfinite(f); }))
        return refuse("observations", "finite spectra", "");
    return Done{};
}

namespace {

/// Cosines below this count as this.
constexpr float k_min_weight_cosine = 1e-6f;

/// Replaces `count` values of each pair by their mean with the values of the exchanged pair.
void average(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::size_t count, float* f,
             const float* exchanged) {
    for (std::size_t i = 0; i < wl.size(); ++i) {
        const float cosine_l = std::max(wl[i].z, k_min_weight_cosine),
                    cosine_v = std::max(wv[i].z, k_min_weight_cosine), fraction = cosine_v / (cosine_v + cosine_l);
        for (std::size_t c = i * count; c < (i + 1) * count; ++c) {
            if (std::isnan(exchanged[c])) continue;
            f[c] = std::isnan(f[c]) ? exchanged[c] : fraction * f[c] + (1 - fraction) * exchanged[c];
        }
    }
}

}  // namespace

Evaluate reciprocal_mean(Evaluate f) {
    return [f = std::move(f)](std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<Rgb> values) {
        std::vector<Rgb> exchanged(values.size());
        f(wl, wv, values);
        f(wv, wl, exchanged);
        if (!values.empty()) average(wl, wv, 3, &values[0].r, &exchanged[0].r);
    };
}

Channels reciprocal_mean(Channels f) {
    const std::size_t count = f.count();
    return {f.wavelengths, [count, f = std::move(f.evaluate)](std::span<const Vec3f> wl, std::span<const Vec3f> wv,
                                                              std::span<float> values) {
                std::vector<float> exchanged(values.size());
                f(wl, wv, values);
                f(wv, wl, exchanged);
                average(wl, wv, count, values.data(), exchanged.data());
            }};
}

}  // namespace
