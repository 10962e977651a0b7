// The left column: files, options of the fit, and display options.
#pragma once
#include <imgui.h>

#include <optional>
#include <string>

#include "extras/view/look.h"
#include "extras/view/session.h"

namespace srbf {

/// Holds only text that is being typed and the slider that is held; everything else changes session and look
/// immediately.
class Controls {
  public:
    void draw(Session& session, Look& look, ImVec2 at, ImVec2 size);
    /// Writes the displayed fit under the typed name; a message reports the result.
    void save(Session& session) const;

  private:
    void draw_fit(Session& session);
    void draw_save(const Session& session, Look& look);
    void draw_picture(Look& look);

    std::string typed_mesh_, typed_model_, typed_environment_;
    std::optional<FitChoice> sliding_;  ///< while a slider is held
};

}  // namespace srbf
