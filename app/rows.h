// Rows of text that describe a file.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "app/output.h"
#include "srbf/printable.h"

namespace srbf {

void add_row(std::string& text, std::string_view name, const std::string& what);

/// The names of the channels to show: NAME R, G and B, or NAME alone where no pixel has a colour, as where there is one
/// wavelength. NaN is a masked pixel.
template <typename Pixels> std::vector<std::string> channel_names(const std::string& name, const Pixels& pixels) {
    const bool grey =
        std::ranges::all_of(pixels, [](const Rgb& f) { return !(f.r < f.g || f.r > f.g || f.g < f.b || f.g > f.b); });
    if (grey) return {name};
    return {name + " R", name + " G", name + " B"};
}
template <typename Pixels> void add_channel_ranges(std::string& text, std::string_view name, const Pixels& pixels) {
    const std::vector<std::string> names = channel_names(std::string(name), pixels);
    for (int c = 0; c < int(names.size()); ++c) {
        ValueRange range;
        std::uint64_t negative = 0;
        for (const Rgb& f : pixels) range.add(f[c]), negative += f[c] < 0;
        add_row(text, names[std::size_t(c)], range.text() + (negative ? ", " + grouped(negative) + " negative" : ""));
    }
}

std::string wavelengths_text(const std::vector<float>& nm);
/// The light that is not scattered.
void add_beams(std::string& text, const Beams& beams);

}  // namespace srbf
