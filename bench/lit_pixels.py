"""Visible errors over lit pixels alone, beside those over the whole sphere: PYTHONPATH=build/release/python python3 bench/lit_pixels.py RGL NETWORKS

RGL has the five measurements, and NETWORKS is the folder of their networks that bench/rivals.py takes. The error of each light is divided by the share
of the sphere that it lights in the picture of the measurement. Prints a row a model: means over the files, and those of the film.
"""
import os
import statistics
import sys

import numpy as np
import rivals
import srbf
import stand_ins

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "docs", "figures"))
from comparison import MEASURED  # noqa: E402

FITS = {"Lambert, 2 GGX": {"model": "ggx", "lobes": 2}, "OpenPBR": {"model": "openpbr"}, "srbf, 9 lobes": {}, "8 lobes, not reciprocal": {"as_measured": True}}


def lit_shares(measured, size=64):
    """Of the pixels of the sphere's disc, those with light, by the name of the light."""
    y, x = (np.indices((size, size)) + 0.5) * 2 / size - 1
    disc = x * x + y * y < 1
    return {light: (srbf.render(measured, light, size)[disc] > 0).any(axis=1).mean() for light in srbf.lightings()}


def main():
    rgl, networks = sys.argv[1:]
    rows = {}
    for name in MEASURED:
        measured = srbf.load_measurement(f"{rgl}/{name}_rgb.bsdf")
        models = {model: srbf.fit(measured, **options).model for model, options in FITS.items()}
        models["NBRDF"] = rivals.network(stand_ins.network_of(networks, name))
        shares = lit_shares(measured)
        for model, brdf in models.items():
            errors = srbf.errors(measured, brdf)["lightings"]
            whole = [errors[light]["delta_e_itp"] for light in shares]
            rows.setdefault(model, []).append((np.mean(whole), np.mean([error / shares[light] for error, light in zip(whole, shares)])))
    print("| model | whole sphere | lit pixels | film: whole sphere | lit pixels |\n|---|---|---|---|---|")
    for model, values in rows.items():
        numbers = [*(statistics.fmean(column) for column in zip(*values)), *values[0]]
        print(f"| {model} | " + " | ".join(f"{number:.2f}" for number in numbers) + " |")


main()
