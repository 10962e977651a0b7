// The left column: files, options of the fit, and display options.
#pragma once
#include <imgui.h>

#include <optional>
#include <string>

#include "extras/view/display_state.h"
#include "extras/view/session.h"

namespace SRBF_NAMESPACE {

/// Stores only text that is being typed and the choice of a slider that is held. Everything else changes the
/// session and the display state immediately.
class Controls {
  public:
    void draw(Session& session, DisplayState& display, ImVec2 at, ImVec2 size);
    /// Writes the displayed fit under the typed name; a message reports the result.
    void save(Session& session) const;

  private:
    void draw_fit(Session& session);
    void draw_edit(Session& session);
    void draw_save(const Session& session, DisplayState& display);
    void draw_picture(DisplayState& display);

    std::string typed_mesh_, typed_model_, typed_environment_;
    std::optional<FitChoice> sliding_;  ///< while a slider is held
    std::optional<EditChoice> edit_sliding_;
};

}  // namespace srbf
