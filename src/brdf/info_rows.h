// Rows of text that describe a file or a model.
#pragma once
#include <fmt/format.h>

#include <iterator>

#include "base/printable.h"
#include "brdf/directions.h"
#include "brdf/parts.h"
#include "srbf/brdf.h"

namespace SRBF_NAMESPACE {

inline void add_row(std::string& text, std::string_view name, const std::string& what) {
    fmt::format_to(std::back_inserter(text), "  {:<18}{}\n", printable(name), printable(what));
}

/// The names of the channels to show: NAME R, G and B, or NAME alone if all pixels are grey. NaN is a masked pixel.
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

inline std::string wavelengths_text(const std::vector<float>& nm) {
    return fmt::format("{}, {:g} to {:g} nm", nm.size(), nm.front(), nm.back());
}

/// Adds a row for each beam, the light that is not scattered.
inline void add_beams(std::string& text, const Beams& beams) {
    for (std::size_t b = 0; b < beams.size(); ++b) {
        if (beams[b].empty()) continue;
        std::string row;
        for (std::size_t ring = 0, first = 0; ring < beams[b].theta.size(); ++ring) {
            const auto nodes = std::span(beams[b].fraction).subspan(first, std::size_t(beams[b].nodes(ring)));
            const auto [min, max] = std::ranges::minmax(nodes, {}, &Rgb::g);
            row += fmt::format("{}{:.4g}{} at {:.3g}°", ring ? ", " : "", min.g,
                               nodes.size() > 1 ? fmt::format(" to {:.4g}", max.g) : "",
                               double(beams[b].theta[ring]) / k_degree);
            first += nodes.size();
        }
        add_row(text, "beam", fmt::format("{}: {}", k_beam_names[b], row));
    }
}

}  // namespace
