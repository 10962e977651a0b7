#include "measured/samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "measured/limits.h"

namespace srbf {

bool has_colours(std::span<const float> wavelengths) {
    constexpr float blue = 500, red = 600;
    return wavelengths.size() >= 3 && wavelengths.front() <= blue && wavelengths.back() >= red;
}

SampleBuilder::SampleBuilder(Values values, std::vector<float> wavelengths, std::size_t bytes, std::size_t rows)
    : values_(values), bytes_(bytes) {
    if (values == Values::spectrum) {
        weights_ = rgb_weights(wavelengths);
        // Wavelengths of lasers determine no colour, and are shown in grey.
        if (!has_colours(wavelengths))
            for (Rgb& weight : weights_) weight.r = weight.g = weight.b = float(luminance(weight));
    }
    samples_.wavelengths = std::move(wavelengths);
    // Memory holds the text and the samples at first, later the samples and their index.
    constexpr std::size_t slack = 32 << 20, index = 36;
    const std::size_t sample = 2 * sizeof(Vec3f) + sizeof(Rgb) + sizeof(float) * (weights_.size() + 1);
    most_ = std::min((3 * bytes + slack) / sample, (4 * bytes + slack) / (sample + index));
    const std::size_t most = std::min(rows, most_);
    samples_.wl.reserve(most);
    samples_.wv.reserve(most);
    samples_.colour.reserve(most);
    samples_.spectrum.reserve(most * weights_.size());
}

void SampleBuilder::add(Vec3d wl, Vec3d wv, std::span<const float> f, float weight) {
    assert(f.size() == width());
    const auto is_value = [](float x) { return std::abs(x) <= k_largest_value; };
    const auto is_direction = [](Vec3d w) { return w.z > 1e-6 && std::abs(dot(w, w) - 1) < 1e-3; };
    if (!is_direction(wl) || !is_direction(wv) || !std::ranges::all_of(f, is_value)) {
        ++samples_.masked;
        return;
    }
    if (samples_.wl.size() == most_) {
        too_many_ = true;
        return;
    }
    samples_.wl.push_back(to_float(wl));
    samples_.wv.push_back(to_float(wv));
    if (weight != 1 && samples_.weight.empty()) samples_.weight.resize(samples_.wl.size() - 1, 1);
    if (weight != 1 || !samples_.weight.empty()) samples_.weight.push_back(weight);
    switch (values_) {
        case Values::grey:
            samples_.colour.push_back({f[0], f[0], f[0]});
            break;
        case Values::rgb:
        case Values::xyz:
            samples_.colour.push_back({f[0], f[1], f[2]});  // XYZ until `finish`
            break;
        case Values::spectrum:
            samples_.colour.push_back(to_rgb(f, weights_));
            samples_.spectrum.insert(samples_.spectrum.end(), f.begin(), f.end());
            break;
    }
}

namespace {

/// Finds a negative number that marks missing values, such as −999: the smallest value, if it is an integer or occurs
/// more than once, its magnitude exceeds twice the median of positive values, and it is ten times as far below 0 as the
/// values of all other samples. A sample with another channel as large is a saturated colour instead. `rows` holds
/// `width` values for each sample.
std::optional<float> missing_value(std::span<const float> rows, std::size_t width) {
    const float least = std::ranges::min(rows);
    if (!(least < 0)) return {};
    std::vector<float> positive;
    std::size_t occurrences = 0;
    float next = 0;
    for (std::size_t begin = 0; begin < rows.size(); begin += width) {
        const auto row = rows.subspan(begin, width);
        const bool has = std::ranges::find(row, least) != row.end();
        if (has && std::ranges::any_of(row, [&](float f) { return f >= -least; })) return {};
        occurrences += has;
        for (const float f : row) {
            if (f > 0) positive.push_back(f);
            if (!has) next = std::min(next, f);
        }
    }
    if (occurrences < 2 && least != std::round(least)) return {};
    if (next < least / 10) return {};
    if (positive.empty()) return least;
    const auto median = positive.begin() + std::ptrdiff_t(positive.size() / 2);
    std::ranges::nth_element(positive, median);
    return -least > 2 * *median ? std::optional(least) : std::nullopt;
}

}  // namespace

void keep_samples(ScatteredSamples& samples, const std::function<bool(std::size_t)>& keep) {
    const std::size_t channels = samples.wavelengths.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        if (!keep(i)) continue;
        samples.wl[kept] = samples.wl[i], samples.wv[kept] = samples.wv[i], samples.colour[kept] = samples.colour[i];
        if (!samples.weight.empty()) samples.weight[kept] = samples.weight[i];
        std::copy_n(samples.spectrum.begin() + std::ptrdiff_t(i * channels), channels,
                    samples.spectrum.begin() + std::ptrdiff_t(kept * channels));
        ++kept;
    }
    samples.masked += samples.wl.size() - kept;
    samples.wl.resize(kept), samples.wv.resize(kept), samples.colour.resize(kept);
    samples.spectrum.resize(kept * channels);
    if (!samples.weight.empty()) samples.weight.resize(kept);
}

void to_bsdf(ScatteredSamples& samples, Quantity quantity) {
    if (quantity != Quantity::factor && quantity != Quantity::cosine) return;
    const std::size_t channels = samples.wavelengths.size();
    const auto is_value = [](float f) { return std::abs(f) <= k_largest_value; };
    const auto row = [&](std::size_t i) { return std::span(samples.spectrum).subspan(i * channels, channels); };
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        const double scale = quantity == Quantity::factor ? k_pi : double(samples.wv[i].z);
        for (float& f : row(i)) f = float(double(f) / scale);
        for (int c = 0; c < 3; ++c) samples.colour[i][c] = float(double(samples.colour[i][c]) / scale);
    }
    keep_samples(samples, [&](std::size_t i) {
        const Rgb& f = samples.colour[i];
        return is_value(f.r) && is_value(f.g) && is_value(f.b) && std::ranges::all_of(row(i), is_value);
    });
}

std::string expected_angle(AngleKind kind, double number, AngleUnit unit) {
    constexpr double rounding = 1 + 1e-3;
    const double most = kind == AngleKind::polar ? k_pi : 4 * k_pi;
    if (!(std::abs(number * unit.radians) > most * rounding)) return {};
    return fmt::format("{} within {:.4g} {}", kind == AngleKind::polar ? "a polar angle" : "an azimuth",
                       most / unit.radians, unit.name);
}

void SampleBuilder::mask_missing() {
    // A file may have several such numbers: −9999 for not measured, −999 for saturated.
    constexpr int k_most_kinds = 4;
    for (int kind = 0; kind < k_most_kinds && !samples_.wl.empty(); ++kind) {
        const std::size_t width = values_ == Values::spectrum ? weights_.size() : 3;
        const std::span<const float> rows =
            values_ == Values::spectrum ? std::span<const float>(samples_.spectrum)
                                        : std::span<const float>(&samples_.colour[0].r, 3 * samples_.colour.size());
        const auto missing = missing_value(rows, width);
        if (!missing) return;
        const std::uint64_t before = samples_.masked;
        keep_samples(samples_, [&](std::size_t i) {
            const auto row = rows.subspan(i * width, width);
            return std::ranges::find(row, *missing) == row.end();
        });
        samples_.notes.push_back(fmt::format("{} samples of {:g}, which stands for no value, are masked",
                                             samples_.masked - before, *missing));
    }
}

Result<ScatteredSamples> SampleBuilder::finish(const std::string& file_name, std::string description,
                                               bool isotropic) && {
    mask_missing();
    if (values_ == Values::xyz)
        for (Rgb& f : samples_.colour) f = to_rgb(Xyz{double(f.r), double(f.g), double(f.b)});
    if (samples_.wl.empty())
        return Error{file_name,
                     {},
                     "samples",
                     "at least one that is finite and above the horizon",
                     samples_.masked == 0 ? "none" : fmt::format("{} that are not", samples_.masked)};
    if (too_many_)
        return Error{file_name, {}, "samples", fmt::format("at most {} in a file of {} bytes", most_, bytes_), "more"};
    samples_.description = std::move(description);
    samples_.isotropic = isotropic;
    return std::move(samples_);
}

Result<ScatteredSamples> indexed(Result<ScatteredSamples> samples) {
    if (samples) make_index(*samples);
    return samples;
}

bool is_text(std::span<const std::byte> bytes) {
    return std::ranges::none_of(as_text(bytes).substr(0, 4096), [](char c) {
        const auto code = static_cast<unsigned char>(c);
        return code < 0x20 && c != '\t' && c != '\n' && c != '\r';
    });
}

}  // namespace srbf
