// How the window looks at things, and what keys do to it: no window is needed for either.
#pragma once
#include <array>
#include <span>
#include <string>
#include <string_view>

#include "app/view/session.h"
#include "render/scene.h"

namespace srbf {

/// Camera, lights and what else is chosen of the pictures and plots.
struct Look {
    double azimuth = 0, elevation = 15 * k_degree;  ///< of the eye [rad], within ±89°
    double zoom = 1;                                ///< of the picture, 0.2 to 20
    std::array<DirectionalLight, 3> lights;         ///< where they are in the world
    int light = 0;                                  ///< the one that keys turn
    float exposure = 1;
    bool automatic = true;    ///< exposure follows the reference; until it is set by hand
    float full_scale = 0.1f;  ///< of the difference, k_least_scale to k_most_scale
    std::string mesh = "ball";
    double theta_l = 45 * k_degree;  ///< of the slices and the lobes, 0 to 85°
    bool logarithmic = true;         ///< slices, over k_decades; else linear
    bool help = false;
    // What the window shall do, which takes these back:
    bool quit = false, screenshot = false, save = false, name_mesh = false, name_model = false;

    Look();
};
inline constexpr float k_least_scale = 0.001f, k_most_scale = 10;
inline constexpr double k_decades = 4;

/// The camera on a mesh of those bounds.
Camera camera_of(const Look& look, const Bounds& bounds);
/// Turns the eye, or a light as it is seen from the camera, by so much to the right and up [rad].
void orbit(Look& look, double right, double up);
void turn_light(Look& look, int light, double right, double up);
/// Nearer by factors above 1.
void zoom(Look& look, double factor);
/// The next of `k_built_in_meshes`; the first after a file.
void next_mesh(Look& look);

/// What a key does. `name` is a letter or digit, or Left, Right, Up, Down, PageUp, PageDown, Enter, Escape, F1; "Shift+" before it.
struct Key {
    std::string_view name, what;
    void (*act)(Look& look, Session& session);
};
/// All of them, in the order in which the help lists them.
std::span<const Key> keys();
/// Does what that key does; false where there is none of that name.
bool press(std::string_view name, Look& look, Session& session);

}  // namespace srbf
