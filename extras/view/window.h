// The window of a session: its parts and its main loop.
#pragma once
#include <string>

#include "extras/view/display_state.h"
#include "extras/view/session.h"

namespace SRBF_NAMESPACE {

struct WindowOptions {
    int width = 1280, height = 800;
    std::string screenshot;  ///< written once everything is complete; then the window closes
    int timed_refits = 0;    ///< number of fits while the picture rotates (`Refits`); then the window closes
};

/// Shows the session until the window is closed. Errors: no display, no OpenGL; a screenshot that cannot be written.
Result<Done> run_window(Session& session, DisplayState& display, const WindowOptions& options);

}  // namespace srbf
