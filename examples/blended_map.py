#!/usr/bin/env python3
"""A surface that changes between the materials of a library of shared lobes, as a map of coefficients; with NumPy alone.

    srbf basis paper.bsdf film.bsdf gold.bsdf paint.bsdf card.bsdf --lobes 16 -o library.srbf
    python3 blended_map.py library.srbf 1024x512 map.srbf

A BRDF is linear in its coefficients, so those of a texel are the mean of the materials', weighted by the texel's share of each.
`shares` draws these shares; replace it by masks of your own, of an array [height, width, materials] whose rows begin with the
top one.
"""
import json
import sys

import numpy as np


def shares(u, v, count):
    """At (u, v) in [0, 1], which wraps around a sphere: the share of each of `count` materials, which sum to 1, [.., count]. The
    first is the ground of a pattern of waves; twice along u the pattern changes through the others and back to the first of them."""
    waves = sum(np.cos(2 * np.pi * (k * u + 8 * np.sin(1.7 * k) * v) + k * k) for k in (7, -5, 12, -13, 3, 16, -9))
    inside = np.clip((waves + 0.4) / 0.8 + 0.5, 0, 1)[..., None]
    apart = np.abs((2 * u % 1 * (count - 1))[..., None] - np.arange(count - 1))
    turn = np.clip(1 - np.minimum(apart, count - 1 - apart), 0, 1)
    return np.concatenate([1 - inside, inside * turn], axis=-1)


def read(path):
    """The tensors and the metadata of a safetensors file."""
    with open(path, "rb") as file:
        head = json.loads(file.read(int.from_bytes(file.read(8), "little")))
        data = file.read()
    metadata, types = head.pop("__metadata__"), {"F16": np.float16, "U16": np.uint16}
    return {name: np.frombuffer(data[slice(*of["data_offsets"])], types[of["dtype"]]).reshape(of["shape"]) for name, of in head.items()}, metadata


def write(path, tensors, metadata):
    head, at = {"__metadata__": metadata}, 0
    for name, of in sorted(tensors.items()):
        head[name] = {"dtype": {"f": "F16", "u": "U16"}[of.dtype.kind], "shape": of.shape, "data_offsets": [at, at + of.nbytes]}
        at += of.nbytes
    text = json.dumps(head).encode()
    text += b" " * (-len(text) % 8)
    with open(path, "wb") as file:
        file.write(len(text).to_bytes(8, "little") + text)
        for _, of in sorted(tensors.items()):
            file.write(of.tobytes())


library, size, output = sys.argv[1:]
width, height = (int(n) for n in size.split("x"))
tensors, metadata = read(library)
if "index" in tensors:
    sys.exit(f"{library}: each material has lobes of its own; make it without --active")
materials = tensors["coefficient"].astype(np.float32)  # [material, lobe, channel]
u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
of_texel = shares(u, v, len(materials)).reshape(width * height, -1)
tensors["coefficient"] = np.einsum("tm,mjc->tjc", of_texel, materials).astype(np.float16)
tensors["aux.error"] = (of_texel @ tensors["aux.error"].astype(np.float32)).astype(np.float16)
metadata.pop("names")
write(output, tensors, metadata | {"width": str(width)})
