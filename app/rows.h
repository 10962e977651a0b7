// Rows of text that describe a file.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "app/output.h"

namespace srbf {

/// What a file says, in one line.
std::string one_line(std::string text);

void add_row(std::string& text, std::string_view name, const std::string& what);

struct Range {
    float least = std::numeric_limits<float>::infinity(), most = -least;
    void add(float x) {
        if (std::isnan(x)) return;
        least = std::min(least, x);
        most = std::max(most, x);
    }
    std::string text() const { return least > most ? "none" : fmt::format("{:.4g} to {:.4g}", least, most); }
};

/// Whether no pixel has a colour, as where there is one wavelength; NaN is a masked one. Such values are shown as one channel.
template <typename Pixels> bool is_grey(const Pixels& pixels) {
    return std::ranges::all_of(pixels,
                               [](const Rgb& f) { return !(f.r < f.g || f.r > f.g || f.g < f.b || f.g > f.b); });
}
/// NAME R, G or B, or NAME alone.
inline std::string channel_name(std::string_view name, int channel, bool grey) {
    return grey ? std::string(name) : std::string(name) + " " + "RGB"[channel];
}
template <typename Pixels> void add_channel_ranges(std::string& text, std::string_view name, const Pixels& pixels) {
    const bool grey = is_grey(pixels);
    for (int c = 0; c < (grey ? 1 : 3); ++c) {
        Range range;
        std::uint64_t negative = 0;
        for (const Rgb& f : pixels) range.add(f[c]), negative += f[c] < 0;
        add_row(text, channel_name(name, c, grey),
                range.text() + (negative ? ", " + grouped(negative) + " negative" : ""));
    }
}

std::string wavelengths_text(const std::vector<float>& nm);
/// The light that is not scattered.
void add_beams(std::string& text, const Beams& beams);

}  // namespace srbf
