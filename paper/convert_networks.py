"""Converts published networks for compare_models.py and stand_ins.py.

python3 paper/convert_networks.py nbrdf FILE.h5... OUT
    converts networks of Sztrajman et al. (data/merl_nbrdf.zip, data/rgl-isotropic_nbrdf.zip of asztr/Neural-BRDF) to
    OUT/NAME.txt
python3 paper/convert_networks.py nps FOLDER OUT
    converts the repository of Zheng et al. (Rendering-at-ZJU/NPs-BRDF) to OUT/decoder.f32 and OUT/latents.txt

Needs NumPy and h5py. Run on all networks of Sztrajman et al., but for Zheng et al. only on synthetic files in Keras'
layout of weights; shapes are checked.
"""
import glob
import os
import sys

import h5py
import numpy as np
from stand_ins import SHAPES

DECODER = [shape for inputs, outputs in [(11, 400)] + [(400, 400)] * 5 + [(400, 3)] for shape in ((inputs, outputs), (outputs,))]


def weights_of(path, shapes, only=None):
    """The arrays that Keras saved: weights and offsets of each layer, or of the layer or nested model `only`."""
    def text(name):
        return name.decode() if isinstance(name, bytes) else name

    with h5py.File(path) as file:
        root = file.get("model_weights", file)
        layers = [only] if only else [text(name) for name in root.attrs["layer_names"]]
        arrays = [np.asarray(root[layer][text(name)], np.float32)
                  for layer in layers for name in root[layer].attrs["weight_names"]]
    if [array.shape for array in arrays] != shapes:
        sys.exit(f"{path}: expected arrays of the shapes {shapes}, found {[array.shape for array in arrays]}")
    return np.concatenate([array.ravel() for array in arrays])


def convert_nbrdf(paths, out):
    for path in paths:
        name = os.path.basename(path).removesuffix(".h5").removesuffix("_rgb")
        np.savetxt(os.path.join(out, name + ".txt"), weights_of(path, SHAPES), fmt="%.9g")


def convert_nps(folder, out):
    path, = glob.glob(os.path.join(folder, "models", "LOG4_Mean_Dim7", "weight", "*.h5"))
    weights_of(path, DECODER, "decoder").tofile(os.path.join(out, "decoder.f32"))
    with open(os.path.join(out, "latents.txt"), "w", encoding="ascii") as file:
        for path in sorted(glob.glob(os.path.join(folder, "latent_vectors", "*_latentVector.npy"))):
            name = os.path.basename(path).removesuffix("_latentVector.npy").removesuffix("_rgb")
            means = np.load(path).ravel()[:7]  # the variances follow
            print(name, *(f"{mean:.9g}" for mean in means), file=file)


def main():
    if len(sys.argv) < 4 or sys.argv[1] not in ("nbrdf", "nps"):
        sys.exit(__doc__)
    kind, *paths, out = sys.argv[1:]
    os.makedirs(out, exist_ok=True)
    if kind == "nbrdf":
        convert_nbrdf(paths, out)
    else:
        convert_nps(paths[0], out)


if __name__ == "__main__":
    main()
