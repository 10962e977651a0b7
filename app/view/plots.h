// Plots of the window, drawn by Dear ImGui's lines.
#pragma once
#include <imgui.h>

#include <vector>

#include "app/view/lobes.h"

namespace srbf {

/// f_r cosθv of reference (dots) and fit (lines) over the view's angle in the plane of incidence, a half disc of the given width.
/// Logarithmic: `k_decades` below the reference's largest value lie at the centre.
void draw_slices(const Slice* reference, const Slice* fit, double theta_l, bool logarithmic, float width);

/// The hemisphere of view directions, turned by `azimuth` and seen from `elevation` [rad], and on it where each lobe is at least half as large as
/// at its peak. `other`: what the direction at `theta_l` is called.
void draw_lobes(const std::vector<SeenLobe>& lobes, const char* other, double theta_l, double azimuth, double elevation,
                float width);

/// The colour that stands for lobe k, told apart from those before it.
ImU32 lobe_colour(std::size_t k, float alpha = 1);

}  // namespace srbf
