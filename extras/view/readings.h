// Plots and tables of the two materials below their pictures: slices, lobes, errors.
#pragma once
#include <imgui.h>

#include <optional>
#include <vector>

#include "extras/view/lobes.h"
#include "extras/view/look.h"
#include "extras/view/session.h"

namespace srbf {

/// Plots and tables of the session's reference and fit, under light from the look's `theta_l`. A plot says its values
/// under the mouse.
class Readings {
  public:
    /// Updates what has changed; `swapped`: the fit has changed since the last call.
    void take(const Session& session, const Look& look, bool swapped);
    void draw(const Session& session, Look& look, ImVec2 at, ImVec2 size);

  private:
    void draw_slice(Look& look, float width, float height) const;
    void draw_dome(const Session& session, double theta_l, float width, float height);
    void draw_verdict(const Session& session) const;
    void draw_measures(const Session& session) const;
    void draw_lobe_table() const;

    int reference_ = -1;  ///< the subject of the slices
    double theta_l_ = -1, phi_v_ = 0;
    std::optional<Slice> slice_of_reference_, slice_of_fit_;
    std::vector<SeenLobe> lobes_;
    double dome_azimuth_ = 0, dome_elevation_ = 50 * k_degree;  ///< viewpoint of the lobes
};

}  // namespace srbf
