"""A sphere under a directional light: the picture of a model, and the differences of other programs from it.

The sphere has radius 1 about the origin. The camera at (0, 0, 5) looks at it with a field of 26 degrees, and light
comes from the direction (-2, 2, 3), with irradiance 3 on a surface that faces it. A picture is linear radiance [256, 256, 3], its highest row first.
"""
import math
import subprocess

import numpy as np

from support.visible_error import delta_e, displayed, exposure

SIZE, DISTANCE, HALF_FIELD = 256, 5, math.radians(13)
TO_LIGHT, IRRADIANCE = np.array([-2, 2, 3]) / math.sqrt(17), 3
WITHIN = 1  # ΔE_ITP in the mean over the sphere


def points():
    """A mask of the pixels on the sphere, without its silhouette, and their normals and directions to the viewer, [n, 3]."""
    at = math.tan(HALF_FIELD) * ((np.arange(SIZE) + 0.5) / SIZE * 2 - 1)
    x, y = np.meshgrid(at, -at)
    ray = np.stack([x, y, -np.ones_like(x)], axis=-1) / np.sqrt(x**2 + y**2 + 1)[..., None]
    inside = np.hypot(x, y) < 0.98 / math.sqrt(DISTANCE**2 - 1)
    ray = ray[inside]
    along = -DISTANCE * ray[:, 2]
    normal = (along - np.sqrt(along**2 - DISTANCE**2 + 1))[:, None] * ray + np.array([0, 0, DISTANCE])
    return inside, normal, -ray


def pairs():
    """Directions to the light and to the viewer, [n, 6], at those pixels; the x axis of the surface is along its circles of latitude about y."""
    _, normal, viewer = points()
    tangent = np.cross([0, 1, 0], normal)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    frame = np.stack([tangent, np.cross(normal, tangent), normal], axis=1)
    return np.concatenate([frame @ TO_LIGHT, (frame @ viewer[..., None])[..., 0]], axis=1)


def reflected(program, model, directions, folder):
    """The radiance [n, 3] for pairs of directions, by `srbf eval`."""
    np.savetxt(f"{folder}/pairs.csv", directions, delimiter=",", header="wl_x,wl_y,wl_z,wv_x,wv_y,wv_z", comments="", fmt="%.9g")
    lines = subprocess.run([program, "eval", model, "--pairs", f"{folder}/pairs.csv"], check=True, capture_output=True, text=True).stdout.split()
    return IRRADIANCE * np.maximum(directions[:, 2:3], 0) * np.array([line.split(",")[6:9] for line in lines[1:]], dtype=float)


def reference(program, model, folder):
    """The picture from values of the model."""
    picture = np.zeros((SIZE, SIZE, 3))
    picture[points()[0]] = reflected(program, model, pairs(), folder)
    return picture


def picture_error(picture, model_picture):
    """The mean ΔE_ITP over the sphere of a host's picture against that of the model."""
    inside = points()[0]
    return delta_e(picture[inside], model_picture[inside])


def side_by_side(model_picture, pictures):
    """The model's picture and those of hosts in a row, 8-bit sRGB, with the exposure of the first."""
    factor = exposure(model_picture[points()[0]])
    return np.concatenate([displayed(picture, factor) for picture in (model_picture, *pictures)], axis=1)
