"""Makes the stand-ins of docs/comparison.md: python3 paper/stand_ins.py NETWORKS OUT

Writes a table of MERL's layout, OUT/NAME.binary, for each network that Sztrajman et al. published (Neural BRDF
Representation and Importance Sampling, 2021). NETWORKS is a folder with, for each material, either

NAME.txt          675 numbers: weights [6, 21], offsets [21], weights [21, 21], offsets [21], weights [21, 3] and offsets [3]
NAME_fc1.npy ..   the same six arrays, fc1, b1, fc2, b2, fc3 and b3, as the authors' program h5_to_npy.py writes them

Needs NumPy. A table takes 35 MB.
"""
import os
import sys

import numpy as np

SHAPES = [(6, 21), (21,), (21, 21), (21,), (21, 3), (3,)]
ARRAYS = ["fc1", "b1", "fc2", "b2", "fc3", "b3"]
HALF, DIFFERENCE, AZIMUTH = 90, 90, 180  # nodes of MERL's layout
SCALE = np.array([1, 1.15, 1.66]) / 1500  # 1/sr of a stored number, red, green and blue


def names_in(folder):
    """The materials of a folder of networks."""
    stems = (name.removesuffix(".txt").removesuffix("_fc1.npy")
             for name in os.listdir(folder) if name.endswith((".txt", "_fc1.npy")))
    return sorted(set(stems))


def network_of(folder, name):
    """The three layers of a material, [(weights, offsets)], or None."""
    path = os.path.join(folder, name)
    if os.path.exists(path + ".txt"):
        with open(path + ".txt", encoding="ascii") as file:
            numbers = np.array(file.read().split(), float)
        ends = np.cumsum([np.prod(shape) for shape in SHAPES])
        if len(numbers) != ends[-1]:
            sys.exit(f"{path}.txt: expected {ends[-1]} numbers, found {len(numbers)}")
        arrays = [part.reshape(shape) for part, shape in zip(np.split(numbers, ends[:-1]), SHAPES)]
    elif os.path.exists(path + "_fc1.npy"):
        arrays = [np.load(f"{path}_{array}.npy").astype(float) for array in ARRAYS]
    else:
        return None
    return list(zip(arrays[0::2], arrays[1::2]))


def rounded(layers):
    """The layers with numbers rounded to 16-bit floats."""
    return [(weights.astype(np.float16).astype(float), offsets.astype(np.float16).astype(float)) for weights, offsets in layers]


def network_value(layers, half, difference):
    """f [1/sr] for n pairs, by the half vector at azimuth 0 and the light in its frame: two arrays [n, 3]."""
    x = np.concatenate([half, difference], axis=1)
    for weights, offsets in layers[:-1]:
        x = np.maximum(x @ weights + offsets, 0)
    weights, offsets = layers[-1]
    return np.maximum(np.exp(x @ weights + offsets) - 1, 0)


def table_of(layers):
    """The stored numbers [3, θh, θd, φd] of MERL's layout: quadratic in θh, and -1 below the horizon."""
    table = np.empty((3, HALF, DIFFERENCE, AZIMUTH))
    theta_d = (np.arange(DIFFERENCE) / DIFFERENCE * np.pi / 2)[:, None]
    phi_d = (np.arange(AZIMUTH) / AZIMUTH * np.pi)[None, :]
    components = np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d), np.cos(theta_d)
    difference = np.stack(np.broadcast_arrays(*components), axis=-1)
    for row in range(HALF):
        theta_h = (row / HALF) ** 2 * np.pi / 2
        half = np.array([np.sin(theta_h), 0, np.cos(theta_h)])
        # The cosines are z - x of the light and z + x of the viewer.
        z, x = difference[..., 2] * half[2], difference[..., 0] * half[0]
        f = network_value(layers, np.broadcast_to(half, (z.size, 3)), difference.reshape(-1, 3))
        f = f.reshape(DIFFERENCE, AZIMUTH, 3)
        table[:, row] = np.where((z > abs(x))[..., None], f / SCALE, -1).transpose(2, 0, 1)
    return table


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    networks, out = sys.argv[1:]
    os.makedirs(out, exist_ok=True)
    for name in names_in(networks):
        with open(os.path.join(out, name + ".binary"), "wb") as file:
            np.array([HALF, DIFFERENCE, AZIMUTH], np.int32).tofile(file)
            table_of(network_of(networks, name)).tofile(file)


if __name__ == "__main__":
    main()
