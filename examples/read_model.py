"""Reads and evaluates a multivariate model with axial centres, with NumPy alone: read_model.py MODEL PAIRS.csv > VALUES.csv"""
import json
import sys

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def load(path: str) -> tuple[dict[str, Array], dict[str, str]]:
    """The tensors of a model file and its metadata."""
    data = open(path, "rb").read()
    length = int.from_bytes(data[:8], "little")
    header = json.loads(data[8 : 8 + length])
    metadata = header.pop("__metadata__", {})
    body = data[8 + length :]
    tensors = {}
    for name, entry in header.items():
        begin, end = entry["data_offsets"]
        tensors[name] = np.frombuffer(body[begin:end], "<f2").reshape(entry["shape"]).astype(float)
    return tensors, metadata


def value(tensors: dict[str, Array], metadata: dict[str, str], wl: Array, wv: Array) -> Array:
    """f_r [1/sr] of an axial model at rows of unit vectors, wl to the light and wv to the viewer: RGB, or a column a wavelength."""
    if metadata["form"] == "reciprocal":  # the mean of an extended sum at both orders of light and viewer
        one = {**metadata, "form": "extended"}
        return (value(tensors, one, wl, wv) + value(tensors, one, wv, wl)) / 2
    h = (wl + wv) / np.linalg.norm(wl + wv, axis=1, keepdims=True)
    psi = tensors["parameterization"][:, 0, None, None] * wl + tensors["parameterization"][:, 1, None, None] * wv
    psi /= np.linalg.norm(psi, axis=2, keepdims=True)  # variates × pairs × 3
    bandwidth = tensors["bandwidth"]
    up = np.where(np.signbit(bandwidth), -1, 1)
    log: Array = np.einsum("jn,jnp->jp", np.abs(bandwidth), up[:, :, None] * psi[None, :, :, 2] - 1)
    if "log_scale" in tensors:
        log += tensors["log_scale"][:, None]
    if metadata["form"] != "source":
        x = [np.log(wl[:, 2]) + np.log(wv[:, 2])]
        if metadata["form"] == "extended":
            sin_h, difference = np.hypot(h[:, 0], h[:, 1]), wl[:, 2] - wv[:, 2]
            x += [np.sum(wl * h, axis=1) - 1, 0.05 - np.sqrt(difference**2 + sin_h**2 / 16 + 0.0025), -sin_h]
        log += tensors["exponent"] @ np.array(x)
    f: Array = np.exp(log).T @ tensors["coefficient"]
    return f


if __name__ == "__main__":
    tensors, metadata = load(sys.argv[1])
    pairs = np.loadtxt(sys.argv[2], delimiter=",", skiprows=1)
    np.savetxt(sys.stdout, value(tensors, metadata, pairs[:, :3], pairs[:, 3:6]), delimiter=",")
