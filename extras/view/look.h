// Display options of the window, and the actions of keys; independent of the window.
#pragma once
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "extras/render/scene.h"
#include "extras/view/session.h"

namespace srbf {

/// The state that a bookmark recalls.
struct Bookmark {
    double azimuth, elevation, zoom, turned;
    std::array<DirectionalLight, 3> lights;
};

/// Camera, lights and other options of pictures and plots.
struct Look {
    double azimuth = 0, elevation = 15 * k_degree;  ///< of the eye [rad], within ±89°
    double zoom = 1;                                ///< of the picture, 0.2 to 20
    std::array<DirectionalLight, 3> lights;         ///< in world coordinates
    int light = 0;                                  ///< the one that keys rotate
    std::string environment = "none";               ///< a .hdr or .exr file, or studio or none
    double turned = 0;                              ///< of the environment about +y [rad]
    bool lamps = false;                             ///< the three lights beside an environment
    bool wipe = false;                              ///< one picture, divided between measured and fit, instead of three
    float divider = 0.5f;                           ///< of the wiped picture, from its left edge to its right one
    bool in_delta_e = false;                        ///< the difference: ΔE_ITP / 100 instead of luminance
    std::vector<Bookmark> bookmarks;
    std::size_t bookmark = 0;  ///< the one that is recalled next
    float exposure = 1;
    bool automatic = true;    ///< exposure follows the reference until it is set manually
    float full_scale = 0.1f;  ///< of the difference, k_least_scale to k_most_scale
    /// The name of a difference of 1: ΔE_ITP, or the brightness of white.
    float unit() const { return in_delta_e ? 100.f : 1.f; }
    std::string mesh = "ball";
    double theta_l = 45 * k_degree;  ///< for slices and lobes, 0 to 85°
    double phi_v = 0;                ///< of slices: their plane's angle from that of the light [rad], 0 to π/2
    bool logarithmic = true;         ///< slices, over k_decades; otherwise linear
    bool help = false;
    // Requests to the window, which resets them:
    bool quit = false, screenshot = false, save = false, name_mesh = false, name_model = false,
         name_environment = false, open_recent = false, open_file = false;

    Look();
    bool has_environment() const { return environment != "none"; }
    bool has_lights() const { return !has_environment() || lamps; }
};
inline constexpr float k_least_scale = 0.001f, k_most_scale = 10;
inline constexpr double k_decades = 4;

/// The camera for a mesh with those bounds.
Camera camera_of(const Look& look, const Bounds& bounds);
/// Rotates the eye, or a light relative to the camera, to the right and up [rad].
void orbit(Look& look, double right, double up);
void turn_light(Look& look, int light, double right, double up);
/// Moves a light to `k_light_behind`.
void put_behind(Look& look, int light);
/// Turns the environment to the right [rad].
void turn_environment(Look& look, double right);
/// Zooms in by factors above 1.
void zoom(Look& look, double factor);
/// The next of `k_built_in_meshes`; the first one after a file.
void next_mesh(Look& look);

/// The action of a key. `name` is a letter or digit, or Left, Right, Up, Down, PageUp, PageDown, Enter, Escape, F1;
/// with the prefix "Shift+" if shift is held.
struct Key {
    std::string_view name, what;
    void (*act)(Look& look, Session& session);
};
/// All keys, in the order of the help.
std::span<const Key> keys();
/// Performs the action of that key; returns false if there is none with that name.
bool press(std::string_view name, Look& look, Session& session);

}  // namespace srbf
