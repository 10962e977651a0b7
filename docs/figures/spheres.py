"""Two pictures of spheres as the visible error compares them, at the exposure of the measurement. They need the package srbf and NumPy:

PYTHONPATH=build/release/python python3 docs/figures/spheres.py lights docs/lights.jpg
    The bundled paper and film with fits of them under the eight lights; a number is ΔE_ITP of a picture against the one of the measurement.
PYTHONPATH=build/release/python python3 docs/figures/spheres.py models docs/models.jpg RGL NETWORKS
    Four files of the folder RGL and models of them under the light `studio`; a number is the mean ΔE_ITP of the eight lights. In the second
    row the film is under `flash`, and a number is the ΔE_ITP of this light. NETWORKS is the folder of networks that paper/compare_models.py
    takes.
"""
import base64
import os
import sys
import tempfile

import numpy as np
import srbf

from clone import ROOT
from support import chromium
import compare_models
import stand_ins

STYLE = """body {{ margin: 0; background: #fff; color: #222; font: 14px DejaVu Sans, sans-serif }} div {{ display: flex; align-items: center }}
    p {{ width: {0}px; margin: 0; padding-left: 8px; box-sizing: border-box; line-height: 1.35 }} b {{ width: {1}px; text-align: center; font-weight:
    normal; padding: 6px 0 }} figure {{ margin: 0; width: {1}px; text-align: center; padding-bottom: 5px }} img {{ display: block; margin: 0 auto }}"""


def table_of(function, path, polar=180, azimuths=361):
    """Writes f(wl, wv) of an isotropic material as a table in MBSDF's layout."""
    theta, phi = np.arange(polar) / polar * np.pi / 2, np.arange(azimuths) / (azimuths - 1) * np.pi
    view, azimuth = (angles.ravel() for angles in np.meshgrid(theta, phi, indexing="ij"))
    wv = np.stack([np.sin(view) * np.cos(azimuth), np.sin(view) * np.sin(azimuth), np.cos(view)], axis=1)
    with open(path, "wb") as file:
        file.write(b"NVIDIA ARC MBSDF V1\nMBSDF_DATA_REFLECTION=\n" + np.array([1, polar, azimuths], np.uint32).tobytes())
        for light in theta:
            wl = np.broadcast_to([np.sin(light), 0, np.cos(light)], wv.shape)
            file.write(function(wl, wv).astype(np.float32).tobytes())


def sphere(brdf, measured, light, size):
    """Returns a picture of `brdf` as HTML, twice as large as it is shown. The exposure sets the 90th percentile of the measured picture to
    3/4 of white."""
    reference = srbf.render(measured, light, 2 * size).max(axis=2)
    picture = srbf.render(brdf, light, 2 * size) * 0.75 / np.quantile(reference[reference > 0], 0.9)
    return f'<img width={size} src="data:image/png;base64,{base64.b64encode(srbf.png(picture)).decode()}">'


def grid(heads, rows, head, column, out):
    lines = "".join(f"<div><p>{name}</p>" + "".join(f"<figure>{cell}</figure>" for cell in cells) + "</div>" for name, cells in rows)
    page = f"<style>{STYLE.format(head, column)}</style><div><p></p>" + "".join(f"<b>{name}</b>" for name in heads) + f"</div>{lines}"
    chromium.picture(page, head + column * len(heads), out)


def lights(out):
    rows = []
    lobes, ggx = ("nine lobes", {}), ("two GGX", {"model": "ggx", "lobes": 2})
    for name, stem, fits in (("white paper", "paper_white", [lobes]), ("vinyl film", "cc_ibiza_sunset", [lobes, ggx])):
        measured = srbf.load_measurement(os.path.join(ROOT, "data", stem + "_rgb.bsdf"))
        rows.append((f"{name},<br>measured", [sphere(measured, measured, light, 78) for light in srbf.lightings()]))
        for label, options in fits:
            model = srbf.fit(measured, **options).model
            errors = srbf.errors(measured, model)
            rows.append((f"{label}<br>mean {errors['delta_e_itp']:.1f}",
                         [sphere(model, measured, light, 78) + f"{errors['lightings'][light]['delta_e_itp']:.1f}"
                          for light in srbf.lightings()]))
    grid(srbf.lightings(), rows, 110, 88, out)


MODELS = {"two GGX, 26 bytes": {"model": "ggx", "lobes": 2}, "OpenPBR, 54": {"model": "openpbr"}, "nine lobes, 210": {}}


def models(out, rgl, networks):
    rows = []

    def row(name, light, measured, drawn, numbers):
        cells = [f"{sphere(brdf, measured, light, 140)}{number:.1f}" for brdf, number in zip(drawn, numbers)]
        rows.append((name, [sphere(measured, measured, light, 140) + "&nbsp;"] + cells))

    for stem in ("cc_ibiza_sunset", "vch_golden_yellow", "cg_sunflower", "paper_white"):
        measured = srbf.load_measurement(os.path.join(rgl, stem + "_rgb.bsdf"))
        shown = [srbf.fit(measured, **options).model for options in MODELS.values()]
        network = compare_models.network(stand_ins.rounded(stand_ins.network_of(networks, stem)))
        errors = [srbf.errors(measured, brdf) for brdf in [*shown, network]]
        name = stem.replace("_", "<br>", 1).replace("_", " ")
        with tempfile.TemporaryDirectory() as work:
            table = os.path.join(work, "network.mbsdf")
            table_of(network, table)
            drawn = [*shown, srbf.load_measurement(table)]
            row(name, "studio", measured, drawn, [error["delta_e_itp"] for error in errors])
            if stem == "cc_ibiza_sunset":
                row(name + "<br><i>flash</i>", "flash", measured, drawn, [error["lightings"]["flash"]["delta_e_itp"] for error in errors])
    grid(["measured", *MODELS, "NBRDF, 1,350"], rows, 90, 160, out)


{"lights": lights, "models": models}[sys.argv[1]](*sys.argv[2:])
