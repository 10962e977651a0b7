"""Prints hashes of what the package computes from a bundled measurement. They are the same on every processor.

`./run wheel aarch64` runs `same_bytes.py DATA` on this machine and on an emulated one, and compares the output.
"""
import hashlib
import pathlib
import sys
import tempfile

import numpy as np
import srbf


def directions(seed: int) -> np.ndarray:
    """Unit vectors from operations whose results IEEE 754 defines to the bit, unlike numpy's functions."""
    random = np.random.default_rng(seed)
    w = random.integers(-1000, 1000, (1000, 3)).astype(np.float64)
    w[:, 2] = np.abs(w[:, 2]) + 50
    return (w / np.sqrt(w[:, 0] * w[:, 0] + w[:, 1] * w[:, 1] + w[:, 2] * w[:, 2])[:, None]).astype(np.float32)


def say(what: str, data: bytes) -> None:
    print(what, hashlib.sha256(data).hexdigest())


paper = srbf.load(pathlib.Path(sys.argv[1]) / "paper_white_rgb.bsdf")
wl, wv = directions(1), directions(2)
say("the measurement's values", paper.eval(wl, wv).tobytes())
for kind, options in (("ggx", {"model": "ggx", "lobes": 1, "objective": "raw"}),
                      ("pm", {"lobes": 2, "variates": 2, "objective": "cosine"})):
    model = srbf.fit(paper, **options).model
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "model.srbf"
        model.save(path)
        again = srbf.load_model(path)
    say(kind + ", parameters", b"".join(np.ascontiguousarray(again.parameters[name]).tobytes() for name in sorted(again.parameters)))
    say(kind + ", values", again.eval(wl, wv).tobytes())
