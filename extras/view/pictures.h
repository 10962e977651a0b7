// The row of pictures: measurement, fit and difference with one camera, and lights that can be dragged.
#pragma once
#include <imgui.h>

#include <string>

#include "extras/view/panels.h"

namespace SRBF_NAMESPACE {

/// The panels with their captions and mouse interaction.
class Pictures {
  public:
    explicit Pictures(Panels panels) : panels_(std::move(panels)) {}

    /// Updates the mesh from the display state, and the materials from the session's reference and fit.
    /// `is_new_fit`: the fit has changed since the last call. Materials that cannot be drawn become messages.
    void take(Session& session, DisplayState& display, bool is_new_fit);
    void draw(Session& session, DisplayState& display, ImVec2 corner, ImVec2 size);
    /// Records an interaction. For a quarter of a second `moves()` is true, and slow pictures are drawn smaller.
    void touch() { touched_ = {}; }
    bool moves() const;
    /// True if the last pictures had the full resolution.
    bool is_whole() const { return is_whole_; }
    /// The number of samples of the pictures under an environment, which rises while nothing moves.
    int samples() const { return panels_.samples(); }

  private:
    void take_mesh(Session& session, DisplayState& display);
    void take_environment(Session& session, DisplayState& display);
    void set_material(Session& session, Panels::Which which, const Result<Material>& material,
                      std::function<Proposals()> propose);
    void draw_panels(Session& session, DisplayState& display, float width, float height);
    void draw_picture(const Session& session, DisplayState& display, Panels::Which which, float width, float height);
    void draw_wipe(const Session& session, DisplayState& display, float width, float height);
    std::string caption(const Session& session, const DisplayState& display, Panels::Which which) const;
    void draw_reading(ImVec2 corner, float width, float height) const;
    void draw_lights(DisplayState& display, ImVec2 corner, float width, float height, bool can_drag);
    void drag(DisplayState& display, float height);

    Panels panels_;
    std::string mesh_;                  ///< name of the current mesh
    std::string environment_ = "none";  ///< name of the current environment
    bool drags_divider_ = false;
    int reference_ = -1;       ///< the subject whose material is on the left
    bool is_exposed_ = false;  ///< true once the automatic exposure is computed
    bool is_whole_ = false;
    int dragged_light_ = -1;
    std::string shown_key_;  ///< camera and lights of the last pictures
    Stopwatch touched_;      ///< since the last interaction
    float reduction_ = 1;    ///< scale of pictures during interaction
    std::string error_;      ///< the last error that was reported
};

}  // namespace srbf
