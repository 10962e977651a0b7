"""Writes docs/comparison.csv:

python3 paper/compare_models.py FILE... [--networks FOLDER] [--codes FOLDER] [--tables FOLDER] > docs/comparison.csv

Fits each measurement by each model, and compares them by the same measures. Needs the package `srbf`
(PYTHONPATH=build/release/python) and NumPy. classic_brdfs.py fits `abc`; to RGL's files it also fits small networks, and
fitted_to_pictures.py models of several sizes. For two published models the authors' fits are read, for the materials that they have:

--networks FOLDER  networks of layers 6, 21, 21, 3 (Sztrajman, Rainer, Ritschel, Weyrich: Neural BRDF Representation
                   and Importance Sampling, 2021), in files that stand_ins.py describes: `nbrdf` as published, and
                   `nbrdf-16` rounded to 16-bit floats
--file-order       gives these networks light and viewer in the order of RGL's files, which is not that of their training
--codes FOLDER     decoder.f32 and latents.txt: seven numbers for each material, and a shared decoder (Zheng, Zheng,
                   Wang, Zhao, Bao: A Compact Representation of Measured BRDFs Using Neural Processes, 2021)
--tables FOLDER    tables of MERL's layout: of RGL's files rows of their principal components, by principal_components.py

convert_networks.py converts the authors' files to these. comparison_steps.sh has all steps.
"""
import argparse
import csv
import os
import sys
import tempfile

import classic_brdfs
import fitted_to_pictures
import numpy as np
import principal_components
import srbf
import stand_ins

FITS = {  # options of srbf.fit
    "ggx": {"model": "ggx"},
    "ggx-2": {"model": "ggx", "lobes": 2},
    "openpbr": {"model": "openpbr"},
    "srbf-4": {"lobes": 4},
    "srbf": {},
    "srbf-16": {"lobes": 16},
    "as-measured-4": {"as_measured": True, "lobes": 4},
    "as-measured-8": {"as_measured": True},
    "as-measured-12": {"as_measured": True, "lobes": 12},
    "as-measured-16": {"as_measured": True, "lobes": 16},
    "cosine": {"as_measured": True, "objective": "cosine"},
    "log": {"as_measured": True, "objective": "log"},
    "cube-root": {"as_measured": True, "objective": "cube-root"},
    "su": {"model": "su", "lobes": 5},
}
# Models that are fitted to RGL's files alone.
SIZED = {f"srbf-{lobes}": {"lobes": lobes} for lobes in (1, 2, 6, 32)}
COMPONENTS = (4, 8, 16)
RGL_ONLY = {*SIZED, *classic_brdfs.MODELS, *fitted_to_pictures.MODELS} - {"abc"}
MODELS = [*FITS, *classic_brdfs.MODELS, *SIZED, *fitted_to_pictures.MODELS]
KINDS = {  # names of materials
    "metal": "alum-bronze brass chrome-steel gold-metallic-paint3 grease-covered-steel nickel ilm_l3_37_metallic "
             "two-layer-silver",
    "paint": "blue-metallic-paint color-changing-paint2 dark-red-paint purple-paint silver-metallic-paint "
             "irid_flake_paint1 aurora_white",
    "plastic": "black-soft-plastic green-plastic nylon polyethylene red-plastic specular-green-phenolic specular-red-phenolic "
               "specular-yellow-phenolic teflon white-acrylic yellow-matte-plastic yellow-plastic green-latex spectralon",
    "fabric": "light-brown-fabric pink-felt red-fabric2 white-fabric2 acrylic_felt_green satin_blue",
    "film": "cc_ibiza_sunset cc_amber_citrine cg_sunflower chm_mint cm_toxic_green vch_golden_yellow "
            "vch_frozen_amethyst vch_ultra_pink",
    "wood, stone, paper": "aventurnine black-obsidian fruitwood-241 natural-209 pickled-oak-260 special-walnut-224 "
                          "cardboard leaf_maple paper_red paper_white colodur_napoli_4f",
}
KIND_OF = {material: kind for kind, materials in KINDS.items() for material in materials.split()}
ERRORS = ["delta_e_itp", "worst_delta_e_itp", "flip", "psnr", "rms"]
HELD_OUT = ["heldout_squared_error_ratio_cosine", "heldout_cube_root_error_ratio", "albedo_error"]
MAX_THETA = 80  # [degrees], for held-out pairs


def half_and_difference(wl, wv):
    """The half vector rotated to azimuth 0, and the light in its frame, for n pairs: two arrays [n, 3]."""
    half = wl + wv
    half /= np.maximum(np.linalg.norm(half, axis=1, keepdims=True), 1e-12)
    sine = np.hypot(half[:, 0], half[:, 1])
    azimuth = np.arctan2(half[:, 1], half[:, 0])
    x = np.cos(azimuth) * wl[:, 0] + np.sin(azimuth) * wl[:, 1]
    y = -np.sin(azimuth) * wl[:, 0] + np.cos(azimuth) * wl[:, 1]
    difference = np.stack([half[:, 2] * x - sine * wl[:, 2], y, sine * x + half[:, 2] * wl[:, 2]], axis=1)
    return np.stack([sine, np.zeros_like(sine), half[:, 2]], axis=1), difference


def network(layers, file_order=False):
    """A material's network as f(wl, wv). The authors took the first direction of RGL's files, the light, as the viewer."""
    def value(wl, wv):
        first, second = (wl, wv) if file_order else (wv, wl)
        return stand_ins.network_value(layers, *half_and_difference(first.astype(float), second.astype(float)))

    return value


def decode(folder, name, work):
    """A material's code as f(wl, wv). The decoder gives a table of MERL's layout, with f (cosθl + cosθv) / 2."""
    with open(os.path.join(folder, "latents.txt"), encoding="ascii") as file:
        codes = {key: np.array(code, np.float32) for key, *code in map(str.split, file)}
    numbers = np.fromfile(os.path.join(folder, "decoder.f32"), np.float32)
    layers = []
    for inputs, outputs in [(11, 400)] + [(400, 400)] * 5 + [(400, 3)]:
        weights, offsets, numbers = np.split(numbers, [inputs * outputs, (inputs + 1) * outputs])
        layers.append((weights.reshape(inputs, outputs), offsets))
    phi, theta = np.pi * np.arange(180) / 180, np.arange(90) / 90
    table = np.empty((3, 90, 90, 180))
    for row in range(90):
        x = np.empty((90, 180, 11), np.float32)
        x[..., 0], x[..., 1] = 0.5 + 0.5 * np.cos(2 * phi), 0.5 + 0.5 * np.sin(2 * phi)
        x[..., 2], x[..., 3], x[..., 4:] = (row / 90) ** 2, theta[:, None], codes[name]
        x = x.reshape(-1, 11)
        for matrix, offset in layers:
            x = np.maximum(x @ matrix + offset, 0)
        y = 0.15 * x.astype(float)
        for _ in range(4):
            y = np.expm1(y)
        table[:, row] = y.T.reshape(3, 90, 180)
    path = os.path.join(work, name + ".binary")
    with open(path, "wb") as file:
        file.write(np.array([90, 90, 180], np.int32).tobytes())
        file.write((table * np.array([1500, 1500 / 1.15, 1500 / 1.66])[:, None, None, None]).tobytes())
    nodes = srbf.load_measurement(path)
    return lambda wl, wv: nodes.eval(wl, wv) * (2 / (wl[:, 2] + wv[:, 2]))[:, None]


def symmetric_error(measured, other, count=100_000):
    """The mean of |f - g| / (f + g) over pairs of uniform solid angle and over channels, where f or g is not 0."""
    random = np.random.default_rng(1)

    def directions():
        z, phi = 1 - random.random(count) * (1 - np.cos(np.radians(MAX_THETA))), 2 * np.pi * random.random(count)
        return np.stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z], axis=1).astype(np.float32)

    wl, wv = directions(), directions()
    f, g = measured.eval(wl, wv).astype(float), np.asarray(other(wl, wv), float)
    return float(np.nanmean((abs(f - g) / (f + g))[f + g > 0]))


def rows_of(path, models, networks, file_order, codes, components, work):
    measured = srbf.load_measurement(path)
    name = os.path.basename(path).rsplit(".", 1)[0].removesuffix("_rgb")
    kind = KIND_OF.get(name, "other")

    def row(model, brdf, function, payload, shared=0):
        errors = srbf.errors(measured, brdf, max_theta=MAX_THETA)
        numbers = [errors[key] for key in ERRORS]
        numbers += [symmetric_error(measured, function)] + [errors[key] for key in HELD_OUT]
        return [name, kind, model, payload, shared] + [f"{number:.6g}" for number in numbers]

    is_rgl_file = path.endswith("_rgb.bsdf")
    for model in models:
        options = {**FITS, **SIZED}.get(model)
        if not is_rgl_file and model in RGL_ONLY:
            continue
        if options is None:
            value, payload = (fitted_to_pictures if model in fitted_to_pictures.MODELS else classic_brdfs).fit(measured, model)
            yield row(model, value, value, payload)
            continue
        fitted = srbf.fit(measured, **options).model
        yield row(model, fitted, fitted.eval, fitted.nbytes)
    for count in COMPONENTS if components and is_rgl_file else ():
        table = os.path.join(work, "table.binary")
        sizes = components.fit(measured, count, table)
        value = srbf.load_measurement(table)
        yield row(f"pca-{count}", value, value.eval, *sizes)
    layers = networks and is_rgl_file and stand_ins.network_of(networks, name)
    if layers:
        for model, numbers, size in (("nbrdf", layers, 4), ("nbrdf-16", stand_ins.rounded(layers), 2)):
            value = network(numbers, file_order)
            yield row(model, value, value, size * 675)
    if codes and is_rgl_file:
        value = decode(codes, name, work)
        yield row("nps", value, value, 4 * 7, os.path.getsize(os.path.join(codes, "decoder.f32")))


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("files", nargs="+", metavar="FILE")
    options.add_argument("--models", nargs="*", default=MODELS, choices=MODELS, metavar="NAME",
                         help="instead of all: " + " ".join(MODELS))
    options.add_argument("--networks", metavar="FOLDER")
    options.add_argument("--file-order", action="store_true")
    options.add_argument("--codes", metavar="FOLDER")
    options.add_argument("--tables", metavar="FOLDER")
    arguments = options.parse_args()
    out = csv.writer(sys.stdout, lineterminator="\n")
    out.writerow(["material", "kind", "model", "payload", "shared"] + ERRORS + ["symmetric_error"] + HELD_OUT)
    components = arguments.tables and principal_components.PrincipalComponents(arguments.tables)
    with tempfile.TemporaryDirectory() as work:
        for path in arguments.files:
            out.writerows(rows_of(path, arguments.models, arguments.networks, arguments.file_order, arguments.codes, components, work))
            sys.stdout.flush()


if __name__ == "__main__":
    main()
