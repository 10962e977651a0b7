// The column on the left: the files, what is asked of the fit, and how it is looked at.
#pragma once
#include <imgui.h>

#include <optional>
#include <string>

#include "app/view/look.h"
#include "app/view/session.h"

namespace srbf {

/// What has been typed and what is held stays here; all else goes to session and look at once.
class Controls {
  public:
    void draw(Session& session, Look& look, ImVec2 at, ImVec2 size);
    /// Writes the fit on display by the name that is typed; a message tells how it went.
    void save(Session& session) const;

  private:
    void draw_fit(Session& session);
    void draw_save(const Session& session, Look& look);
    void draw_picture(Look& look);

    std::string typed_mesh_, typed_model_;
    std::optional<FitChoice> sliding_;  ///< while a slider is held
};

}  // namespace srbf
