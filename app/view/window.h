// The window around a session: its parts in their places, frame by frame.
#pragma once
#include <string>

#include "app/view/look.h"
#include "app/view/session.h"

namespace srbf {

struct WindowOptions {
    int width = 1280, height = 800;
    std::string screenshot;  ///< written when there is nothing left to wait for; then the window closes
    int timed_refits = 0;    ///< asks for so many fits while the picture turns (`Refits`); then the window closes
};

/// Shows the session until the window is closed. Errors: no display, no OpenGL; a screenshot that cannot be written.
Result<Done> run_window(Session& session, Look& look, const WindowOptions& options);

}  // namespace srbf
