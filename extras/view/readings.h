// Plots and tables of the two materials below their pictures: slices, lobes, errors.
#pragma once
#include <imgui.h>

#include <optional>
#include <vector>

#include "extras/view/display_state.h"
#include "extras/view/lobes.h"
#include "extras/view/session.h"

namespace SRBF_NAMESPACE {

/// Plots and tables of the session's reference and fit, under light at the display state's `theta_l`. A plot shows
/// its values under the mouse.
class Readings {
  public:
    /// Updates what has changed. `is_new_fit`: the fit has changed since the last call.
    void take(const Session& session, const DisplayState& display, bool is_new_fit);
    void draw(const Session& session, DisplayState& display, ImVec2 corner, ImVec2 size);

  private:
    void draw_slice(DisplayState& display, float width, float height) const;
    void draw_dome(const Session& session, double theta_l, float width, float height);
    void draw_verdict(const Session& session) const;
    void draw_measures(const Session& session) const;
    void draw_lobe_table() const;

    int reference_ = -1;  ///< the subject of the slices
    double theta_l_ = -1, phi_v_ = 0;
    std::optional<Slice> slice_of_reference_, slice_of_fit_;
    std::vector<LobeSlice> lobes_;
    double dome_azimuth_ = 0, dome_elevation_ = 50 * k_degree;  ///< viewpoint of the lobes
};

}  // namespace srbf
