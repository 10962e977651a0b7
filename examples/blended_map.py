"""Masks of a surface that changes between materials, from which `srbf map` paints a map; with NumPy alone.

    python3 blended_map.py 1024x512 5 masks.npy
    srbf map paper.bsdf film.bsdf gold.bsdf paint.bsdf card.bsdf --masks masks.npy --lobes 16 -o map.srbf

`shares` draws them; masks of your own are an array [height, width, materials] whose rows begin with the top one.
"""
import sys

import numpy as np


def shares(u, v, count):
    """At (u, v) in [0, 1], which wraps around a sphere: the share of each of `count` materials, which sum to 1, [.., count]. The
    first is the ground of a pattern of waves; twice along u the pattern changes through the others and back to the first of them."""
    waves = sum(np.cos(2 * np.pi * (k * u + 8 * np.sin(1.7 * k) * v) + k * k) for k in (7, -5, 12, -13, 3, 16, -9))
    inside = np.clip((waves + 0.4) / 0.8 + 0.5, 0, 1)[..., None]
    distance = np.abs((2 * u % 1 * (count - 1))[..., None] - np.arange(count - 1))
    turn = np.clip(1 - np.minimum(distance, count - 1 - distance), 0, 1)
    return np.concatenate([1 - inside, inside * turn], axis=-1)


size, count, output = sys.argv[1:]
width, height = (int(n) for n in size.split("x"))
u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
np.save(output, shares(u, v, int(count)).astype(np.float32))
