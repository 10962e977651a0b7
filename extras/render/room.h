// A room behind a shade.
#pragma once
#include "extras/render/mesh.h"
#include "extras/render/scene.h"

namespace SRBF_NAMESPACE {

/// A room whose only light comes through a shade that fills the opening of one wall. Lengths are in metres, y is
/// up. The wall with the opening is at z = 0, the room at z < 0.
struct Room {
    Mesh shade;     ///< a rectangle, its front outwards, to +z
    Mesh walls;     ///< with floor and ceiling, visible from inside, without the opening
    Mesh floor;     ///< above the floor of the walls
    Mesh ball;      ///< on the floor
    Camera camera;  ///< in the room, towards the shade
};
Room room();

}  // namespace srbf
