// The functions of a table that its format alone knows.
#pragma once
#include <functional>
#include <optional>

#include "srbf/measured.h"

SRBF_BEGIN

/// A part of a BSDF without the light that its table keeps as a peak though it is not scattered.
struct SeparatedBeam {
    Evaluate rest;  ///< f with the peak cut off at the level about it
    Beam beam;      ///< the share that is cut off
};
/// A line of what `srbf info` says about a table: a text, or the ranges of colours, channel by channel.
struct TableLine {
    std::string name, text;
    std::span<const Rgb> colours = {};
};

/// The functions that any table has, by its format.
struct TableFunctions {
    std::function<std::vector<TableLine>()> lines;
    /// The part without its peaks of unscattered light, if it has any; null: it has none.
    std::function<std::optional<SeparatedBeam>()> separated_beam = {};
};

SRBF_END
