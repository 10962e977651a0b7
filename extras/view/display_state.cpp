#include "extras/view/display_state.h"

#include <algorithm>
#include <cmath>

#include "brdf/frame.h"
#include "extras/render/environment.h"
#include "observe/objectives.h"

namespace SRBF_NAMESPACE {

namespace {

Vec3d towards_eye(const DisplayState& display) {
    const double c = std::cos(display.elevation);
    return {c * std::sin(display.azimuth), std::sin(display.elevation), c * std::cos(display.azimuth)};
}

/// Rotates w about the unit vector `axis` by `angle` (Rodrigues' formula).
Vec3d rotate(Vec3d w, Vec3d axis, double angle) {
    return std::cos(angle) * w + std::sin(angle) * cross(axis, w) + (1 - std::cos(angle)) * dot(axis, w) * axis;
}

}  // namespace

DisplayState::DisplayState() { lights = lights_of(camera_of(*this, {{-1, -1, -1}, {1, 1, 1}})); }

Camera camera_of(const DisplayState& display, const Bounds& bounds) {
    const Vec3d lower = to_double(bounds.least), upper = to_double(bounds.most);
    Camera camera;
    camera.target = 0.5 * (lower + upper);
    // The sphere around the bounding box fits into the picture.
    const Vec3d diagonal = upper - lower;
    const double radius = std::max(0.5 * std::sqrt(dot(diagonal, diagonal)), 1e-6);
    camera.eye = camera.target + 0.75 * radius / (std::sin(camera.fov / 2) * display.zoom) * towards_eye(display);
    return camera;
}

void orbit(DisplayState& display, double right, double up) {
    display.azimuth = std::remainder(display.azimuth + right, 2 * k_pi);
    display.elevation = std::clamp(display.elevation + up, -89 * k_degree, 89 * k_degree);
}

void turn_light(DisplayState& display, int light, double right, double up) {
    const Frame axes = frame(camera_of(display, {{-1, -1, -1}, {1, 1, 1}}));
    Vec3d& towards = display.lights[std::size_t(light)].towards;
    towards = normalize(rotate(rotate(towards, axes.y, right), axes.x, -up));
}

void put_behind(DisplayState& display, int light) {
    display.lights[std::size_t(light)].towards = light_behind(camera_of(display, {{-1, -1, -1}, {1, 1, 1}})).towards;
}

void turn_environment(DisplayState& display, double right) {
    display.turned = std::remainder(display.turned + right, 2 * k_pi);
}

void zoom(DisplayState& display, double factor) { display.zoom = std::clamp(display.zoom * factor, 0.2, 20.0); }

void next_mesh(DisplayState& display) {
    const auto mesh = std::find(k_built_in_meshes.begin(), k_built_in_meshes.end(), display.mesh);
    display.mesh =
        mesh == k_built_in_meshes.end() || mesh + 1 == k_built_in_meshes.end() ? k_built_in_meshes[0] : *(mesh + 1);
}

namespace {

constexpr double k_turn = 5 * k_degree, k_zoom_step = 1.1;

void expose(DisplayState& display, float stops) {
    display.exposure *= std::exp2(stops);
    display.automatic = false;
}
void rescale(DisplayState& display, float factor) {
    display.full_scale = std::clamp(display.full_scale * factor, k_least_scale, k_most_scale);
}
void brighten(DisplayState& display, float factor) {
    Rgb& irradiance = display.lights[std::size_t(display.light)].irradiance;
    for (int c = 0; c < 3; ++c) irradiance[c] = std::clamp(irradiance[c] * factor, 0.01f, 100.f);
}
void add_bookmark(DisplayState& display) {
    display.bookmarks.push_back({display.azimuth, display.elevation, display.zoom, display.turned, display.lights});
    display.bookmark = 0;
}
void next_bookmark(DisplayState& display) {
    if (display.bookmarks.empty()) return;
    const Bookmark& bookmark = display.bookmarks[display.bookmark++ % display.bookmarks.size()];
    display.azimuth = bookmark.azimuth, display.elevation = bookmark.elevation, display.zoom = bookmark.zoom,
    display.turned = bookmark.turned;
    display.lights = bookmark.lights;
}
template <typename Change> void choose(Session& session, const Change& change) {
    FitChoice choice = session.choice();
    change(choice);
    session.choose(choice);
}
/// The next of `count` enumerators, cyclically.
template <typename E> E next_enumerator(E e, int count) { return E((int(e) + 1) % count); }

void next_reference(Session& session) {
    const int count = int(session.subjects().size());
    if (count > 0) session.set_reference((session.reference() + 1) % count);
}
void next_model(Session& session) {
    // Proceeds from the displayed model through the models among the files, then back to fitting.
    const auto& subjects = session.subjects();
    std::size_t index = 0;
    if (session.fitted() && !session.fitted()->from.empty())
        while (index < subjects.size() && subjects[index++]->path != session.fitted()->from) {
        }
    while (index < subjects.size() && (!subjects[index]->is_model() || int(index) == session.reference())) ++index;
    index < subjects.size() ? session.show_model(int(index)) : session.refit();
}

constexpr Key k_keys[] = {
    {"Left", "orbit", [](DisplayState& display, Session&) { orbit(display, -k_turn, 0); }},
    {"Right", "", [](DisplayState& display, Session&) { orbit(display, k_turn, 0); }},
    {"Up", "", [](DisplayState& display, Session&) { orbit(display, 0, k_turn); }},
    {"Down", "", [](DisplayState& display, Session&) { orbit(display, 0, -k_turn); }},
    {"PageUp", "nearer", [](DisplayState& display, Session&) { zoom(display, k_zoom_step); }},
    {"PageDown", "further away", [](DisplayState& display, Session&) { zoom(display, 1 / k_zoom_step); }},
    {"1", "choose light 1, 2, 3", [](DisplayState& display, Session&) { display.light = 0; }},
    {"2", "", [](DisplayState& display, Session&) { display.light = 1; }},
    {"3", "", [](DisplayState& display, Session&) { display.light = 2; }},
    {"Shift+Left", "turn the chosen light",
     [](DisplayState& display, Session&) { turn_light(display, display.light, -k_turn, 0); }},
    {"Shift+Right", "", [](DisplayState& display, Session&) { turn_light(display, display.light, k_turn, 0); }},
    {"Shift+Up", "", [](DisplayState& display, Session&) { turn_light(display, display.light, 0, k_turn); }},
    {"Shift+Down", "", [](DisplayState& display, Session&) { turn_light(display, display.light, 0, -k_turn); }},
    {"I", "the chosen light behind the object",
     [](DisplayState& display, Session&) { put_behind(display, display.light); }},
    {"Shift+PageUp", "brighten the chosen light", [](DisplayState& display, Session&) { brighten(display, 1.25f); }},
    {"Shift+PageDown", "dim it", [](DisplayState& display, Session&) { brighten(display, 0.8f); }},
    {"V", "environment: studio, none",
     [](DisplayState& display, Session&) {
         display.environment = display.has_environment() ? "none" : std::string(k_built_in_environment);
     }},
    {"Shift+V", "type the name of an environment file",
     [](DisplayState& display, Session&) { display.name_environment = true; }},
    {"X", "turn the environment", [](DisplayState& display, Session&) { turn_environment(display, k_turn); }},
    {"Shift+X", "", [](DisplayState& display, Session&) { turn_environment(display, -k_turn); }},
    {"C", "the three lights beside the environment",
     [](DisplayState& display, Session&) { display.lamps = !display.lamps; }},
    {"W", "wipe: measured and fit in one picture",
     [](DisplayState& display, Session&) { display.wipe = !display.wipe; }},
    {"U", "flip: measured or fit alone",
     [](DisplayState& display, Session&) {
         display.divider = display.wipe && display.divider > 0.5f ? 0.f : 1.f, display.wipe = true;
     }},
    {"Z", "move the divider",
     [](DisplayState& display, Session&) { display.divider = std::max(display.divider - 0.02f, 0.f); }},
    {"Shift+Z", "", [](DisplayState& display, Session&) { display.divider = std::min(display.divider + 0.02f, 1.f); }},
    {"B", "keep view and lights as a bookmark", [](DisplayState& display, Session&) { add_bookmark(display); }},
    {"Shift+B", "next bookmark", [](DisplayState& display, Session&) { next_bookmark(display); }},
    {"Y", "open the next recent file", [](DisplayState& display, Session&) { display.open_recent = true; }},
    {"Shift+Y", "type or choose a file to open", [](DisplayState& display, Session&) { display.open_file = true; }},
    {"G", "difference of luminance or ΔE",
     [](DisplayState& display, Session&) { display.in_delta_e = !display.in_delta_e; }},
    {"E", "longer exposure", [](DisplayState& display, Session&) { expose(display, 0.25f); }},
    {"Shift+E", "shorter exposure", [](DisplayState& display, Session&) { expose(display, -0.25f); }},
    {"A", "automatic exposure", [](DisplayState& display, Session&) { display.automatic = true; }},
    {"D", "show smaller differences", [](DisplayState& display, Session&) { rescale(display, 0.5f); }},
    {"Shift+D", "show larger differences", [](DisplayState& display, Session&) { rescale(display, 2); }},
    {"M", "next mesh", [](DisplayState& display, Session&) { next_mesh(display); }},
    {"Shift+M", "type the name of a mesh file", [](DisplayState& display, Session&) { display.name_mesh = true; }},
    {"R", "next file as the reference", [](DisplayState&, Session& session) { next_reference(session); }},
    {"F", "next model among the files; then fit", [](DisplayState&, Session& session) { next_model(session); }},
    {"J", "one lobe more", [](DisplayState&, Session& s) { choose(s, [](FitChoice& c) { ++c.lobes; }); }},
    {"Shift+J", "one lobe fewer", [](DisplayState&, Session& s) { choose(s, [](FitChoice& c) { --c.lobes; }); }},
    {"N", "one variate more", [](DisplayState&, Session& s) { choose(s, [](FitChoice& c) { ++c.variates; }); }},
    {"Shift+N", "one variate fewer", [](DisplayState&, Session& s) { choose(s, [](FitChoice& c) { --c.variates; }); }},
    {"K", "next form",
     [](DisplayState&, Session& s) {
         choose(s, [](FitChoice& c) { c.form = next_enumerator(c.form, int(k_forms.size())); });
     }},
    {"O", "next objective",
     [](DisplayState&, Session& s) {
         choose(s, [](FitChoice& c) { c.objective = next_enumerator(c.objective, int(objectives().size())); });
     }},
    {"Enter", "fit again", [](DisplayState&, Session& session) { session.refit(); }},
    {"Escape", "cancel the fit; close the help",
     [](DisplayState& display, Session& session) { display.help ? void(display.help = false) : session.cancel(); }},
    {"T", "light of slices and lobes lower by 5\xC2\xB0",
     [](DisplayState& display, Session&) { display.theta_l = std::min(display.theta_l + k_turn, 85 * k_degree); }},
    {"Shift+T", "higher by 5\xC2\xB0",
     [](DisplayState& display, Session&) { display.theta_l = std::max(display.theta_l - k_turn, 0.0); }},
    {"L", "slices logarithmic or linear",
     [](DisplayState& display, Session&) { display.logarithmic = !display.logarithmic; }},
    {"S", "save the model", [](DisplayState& display, Session&) { display.save = true; }},
    {"Shift+S", "type the model's file name", [](DisplayState& display, Session&) { display.name_model = true; }},
    {"P", "screenshot", [](DisplayState& display, Session&) { display.screenshot = true; }},
    {"H", "this help", [](DisplayState& display, Session&) { display.help = !display.help; }},
    {"F1", "", [](DisplayState& display, Session&) { display.help = !display.help; }},
    {"Q", "quit", [](DisplayState& display, Session&) { display.quit = true; }},
};

}  // namespace

std::span<const Key> keys() { return k_keys; }

bool press(std::string_view name, DisplayState& display, Session& session) {
    const auto key = std::ranges::find(keys(), name, &Key::name);
    if (key == keys().end()) return false;
    key->act(display, session);
    return true;
}

}  // namespace srbf
