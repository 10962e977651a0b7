#include <memory>

#include "app/commands.h"
#include "app/extra_subcommands.h"
#include "app/memory.h"
#include "app/output.h"
#include "base/printable.h"
#include "extras/view/window.h"

namespace SRBF_NAMESPACE {
namespace {

struct ViewCommand {
    std::vector<std::string> files;
    std::string mesh = "ball", environment = "none";
    bool wipe = false;
    WindowOptions window;

    int run() const;
};

#ifdef SRBF_WINDOW
int ViewCommand::run() const {
    if (const auto writable = check_outputs(files, {window.screenshot}); !writable) return complain(writable.error());
    if (const auto can_draw = check_drawing(); !can_draw) return complain(can_draw.error());
    Session session;
    for (const std::string& file : files) session.open(file);
    for (const Session::Message& message : session.messages())
        if (message.is_error) fmt::print(stderr, "srbf: {}\n", printable(message.text));
    if (!files.empty() && session.subjects().empty()) return k_input_error;
    DisplayState display;
    display.mesh = mesh, display.environment = environment, display.wipe = wipe;
    const auto result = run_window(session, display, window);
    return result ? int(k_done) : complain(result.error());
}
#else
int ViewCommand::run() const {
    return complain({"srbf view", {}, "this program", "one built with libepoxy, GLFW and Dear ImGui", "one without"});
}
#endif

}  // namespace

void add_view(CommandLine& app, int& status) {
    auto command = std::make_shared<ViewCommand>();
    const Subcommand sub =
        app.add_subcommand("view", "Look at a measurement, its fit and their difference in a window");
    sub.add_option("files", command->files,
                   "Measurements and models. The first measurement is the reference; it is compared with the first "
                   "model, or fitted")
        .type_name("FILE");
    sub.add_option("--mesh", command->mesh, "A .ply or .obj file, or sphere, knot or ball")
        .type_name("FILE")
        .capture_default_str();
    sub.add_option("--env", command->environment, "Environment map, a .hdr or .exr file, or studio or none")
        .type_name("FILE")
        .capture_default_str();
    sub.add_flag("--wipe", command->wipe, "Start with one picture, divided between measured and fit");
    const Option screenshot = sub.add_option("--screenshot", command->window.screenshot,
                                             "Save a picture of the window once fit and errors are complete, and quit")
                                  .type_name("FILE.png")
                                  .check(png_name());
    sub.add_option("--time-refits", command->window.timed_refits,
                   "Run this many fits while the picture rotates, print the time of each and the frame rate, and quit")
        .type_name("COUNT")
        .check(within(1, 1000));
    sub.footer(
        "Press H in the window for its keys. Files can be dropped on it.\n"
        "Example:\n  srbf view paper_white_rgb.bsdf paper_white_rgb.srbf");
    sub.callback([command, &status] { status = command->run(); },
                 {{{screenshot}, "not with --time-refits", [command] { return command->window.timed_refits == 0; }}});
}

}  // namespace srbf
