#include "extras/view/window.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include "extras/view/controls.h"
#include "extras/view/ink.h"
#include "extras/view/opening.h"
#include "extras/view/pictures.h"
#include "extras/view/readings.h"
#include "extras/view/recent.h"
#include "extras/view/screen.h"
#include "extras/view/timing.h"

namespace SRBF_NAMESPACE {
namespace {

constexpr float k_controls = 262, k_messages = 58;  // pixels of a monitor of scale 1
/// While a fit runs, the picture leaves the processor to it: seconds per frame.
constexpr double k_frame_beside_fit = 0.05;
/// Samples of a picture under an environment before a screenshot.
constexpr int k_clean = 64;
/// Interval of updates without input [s].
constexpr double k_idle = 0.1;

/// Opens a file that was dropped on the window or typed. A mesh or environment becomes current, a measurement
/// becomes the reference, and a model the displayed fit.
void drop(const std::string& path, Session& session, DisplayState& display) {
    const auto ending = std::filesystem::path(path).extension();
    if (ending == ".ply" || ending == ".obj") return void(display.mesh = path);
    if (ending == ".hdr" || ending == ".exr") return void(display.environment = path);
    if (!session.open(path)) return;
    keep_recent(path);
    const int added = int(session.subjects().size()) - 1;
    if (!session.subjects().back()->is_model())
        session.set_reference(added);
    else if (session.reference() != added)
        session.show_model(added);
}

/// Opens the most recent file that is not open.
void open_recent(Session& session, DisplayState& display) {
    for (const std::string& path : recent_files()) {
        const auto is_open = [&](const auto& subject) {
            return std::filesystem::absolute(subject->path).string() == path;
        };
        if (std::ranges::none_of(session.subjects(), is_open)) return drop(path, session, display);
    }
    session.say("No recent file is left to open.");
}

void draw_messages(const Session& session, ImVec2 corner, ImVec2 size) {
    ImGui::SetNextWindowPos(corner), ImGui::SetNextWindowSize(size);
    ImGui::Begin("messages", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove);
    const auto& messages = session.messages();
    if (messages.empty()) ImGui::TextColored(k_dim, "Press H for the keys. Files may be dropped on this window.");
    for (auto message = messages.rbegin(); message != messages.rend(); ++message)
        write_wrapped(message->is_error ? k_red : k_white, message->text);
    ImGui::End();
}

void draw_help(DisplayState& display) {
    if (!display.help) return;
    ImGui::SetNextWindowFocus();
    ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x / 2, ImGui::GetIO().DisplaySize.y / 2}, 0, {0.5f, 0.5f});
    ImGui::Begin("Keys", &display.help, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse);
    if (ImGui::BeginTable("keys", 4, ImGuiTableFlags_SizingFixedFit)) {
        // Keys without a text continue the previous line.
        std::vector<std::pair<std::string, std::string>> lines;
        for (const Key& key : keys())
            if (key.what.empty())
                lines.back().first += ", " + std::string(key.name);
            else
                lines.emplace_back(key.name, key.what);
        const std::size_t half = (lines.size() + 1) / 2;
        for (std::size_t i = 0; i < half; ++i)
            for (const std::size_t k : {i, i + half}) {
                ImGui::TableNextColumn(),
                    ImGui::TextColored(k_hint, "%s", k < lines.size() ? lines[k].first.c_str() : "");
                ImGui::TableNextColumn(), ImGui::Text("%s   ", k < lines.size() ? lines[k].second.c_str() : "");
            }
        ImGui::EndTable();
    }
    ImGui::Text(
        "Mouse: drag a picture to orbit, a yellow dot to move that light, with the right button the chosen light, with "
        "Ctrl the environment; wheel: zoom.");
    ImGui::End();
}

/// Draws the field for a file name, and the recent files that match it. Returns the file once Enter or a click has
/// chosen it.
std::optional<std::string> draw_opening(std::optional<Opening>& opening, bool is_new, float scale) {
    if (!opening) return {};
    std::optional<std::string> file;
    ImGui::SetNextWindowFocus();
    ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x / 2, ImGui::GetIO().DisplaySize.y / 2}, 0, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({640 * scale, 0});
    bool is_open = true;
    ImGui::Begin("Open a file", &is_open, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoResize);
    if (is_new) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(-1);
    if (ImGui::InputTextWithHint("##file", "a measurement, model, mesh or environment", &opening->typed))
        opening->chosen = -1;
    if (opening->is_confirmed) file = file_of(*opening);
    const std::vector<std::string> paths = matches(*opening);
    for (int i = 0; i < int(paths.size()); ++i)
        if (ImGui::Selectable(paths[std::size_t(i)].c_str(), i == opening->chosen)) file = paths[std::size_t(i)];
    ImGui::TextColored(k_hint, "Enter: open. Up, Down: choose a recent file. Escape: close.");
    ImGui::End();
    if (file || !is_open || opening->is_cancelled) opening.reset();
    return file;
}

/// Saves the screen as the first of srbf-1.png, srbf-2.png, .. that does not exist.
void write_screenshot(const Screen& screen, Session& session) {
    std::string name;
    for (int i = 1; name.empty() || std::filesystem::exists(name); ++i) name = fmt::format("srbf-{}.png", i);
    const auto written = write_png(screen.read(), name);
    written ? session.say("Wrote " + name + ".") : session.complain(written.error());
}

/// The parts of the window.
struct WindowParts {
    Controls controls;
    Pictures pictures;
    Readings readings;
    std::optional<Opening> opening;
};

/// Draws all parts, and does what their buttons ask for.
void draw_parts(WindowParts& parts, Session& session, DisplayState& display, float scale) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float left = k_controls * scale, message_height = k_messages * scale, right = size.x - left;
    // A wiped picture takes all of the height.
    const float picture_height = display.wipe ? size.y - message_height : std::floor((size.y - message_height) * 0.55f);
    parts.controls.draw(session, display, {0, 0}, {left, size.y});
    parts.pictures.draw(session, display, {left, 0}, {right, picture_height});
    if (!display.wipe)
        parts.readings.draw(session, display, {left, picture_height},
                            {right, size.y - message_height - picture_height});
    draw_messages(session, {left, size.y - message_height}, {right, message_height});
    draw_help(display);
    if (display.open_recent) open_recent(session, display), display.open_recent = false;
    const bool is_new = display.open_file;
    if (display.open_file) parts.opening.emplace().recent = recent_files(), display.open_file = false;
    if (const auto file = draw_opening(parts.opening, is_new, scale); file && !file->empty())
        drop(*file, session, display);
    if (display.save) parts.controls.save(session), display.save = false;
}

}  // namespace

Result<Done> run_window(Session& session, DisplayState& display, const WindowOptions& options) {
    Screen screen;
    const bool fills = options.screenshot.empty() && options.timed_refits == 0;
    if (const auto opened = screen.open(options.width, options.height, fills); !opened) return opened.error();
    screen.set_paced(options.timed_refits == 0);
    auto panels = Panels::make(Dialect::gl_450);
    if (!panels) return panels.error();
    WindowParts parts{{}, Pictures(*std::move(panels)), {}, {}};
    Pictures& pictures = parts.pictures;
    Refits refits(options.timed_refits);
    screen.on_key = [&](const std::string& name) {
        if (parts.opening) return press(name, *parts.opening);
        if (!ImGui::GetIO().WantTextInput) press(name, display, session), pictures.touch();
    };
    for (const auto& subject : session.subjects()) keep_recent(subject->path);
    screen.on_drop = [&](const std::string& path) { drop(path, session, display); };

    int settled = 0;
    while (!screen.is_closing() && !display.quit) {
        const Stopwatch frame;
        const bool is_busy = session.stage() != Stage::idle;
        const bool moves = pictures.moves() || options.timed_refits > 0 || !options.screenshot.empty() ||
                           pictures.samples() < Panels::k_converged;
        screen.wait(is_busy || moves ? 0 : k_idle);
        const bool is_new_fit = session.poll();
        if (options.timed_refits > 0) refits.step(session, display);
        pictures.take(session, display, is_new_fit);
        parts.readings.take(session, display, is_new_fit);

        screen.begin_frame();
        draw_parts(parts, session, display, screen.scale());
        screen.end_frame();

        // Waits a few frames after everything is displayed, until the layout is final.
        const bool is_clean = pictures.is_whole() && pictures.samples() >= k_clean;
        settled = session.stage() == Stage::idle && is_clean ? settled + 1 : 0;
        if (!options.screenshot.empty() && settled == 5) return write_png(screen.read(), options.screenshot);
        if (display.screenshot && pictures.is_whole()) write_screenshot(screen, session), display.screenshot = false;
        screen.show();
        if (const double remaining = k_frame_beside_fit - frame.seconds(); is_busy && remaining > 0)
            screen.wait(remaining);
    }
    return Done{};
}

}  // namespace srbf
