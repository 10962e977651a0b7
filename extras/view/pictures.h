// The row of pictures: measurement, fit and difference with one camera, and lights that can be dragged.
#pragma once
#include <imgui.h>

#include <string>

#include "extras/view/panels.h"

namespace srbf {

/// The panels with their captions and mouse interaction.
class Pictures {
  public:
    explicit Pictures(Panels panels) : panels_(std::move(panels)) {}

    /// Updates the mesh from the look, and the materials from the session's reference and fit; `swapped`: the fit has
    /// changed since the last call. What cannot be drawn becomes a message.
    void take(Session& session, Look& look, bool swapped);
    void draw(Session& session, Look& look, ImVec2 at, ImVec2 size);
    /// Notes an interaction: for a quarter of a second `moves`, and slow pictures are drawn smaller.
    void touch() { touched_ = {}; }
    bool moves() const;
    /// True if the last pictures have the full resolution.
    bool is_whole() const { return is_whole_; }
    /// The samples of the pictures under an environment, which increase while nothing moves.
    int samples() const { return panels_.samples(); }

  private:
    void take_mesh(Session& session, Look& look);
    void take_environment(Session& session, Look& look);
    void set_material(Session& session, Panels::Which which, const Result<Material>& material,
                      std::function<Proposals()> propose);
    void draw_panels(Session& session, Look& look, float width, float height);
    void draw_picture(const Session& session, Look& look, Panels::Which which, float width, float height);
    void draw_wipe(const Session& session, Look& look, float width, float height);
    std::string caption(const Session& session, const Look& look, Panels::Which which) const;
    void draw_reading(ImVec2 corner, float width, float height) const;
    void draw_lights(Look& look, ImVec2 corner, float width, float height, bool can_drag);
    void drag(Look& look, float height);

    Panels panels_;
    std::string mesh_;                  ///< name of the current mesh
    std::string environment_ = "none";  ///< name of the current environment
    bool drags_divider_ = false;
    int reference_ = -1;       ///< the subject whose material is on the left
    bool is_exposed_ = false;  ///< whether automatic exposure has been computed
    bool is_whole_ = false;
    int dragged_light_ = -1;
    std::string shown_key_;  ///< camera and lights of the last pictures
    Stopwatch touched_;      ///< since the last interaction
    float reduction_ = 1;    ///< of pictures during interaction
    std::string error_;      ///< that was reported
};

}  // namespace srbf
