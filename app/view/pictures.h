// The row of pictures: measured, fit and difference under one camera, with lights that can be dragged.
#pragma once
#include <imgui.h>

#include <string>

#include "app/view/panels.h"

namespace srbf {

/// The panels in their places, what is written around them, and what the mouse does to them.
class Pictures {
  public:
    explicit Pictures(Panels panels) : panels_(std::move(panels)) {}

    /// Takes the mesh that the look names, the session's reference and fit; `swapped`: the fit is another one since the last time. What cannot be
    /// drawn becomes a message.
    void take(Session& session, Look& look, bool swapped);
    void draw(Session& session, Look& look, ImVec2 at, ImVec2 size);
    /// Something moves, or may: for a quarter of a second `moves`, and pictures that take too long are drawn smaller.
    void touch() { touched_ = {}; }
    bool moves() const;
    /// Whether the pictures that were drawn last are as fine as their places.
    bool is_whole() const { return is_whole_; }

  private:
    void take_mesh(Session& session, Look& look);
    void set_material(Session& session, Panels::Which which, const Result<Material>& material);
    void draw_panels(Session& session, Look& look, float width, float height);
    void draw_picture(const Session& session, Look& look, Panels::Which which, float width, float height);
    void draw_lights(Look& look, ImVec2 corner, float width, float height, bool can_drag);
    void drag(Look& look, float height);

    Panels panels_;
    std::string mesh_;         ///< the name of the one that is drawn
    int reference_ = -1;       ///< the subject whose material is on the left
    bool is_exposed_ = false;  ///< automatic exposure has been found
    bool is_whole_ = false;
    int dragged_light_ = -1;
    std::string shown_key_;  ///< camera and lights of the last pictures
    Stopwatch touched_;      ///< since something moved
    float reduction_ = 1;    ///< of pictures that move
    std::string error_;      ///< that was told of
};

}  // namespace srbf
