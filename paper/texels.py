"""Makes synthetic maps of texels, and measures errors of fits to them at other pairs of directions. Needs NumPy.

python3 paper/texels.py make FOLDER --program SRBF --texels N [FILE...]
    writes FOLDER/texels.npy and pairs.csv, for `srbf map texels.npy --pairs pairs.csv --lobes J`: values at 256 pairs
    within 78°, half of them with the light near the mirror direction, with noise of 2 %. If there are measurements, a
    texel blends them in random proportions. Otherwise it is a Lambert and a GGX lobe with random colour, roughness and
    reflectance at normal incidence.
python3 paper/texels.py compare FOLDER MAP... --program SRBF [--sample 64] [--texels N]
    prints for some of the texels, or of the first N of them, the errors of MAP against values without noise at other pairs.
"""
import argparse
import json
import os
import subprocess

import numpy as np

PAIRS, OTHER_PAIRS = 256, 2048
MAX_THETA = np.radians(78)
NOISE = 0.02
CHUNK = 4096  # texels that are computed together


def directions(random, count):
    z, phi = random.uniform(np.cos(MAX_THETA), 1, count), random.uniform(0, 2 * np.pi, count)
    return np.stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z], axis=1)


def pairs_of(random, count):
    """Random wl and wv; half of the lights are near the mirror direction."""
    wl, wv = directions(random, count), directions(random, count)
    near = wv[::2] * [-1, -1, 1] + 0.1 * random.normal(size=wv[::2].shape)
    near /= np.linalg.norm(near, axis=1, keepdims=True)
    wl[::2] = np.where(near[:, 2:] > np.cos(MAX_THETA), near, wl[::2])
    return wl, wv


def evaluate(program, brdf, pairs):
    """f_r [1/sr] of a measurement or a model at pairs, [M, 3]."""
    command = [program, "eval", brdf, "--pairs", pairs, "--channels", "rgb"]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return np.array([line.split(",")[-3:] for line in lines.splitlines()[1:]], float)


class Blends:
    """Blends of measurements, in proportions that are uniform over the simplex."""

    def __init__(self, program, files, pairs):
        self.f = np.stack([evaluate(program, file, pairs) for file in files])

    def values(self, texels):
        # Normalised exponential variates are uniform over the simplex. A hash of the texel's number gives them.
        fraction = -np.log(uniform(texels, len(self.f)))
        return np.einsum("tk,kmc->tmc", fraction / fraction.sum(axis=1, keepdims=True), self.f)


class Ggx:
    """k_d / π + D G F / (4 cosθl cosθv): metals and dielectrics, α from 0.08 to 0.6."""

    def __init__(self, pairs):
        wl, wv = np.split(np.loadtxt(pairs, delimiter=",", skiprows=1), 2, axis=1)
        half = wl + wv
        half /= np.linalg.norm(half, axis=1, keepdims=True)
        self.cos_l, self.cos_v, self.cos_h = wl[:, 2], wv[:, 2], half[:, 2]
        self.schlick = (1 - np.sum(wl * half, axis=1)) ** 5

    def values(self, texels):
        number = uniform(texels, 8)
        alpha, metal = 0.08 * 7.5 ** number[:, :1], number[:, 1:2] ** 2
        colour = number[:, 2:5]
        reflectance = metal * (0.4 + 0.6 * colour) + (1 - metal) * (0.02 + 0.06 * number[:, 5:6])
        diffuse = (1 - metal) * colour * 0.9

        def masking(cosine):
            return 2 * cosine / (cosine + np.sqrt(alpha**2 + (1 - alpha**2) * cosine**2))

        d = alpha**2 / (np.pi * (self.cos_h**2 * (alpha**2 - 1) + 1) ** 2)
        lobe = d * masking(self.cos_l) * masking(self.cos_v) / (4 * self.cos_l * self.cos_v)
        fresnel = reflectance[:, None] + (1 - reflectance[:, None]) * self.schlick[None, :, None]
        return diffuse[:, None] / np.pi + lobe[:, :, None] * fresnel


def uniform(texels, count):
    """`count` numbers in (0, 1) for each texel, by splitmix64 of its number."""
    with np.errstate(over="ignore"):
        x = np.asarray(texels, np.uint64)[:, None] * np.uint64(count) + np.arange(1, count + 1, dtype=np.uint64)
        x *= np.uint64(0x9E3779B97F4A7C15)
        x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return ((x ^ (x >> np.uint64(31))) >> np.uint64(11)).astype(float) * 2.0**-53 + 2.0**-54


def materials(program, files, pairs):
    return Blends(program, files, pairs) if files else Ggx(pairs)


def make(folder, program, files, texels):
    os.makedirs(folder, exist_ok=True)
    random = np.random.default_rng(1)
    for name, count in [("pairs.csv", PAIRS), ("other.csv", OTHER_PAIRS)]:
        np.savetxt(os.path.join(folder, name), np.hstack(pairs_of(random, count)), delimiter=",",
                   header="wl_x,wl_y,wl_z,wv_x,wv_y,wv_z", comments="")
    with open(os.path.join(folder, "files.json"), "w", encoding="utf-8") as file:
        json.dump([os.path.abspath(path) for path in files], file)
    source = materials(program, files, os.path.join(folder, "pairs.csv"))
    out = np.lib.format.open_memmap(os.path.join(folder, "texels.npy"), "w+", np.float32, (texels, PAIRS, 3))
    for first in range(0, texels, CHUNK):
        f = source.values(np.arange(first, min(first + CHUNK, texels)))
        out[first:first + CHUNK] = f * (1 + NOISE * random.standard_normal(f.shape, np.float32))


def cube_root_error(f, g):
    """Σ (∛f − ∛g)² / Σ ∛f²."""
    return np.sum((np.cbrt(f) - np.cbrt(g)) ** 2) / np.sum(np.cbrt(f) ** 2)


def compare(folder, program, maps, sample, most):
    other = os.path.join(folder, "other.csv")
    count = min(len(np.load(os.path.join(folder, "texels.npy"), mmap_mode="r")), most)
    which = (np.arange(sample) * 2 + 1) * count // (2 * sample)
    with open(os.path.join(folder, "files.json"), encoding="utf-8") as file:
        expected = materials(program, json.load(file), other).values(which)
    for path in maps:
        errors = np.array([cube_root_error(f, evaluate(program, f"{path}#{t}", other)) for f, t in zip(expected, which)])
        print(f"{path}: mean {errors.mean():.3%}, median {np.median(errors):.3%}, 95 % {np.quantile(errors, 0.95):.3%}", flush=True)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("work", choices=["make", "compare"])
    options.add_argument("folder")
    options.add_argument("files", nargs="*", metavar="FILE")
    options.add_argument("--program", default="srbf")
    options.add_argument("--texels", type=int, default=1024 * 1024)
    options.add_argument("--sample", type=int, default=64)
    arguments = options.parse_intermixed_args()
    if arguments.work == "make":
        make(arguments.folder, arguments.program, arguments.files, arguments.texels)
    else:
        compare(arguments.folder, arguments.program, arguments.files, arguments.sample, arguments.texels)


if __name__ == "__main__":
    main()
