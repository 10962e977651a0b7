// Font, colours and lines of the window's text.
#pragma once
#include <imgui.h>

#include <string>

#include "srbf/vec.h"

namespace SRBF_NAMESPACE {

inline const ImVec4 k_white{1, 1, 1, 1}, k_red{1, 0.45f, 0.4f, 1}, k_dim{0.65f, 0.65f, 0.65f, 1},
    k_hint{1, 0.86f, 0.35f, 1};

/// A colour, already encoded for display, in Dear ImGui's format.
inline ImU32 colour_of(Rgb c) { return ImColor(c.r, c.g, c.b); }

/// Loads a proportional system font with Latin and Greek, or else Dear ImGui's own font.
void load_font(float scale);

/// The text, or its beginning and "..." if it is wider than `width` [pixels].
std::string shortened(std::string text, float width);

/// Writes a text in as many lines as it needs.
void write_wrapped(const ImVec4& colour, const std::string& text);

}  // namespace srbf
