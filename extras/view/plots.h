// Plots of the window, drawn with Dear ImGui.
#pragma once
#include <imgui.h>

#include <vector>

#include "extras/view/lobes.h"

namespace srbf {

/// f_r cosθv of reference (dots) and fit (lines) over the view's angle in their plane, at φ from that of incidence, in a
/// half disc of the given width. Logarithmic: the centre is `k_decades` below the reference's maximum. Returns the view's
/// angle under the mouse [rad]; NaN: none.
double draw_slices(const Slice* reference, const Slice* fit, double theta_l, double phi, bool logarithmic, float width);

/// The hemisphere of view directions, rotated by `azimuth` and seen from `elevation` [rad], with the contour of each
/// lobe at half of its peak. `other`: the name of the direction at `theta_l`.
void draw_lobes(const std::vector<SeenLobe>& lobes, const char* other, double theta_l, double azimuth, double elevation,
                float width);

/// The colour of lobe k, distinguishable from the previous ones.
ImU32 lobe_colour(std::size_t k, float alpha = 1);

}  // namespace srbf
