#include "measured/samples.h"

#include "base/errors.h"
#include "base/floating_point.h"
#include "measured/bytes.h"
#include "srbf/convert.h"
#include "srbf/file.h"
#include "srbf/handles.h"

namespace SRBF_NAMESPACE {

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
    max_ = std::min((3 * bytes + slack) / sample, (4 * bytes + slack) / (sample + index));
    const std::size_t max = std::min(rows, max_);
    samples_.wl.reserve(max);
    samples_.wv.reserve(max);
    samples_.colour.reserve(max);
    samples_.spectrum.reserve(max * weights_.size());
}

void SampleBuilder::add(Vec3d wl, Vec3d wv, std::span<const float> f, float weight) {
    assert(f.size() == width());
    const auto is_value = [](float x) { return std::abs(x) <= k_largest_value; };
    const auto is_direction = [](Vec3d w) { return w.z > 1e-6 && std::abs(dot(w, w) - 1) < 1e-3; };
    if (!is_direction(wl) || !is_direction(wv) || !std::ranges::all_of(f, is_value)) {
        ++samples_.masked;
        return;
    }
    if (samples_.wl.size() == max_) {
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
        case Values::polarized:
            samples_.colour.push_back({f[0], f[1], f[0]});  // both until `finish`
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

/// The numbers of the rows without `missing`, and the number of rows with it.
struct OtherRows {
    std::size_t with = 0;
    float min = 0, max = 0;
    bool is_saturated = false, has_fractions = false;

    OtherRows(std::span<const float> rows, std::size_t width, float missing) {
        for (; !rows.empty(); rows = rows.subspan(width)) {
            const auto row = rows.first(width);
            const bool has = std::ranges::find(row, missing) != row.end();
            with += has, is_saturated |= has && std::ranges::max(row) >= -missing;
            for (const float f : row)
                if (!has && !std::isnan(f)) {
                    min = std::min(min, f);
                    max = std::max(max, f);
                    has_fractions |= f != std::round(f);
                }
        }
    }
};

std::optional<float> missing_number(std::span<const float> rows, std::size_t width) {
    constexpr float fills[] = {999, 9999, 99999, 999999, 32767, 65535, 2147483648};
    float min = 0, max = 0;
    for (const float f : rows) min = std::min(min, f), max = std::max(max, f);
    if (std::ranges::find(fills, max) != std::end(fills))
        if (const OtherRows others(rows, width, max); others.with > 1 && max > 2 * others.max) return max;
    if (!(min < 0)) return {};
    const OtherRows others(rows, width, min);
    const bool is_integer = min == std::round(min);
    if (others.is_saturated || (others.with < 2 && !is_integer) || others.min < min / 10) return {};
    if (is_integer && others.has_fractions) return min;
    std::vector<float> positive;
    std::ranges::copy_if(rows, std::back_inserter(positive), [](float f) { return f > 0; });
    const auto median = positive.begin() + std::ptrdiff_t(positive.size() / 2);
    std::ranges::nth_element(positive, median);
    const bool is_missing = positive.empty() ? is_integer : -min > 2 * *median;
    return is_missing ? std::optional(min) : std::nullopt;
}

}  // namespace

void mask_missing(std::span<float> rows, std::size_t width, std::vector<std::string>* notes) {
    // A file may have several such numbers: −9999 for not measured, −999 for saturated.
    constexpr int k_max_kinds = 4;
    for (int kind = 0; kind < k_max_kinds; ++kind) {
        const auto missing = missing_number(rows, width);
        if (!missing) return;
        std::size_t masked = 0;
        for (auto rest = rows; !rest.empty(); rest = rest.subspan(width))
            if (const auto row = rest.first(width); std::ranges::find(row, *missing) != row.end())
                ++masked, std::ranges::fill(row, k_nan);
        if (notes)
            notes->push_back(
                fmt::format("{} samples of {:g}, which stands for no value, are masked", masked, *missing));
    }
}

void keep_samples(ScatteredSamples& samples, const std::function<bool(std::size_t)>& keep) {
    const std::size_t channels = samples.wavelengths.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        if (!keep(i)) continue;
        samples.wl[kept] = samples.wl[i];
        samples.wv[kept] = samples.wv[i];
        samples.colour[kept] = samples.colour[i];
        if (!samples.weight.empty()) samples.weight[kept] = samples.weight[i];
        std::copy_n(samples.spectrum.begin() + std::ptrdiff_t(i * channels), channels,
                    samples.spectrum.begin() + std::ptrdiff_t(kept * channels));
        ++kept;
    }
    samples.masked += samples.wl.size() - kept;
    samples.wl.resize(kept);
    samples.wv.resize(kept);
    samples.colour.resize(kept);
    samples.spectrum.resize(kept * channels);
    if (!samples.weight.empty()) samples.weight.resize(kept);
}

ScatteredSamples valid_samples(std::span<const Vec3f> wl, std::span<const Vec3f> wv, std::span<const Rgb> f,
                               bool isotropic) {
    const StandardArithmetic mode;
    require_equal_lengths(wl.size(), wv.size(), f.size());
    ScatteredSamples samples;
    samples.isotropic = isotropic;
    samples.wl.assign(wl.begin(), wl.end()), samples.wv.assign(wv.begin(), wv.end());
    samples.colour.assign(f.begin(), f.end());
    if (!f.empty()) mask_missing({&samples.colour[0].r, 3 * f.size()}, 3, &samples.notes);
    keep_samples(samples, [&](std::size_t i) { return is_finite(samples.colour[i]) && above_horizon(wl[i], wv[i]); });
    return samples;
}

void set_spectra(ScatteredSamples& samples, const Channels& spectra) {
    if (spectra.wavelengths.empty()) return;
    samples.wavelengths = spectra.wavelengths;
    samples.spectrum.resize(samples.wl.size() * spectra.count());
    spectra.evaluate(samples.wl, samples.wv, samples.spectrum);
}

void to_bsdf(ScatteredSamples& samples, Quantity quantity, double unit) {
    if (quantity != Quantity::factor && quantity != Quantity::cosine && unit == 1) return;
    const std::size_t channels = samples.wavelengths.size();
    const auto is_value = [](float f) { return std::abs(f) <= k_largest_value; };
    const auto row = [&](std::size_t i) { return std::span(samples.spectrum).subspan(i * channels, channels); };
    for (std::size_t i = 0; i < samples.wl.size(); ++i) {
        const double per_unit = quantity == Quantity::factor   ? k_pi
                                : quantity == Quantity::cosine ? double(samples.wv[i].z)
                                                               : 1,
                     scale = per_unit / unit;
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
    const double max = kind == AngleKind::polar ? k_pi : 4 * k_pi;
    if (!(std::abs(number * unit.radians) > max * rounding)) return {};
    return fmt::format("{} within {:.4g} {}", kind == AngleKind::polar ? "a polar angle" : "an azimuth",
                       max / unit.radians, unit.name);
}

Result<ScatteredSamples> SampleBuilder::finish(const std::string& file_name, std::string description,
                                               bool isotropic) && {
    const std::size_t n = samples_.wl.size(), width = values_ == Values::spectrum ? weights_.size() : 3;
    const std::span<float> rows = n == 0                        ? std::span<float>()
                                  : values_ == Values::spectrum ? std::span(samples_.spectrum)
                                                                : std::span(&samples_.colour[0].r, 3 * n);
    mask_missing(rows, width, &samples_.notes);
    if (!samples_.notes.empty()) keep_samples(samples_, [&](std::size_t i) { return std::isfinite(rows[i * width]); });
    if (values_ == Values::polarized)
        for (Rgb& f : samples_.colour) f.r = f.g = f.b = f.r / 2 + f.g / 2;
    if (values_ == Values::xyz)
        for (Rgb& f : samples_.colour) f = to_rgb(Xyz{double(f.r), double(f.g), double(f.b)});
    if (samples_.wl.empty())
        return input_error(file_name, "samples", "at least one that has a value and is above the horizon",
                           !samples_.notes.empty() ? samples_.notes[0]
                           : samples_.masked == 0  ? "none"
                                                   : fmt::format("{} that are not", samples_.masked));
    if (too_many_)
        return Error{file_name, {}, "samples", fmt::format("at most {} in a file of {} bytes", max_, bytes_), "more"};
    samples_.description = std::move(description);
    samples_.isotropic = isotropic || change_by_azimuth(samples_) == 0;
    return std::move(samples_);
}

Result<ScatteredSamples> build_index(Result<ScatteredSamples> samples) {
    if (samples) make_index(*samples);
    return samples;
}

bool is_text(std::span<const std::byte> bytes) {
    return std::ranges::none_of(as_text(bytes).substr(0, 4096), [](char c) {
        const auto code = static_cast<unsigned char>(c);
        return code < 0x20 && c != '\t' && c != '\n' && c != '\r';
    });
}

std::optional<std::string> plain_text(std::span<const std::byte> bytes) {
    const std::string_view raw = as_text(bytes);
    std::string text;
    if (const bool is_little = raw.starts_with("\xff\xfe"); is_little || raw.starts_with("\xfe\xff")) {
        const auto unit = [&](std::size_t i) {
            const auto byte = [&](std::size_t k) { return k < raw.size() ? std::uint32_t(std::uint8_t(raw[k])) : 0; };
            return byte(i + !is_little) | byte(i + is_little) << 8;
        };
        for (std::size_t i = 2; i < raw.size(); i += 2) {
            std::uint32_t code = unit(i);
            if (code >> 10 == 0x36 && unit(i + 2) >> 10 == 0x37)
                code = 0x10000 + ((code & 0x3ff) << 10 | (unit(i + 2) & 0x3ff)), i += 2;
            const int further = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
            text += char((further == 0 ? 0 : 0xf0 << (3 - further) & 0xff) | code >> 6 * further);
            for (int k = further; k-- > 0;) text += char(0x80 | (code >> 6 * k & 0x3f));
        }
    } else if (raw.find('\n') >= raw.size() - 1 && raw.find('\r') < raw.size() && is_text(bytes)) {
        std::ranges::replace_copy(raw, std::back_inserter(text), '\r', '\n');
    }
    return text.empty() || !is_text(as_bytes(text)) ? std::nullopt : std::optional(std::move(text));
}

}  // namespace
