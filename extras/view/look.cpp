#include "extras/view/look.h"

#include <algorithm>
#include <cmath>

#include "extras/render/environment.h"

namespace srbf {

namespace {

Vec3d towards_eye(const Look& look) {
    const double c = std::cos(look.elevation);
    return {c * std::sin(look.azimuth), std::sin(look.elevation), c * std::cos(look.azimuth)};
}

/// w rotated about the unit vector `axis` (Rodrigues).
Vec3d turned(Vec3d w, Vec3d axis, double angle) {
    return std::cos(angle) * w + std::sin(angle) * cross(axis, w) + (1 - std::cos(angle)) * dot(axis, w) * axis;
}

}  // namespace

Look::Look() { lights = lights_of(camera_of(*this, {{-1, -1, -1}, {1, 1, 1}})); }

Camera camera_of(const Look& look, const Bounds& bounds) {
    const Vec3d least = to_double(bounds.least), most = to_double(bounds.most);
    Camera camera;
    camera.target = 0.5 * (least + most);
    // The sphere around the bounding box lies within the picture.
    const Vec3d diagonal = most - least;
    const double radius = std::max(0.5 * std::sqrt(dot(diagonal, diagonal)), 1e-6);
    camera.eye = camera.target + 0.75 * radius / (std::sin(camera.fov / 2) * look.zoom) * towards_eye(look);
    return camera;
}

void orbit(Look& look, double right, double up) {
    look.azimuth = std::remainder(look.azimuth + right, 2 * k_pi);
    look.elevation = std::clamp(look.elevation + up, -89 * k_degree, 89 * k_degree);
}

void turn_light(Look& look, int light, double right, double up) {
    const Frame axes = frame(camera_of(look, {{-1, -1, -1}, {1, 1, 1}}));
    Vec3d& towards = look.lights[std::size_t(light)].towards;
    towards = normalize(turned(turned(towards, axes.y, right), axes.x, -up));
}

void put_behind(Look& look, int light) {
    look.lights[std::size_t(light)].towards = light_behind(camera_of(look, {{-1, -1, -1}, {1, 1, 1}})).towards;
}

void turn_environment(Look& look, double right) { look.turned = std::remainder(look.turned + right, 2 * k_pi); }

void zoom(Look& look, double factor) { look.zoom = std::clamp(look.zoom * factor, 0.2, 20.0); }

void next_mesh(Look& look) {
    const auto at = std::find(k_built_in_meshes.begin(), k_built_in_meshes.end(), look.mesh);
    look.mesh = at == k_built_in_meshes.end() || at + 1 == k_built_in_meshes.end() ? k_built_in_meshes[0] : *(at + 1);
}

namespace {

constexpr double k_turn = 5 * k_degree, k_nearer = 1.1;

void expose(Look& look, float stops) {
    look.exposure *= std::exp2(stops);
    look.automatic = false;
}
void rescale(Look& look, float factor) {
    look.full_scale = std::clamp(look.full_scale * factor, k_least_scale, k_most_scale);
}
void brighten(Look& look, float factor) {
    Rgb& irradiance = look.lights[std::size_t(look.light)].irradiance;
    for (int c = 0; c < 3; ++c) irradiance[c] = std::clamp(irradiance[c] * factor, 0.01f, 100.f);
}
void keep(Look& look) {
    look.bookmarks.push_back({look.azimuth, look.elevation, look.zoom, look.turned, look.lights});
    look.bookmark = 0;
}
void recall(Look& look) {
    if (look.bookmarks.empty()) return;
    const Bookmark& kept = look.bookmarks[look.bookmark++ % look.bookmarks.size()];
    look.azimuth = kept.azimuth, look.elevation = kept.elevation, look.zoom = kept.zoom, look.turned = kept.turned;
    look.lights = kept.lights;
}
template <typename Change> void choose(Session& session, const Change& change) {
    FitChoice choice = session.choice();
    change(choice);
    session.choose(choice);
}
/// The next one of `count` enumerators.
template <typename E> E after(E of, int count) { return E((int(of) + 1) % count); }

void next_reference(Session& session) {
    const int count = int(session.subjects().size());
    if (count > 0) session.set_reference((session.reference() + 1) % count);
}
void next_model(Session& session) {
    // From the displayed one through the models among the files, then back to fitting.
    const auto& subjects = session.subjects();
    std::size_t from = 0;
    if (session.fitted() && !session.fitted()->from.empty())
        while (from < subjects.size() && subjects[from++]->path != session.fitted()->from) {
        }
    while (from < subjects.size() && (!subjects[from]->is_model() || int(from) == session.reference())) ++from;
    from < subjects.size() ? session.show_model(int(from)) : session.refit();
}

constexpr Key k_keys[] = {
    {"Left", "orbit", [](Look& look, Session&) { orbit(look, -k_turn, 0); }},
    {"Right", "", [](Look& look, Session&) { orbit(look, k_turn, 0); }},
    {"Up", "", [](Look& look, Session&) { orbit(look, 0, k_turn); }},
    {"Down", "", [](Look& look, Session&) { orbit(look, 0, -k_turn); }},
    {"PageUp", "nearer", [](Look& look, Session&) { zoom(look, k_nearer); }},
    {"PageDown", "further away", [](Look& look, Session&) { zoom(look, 1 / k_nearer); }},
    {"1", "choose light 1, 2, 3", [](Look& look, Session&) { look.light = 0; }},
    {"2", "", [](Look& look, Session&) { look.light = 1; }},
    {"3", "", [](Look& look, Session&) { look.light = 2; }},
    {"Shift+Left", "turn the chosen light", [](Look& look, Session&) { turn_light(look, look.light, -k_turn, 0); }},
    {"Shift+Right", "", [](Look& look, Session&) { turn_light(look, look.light, k_turn, 0); }},
    {"Shift+Up", "", [](Look& look, Session&) { turn_light(look, look.light, 0, k_turn); }},
    {"Shift+Down", "", [](Look& look, Session&) { turn_light(look, look.light, 0, -k_turn); }},
    {"I", "the chosen light behind the object", [](Look& look, Session&) { put_behind(look, look.light); }},
    {"Shift+PageUp", "brighten the chosen light", [](Look& look, Session&) { brighten(look, 1.25f); }},
    {"Shift+PageDown", "dim it", [](Look& look, Session&) { brighten(look, 0.8f); }},
    {"V", "environment: studio, none",
     [](Look& look, Session&) {
         look.environment = look.has_environment() ? "none" : std::string(k_built_in_environment);
     }},
    {"Shift+V", "type the name of an environment file", [](Look& look, Session&) { look.name_environment = true; }},
    {"X", "turn the environment", [](Look& look, Session&) { turn_environment(look, k_turn); }},
    {"Shift+X", "", [](Look& look, Session&) { turn_environment(look, -k_turn); }},
    {"C", "the three lights beside the environment", [](Look& look, Session&) { look.lamps = !look.lamps; }},
    {"W", "wipe: measured and fit in one picture", [](Look& look, Session&) { look.wipe = !look.wipe; }},
    {"U", "flip: measured or fit alone",
     [](Look& look, Session&) { look.divider = look.wipe && look.divider > 0.5f ? 0.f : 1.f, look.wipe = true; }},
    {"Z", "move the divider", [](Look& look, Session&) { look.divider = std::max(look.divider - 0.02f, 0.f); }},
    {"Shift+Z", "", [](Look& look, Session&) { look.divider = std::min(look.divider + 0.02f, 1.f); }},
    {"B", "keep view and lights as a bookmark", [](Look& look, Session&) { keep(look); }},
    {"Shift+B", "next bookmark", [](Look& look, Session&) { recall(look); }},
    {"Y", "open the next recent file", [](Look& look, Session&) { look.open_recent = true; }},
    {"Shift+Y", "type or choose a file to open", [](Look& look, Session&) { look.open_file = true; }},
    {"G", "difference of luminance or ΔE", [](Look& look, Session&) { look.in_delta_e = !look.in_delta_e; }},
    {"E", "longer exposure", [](Look& look, Session&) { expose(look, 0.25f); }},
    {"Shift+E", "shorter exposure", [](Look& look, Session&) { expose(look, -0.25f); }},
    {"A", "automatic exposure", [](Look& look, Session&) { look.automatic = true; }},
    {"D", "show smaller differences", [](Look& look, Session&) { rescale(look, 0.5f); }},
    {"Shift+D", "show larger differences", [](Look& look, Session&) { rescale(look, 2); }},
    {"M", "next mesh", [](Look& look, Session&) { next_mesh(look); }},
    {"Shift+M", "type the name of a mesh file", [](Look& look, Session&) { look.name_mesh = true; }},
    {"R", "next file as the reference", [](Look&, Session& session) { next_reference(session); }},
    {"F", "next model among the files; then fit", [](Look&, Session& session) { next_model(session); }},
    {"J", "one lobe more", [](Look&, Session& s) { choose(s, [](FitChoice& c) { ++c.lobes; }); }},
    {"Shift+J", "one lobe fewer", [](Look&, Session& s) { choose(s, [](FitChoice& c) { --c.lobes; }); }},
    {"N", "one variate more", [](Look&, Session& s) { choose(s, [](FitChoice& c) { ++c.variates; }); }},
    {"Shift+N", "one variate fewer", [](Look&, Session& s) { choose(s, [](FitChoice& c) { --c.variates; }); }},
    {"K", "next form",
     [](Look&, Session& s) { choose(s, [](FitChoice& c) { c.form = after(c.form, int(k_forms.size())); }); }},
    {"O", "next objective",
     [](Look&, Session& s) {
         choose(s, [](FitChoice& c) { c.objective = after(c.objective, int(objectives().size())); });
     }},
    {"Enter", "fit again", [](Look&, Session& session) { session.refit(); }},
    {"Escape", "cancel the fit; close the help",
     [](Look& look, Session& session) { look.help ? void(look.help = false) : session.cancel(); }},
    {"T", "light of slices and lobes lower by 5\xC2\xB0",
     [](Look& look, Session&) { look.theta_l = std::min(look.theta_l + k_turn, 85 * k_degree); }},
    {"Shift+T", "higher by 5\xC2\xB0",
     [](Look& look, Session&) { look.theta_l = std::max(look.theta_l - k_turn, 0.0); }},
    {"L", "slices logarithmic or linear", [](Look& look, Session&) { look.logarithmic = !look.logarithmic; }},
    {"S", "save the model", [](Look& look, Session&) { look.save = true; }},
    {"Shift+S", "type the model's file name", [](Look& look, Session&) { look.name_model = true; }},
    {"P", "screenshot", [](Look& look, Session&) { look.screenshot = true; }},
    {"H", "this help", [](Look& look, Session&) { look.help = !look.help; }},
    {"F1", "", [](Look& look, Session&) { look.help = !look.help; }},
    {"Q", "quit", [](Look& look, Session&) { look.quit = true; }},
};

}  // namespace

std::span<const Key> keys() { return k_keys; }

bool press(std::string_view name, Look& look, Session& session) {
    const auto key = std::ranges::find(keys(), name, &Key::name);
    if (key == keys().end()) return false;
    key->act(look, session);
    return true;
}

}  // namespace srbf
