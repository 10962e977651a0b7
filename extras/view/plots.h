// Plots of the window, drawn with Dear ImGui.
#pragma once
#include <imgui.h>

#include <vector>

#include "extras/view/lobes.h"

namespace SRBF_NAMESPACE {

/// Plots f_r cosθv of the reference (dots) and the fit (lines) over the view angle, in a plane at φ from the plane
/// of incidence, as a half disc of the given width. Logarithmic: the centre is `k_decades` below the reference's
/// maximum. Returns the view angle under the mouse [rad]; NaN: the mouse is elsewhere.
double draw_slices(const Slice* reference, const Slice* fit, double theta_l, double phi, bool logarithmic, float width);

/// Plots the hemisphere of view directions, rotated by `azimuth` and seen from `elevation` [rad], with the contour
/// of each lobe at half of its peak. `other_name` labels the direction at `theta_l`.
void draw_lobes(const std::vector<LobeSlice>& lobes, const char* other_name, double theta_l, double azimuth,
                double elevation, float width);

/// The colour of lobe k, distinct from the previous ones.
ImU32 lobe_colour(std::size_t k, float alpha = 1);

}  // namespace srbf
