// The display state of the window, and the actions of keys; independent of the window.
#pragma once
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "extras/render/scene.h"
#include "extras/view/session.h"

namespace SRBF_NAMESPACE {

/// The part of the state that a bookmark restores.
struct Bookmark {
    double azimuth, elevation, zoom, turned;
    std::array<DirectionalLight, 3> lights;
};

/// Camera, lights and other display options of pictures and plots.
struct DisplayState {
    double azimuth = 0, elevation = 15 * k_degree;  ///< of the eye [rad]; elevation within ±89°
    double zoom = 1;                                ///< magnification, 0.2 to 20
    std::array<DirectionalLight, 3> lights;         ///< in world coordinates
    int light = 0;                                  ///< the light that keys rotate
    std::string environment = "none";               ///< a .hdr or .exr file, studio or none
    double turned = 0;                              ///< rotation of the environment about +y [rad]
    bool lamps = false;                             ///< the three lights in addition to an environment
    bool wipe = false;                              ///< one picture, divided between measured and fit, instead of three
    float divider = 0.5f;     ///< position of the divider, from the left edge (0) to the right (1)
    bool in_delta_e = false;  ///< difference as ΔE_ITP / 100 instead of luminance
    std::vector<Bookmark> bookmarks;
    std::size_t bookmark = 0;  ///< the bookmark that is restored next
    float exposure = 1;
    bool automatic = true;    ///< the exposure follows the reference until it is set manually
    float full_scale = 0.1f;  ///< the difference of full colour, k_least_scale to k_most_scale
    /// The displayed value of a difference of 1: ΔE_ITP, or the brightness of white.
    float unit() const { return in_delta_e ? 100.f : 1.f; }
    std::string mesh = "ball";
    double theta_l = 45 * k_degree;  ///< for slices and lobes, 0 to 85°
    double phi_v = 0;                ///< for slices: angle of their plane from the plane of incidence [rad], 0 to π/2
    bool logarithmic = true;         ///< slices are logarithmic over k_decades; otherwise linear
    bool help = false;
    // Requests to the window, which resets them:
    bool quit = false, screenshot = false, save = false, name_mesh = false, name_model = false,
         name_environment = false, open_recent = false, open_file = false;

    DisplayState();
    bool has_environment() const { return environment != "none"; }
    bool has_lights() const { return !has_environment() || lamps; }
};
inline constexpr float k_least_scale = 0.001f, k_most_scale = 10;
inline constexpr double k_decades = 4;

/// The camera for a mesh with these bounds.
Camera camera_of(const DisplayState& display, const Bounds& bounds);
/// Rotates the eye, or a light relative to the camera, to the right and upwards [rad].
void orbit(DisplayState& display, double right, double up);
void turn_light(DisplayState& display, int light, double right, double up);
/// Moves a light to `k_light_behind`, behind the object.
void put_behind(DisplayState& display, int light);
/// Rotates the environment to the right [rad].
void turn_environment(DisplayState& display, double right);
/// Zooms; factors above 1 magnify.
void zoom(DisplayState& display, double factor);
/// Selects the next of `k_built_in_meshes`, or the first one after a file.
void next_mesh(DisplayState& display);

/// A key and its action. `name` is a letter or digit, or Left, Right, Up, Down, PageUp, PageDown, Enter, Escape,
/// F1, with the prefix "Shift+" if Shift is held.
struct Key {
    std::string_view name, what;
    void (*act)(DisplayState& display, Session& session);
};
/// All keys, in the order of the help.
std::span<const Key> keys();
/// Performs the action of a key. Returns false if there is no key with this name.
bool press(std::string_view name, DisplayState& display, Session& session);

}  // namespace srbf
