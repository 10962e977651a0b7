"""A leaderboard of models on measurements of your own: ./run leaderboard FILE|FOLDER... [-o FOLDER]

Fits every measurement by each model and writes into FOLDER (build/leaderboard):

results.csv       a row for each material and model
seconds.csv       the seconds of reading and fitting
protocols.csv     with --protocols: the measures of publications, see `protocols`
README.md         tables by database, with picture.svg; a database is a folder that holds measurements

All files but seconds.csv have the same bytes on every machine.

A run continues where the last one into the same FOLDER ended. `./run leaderboard --merge FOLDER... -o FOLDER` makes one leaderboard of
several, for instance of results that others sent. Needs the package `srbf` and NumPy. Further options:

--models NAME...  replaces the models ggx-2 and srbf; an unknown name lists all
--networks FOLDER, --codes FOLDER  published models, see compare_models.py
--protocols       adds the measures of publications for the models of srbf, and takes minutes for each material
--environment FILE  lights the sphere of --protocols, instead of the studio
"""
import argparse
import csv
import os
import statistics
import subprocess
import sys
import tempfile
import time
import zlib

import classic_brdfs
import comparison
import numpy as np
import compare_models
import srbf
import stand_ins
from comparison import models_in, table, text

DEFAULT = ["ggx-2", "srbf"]
NAMES = {name: model.label.strip("*") for name, model in comparison.MODELS.items() if model.label}
COLOURS = ["#c0392b", "#2471a3", "#17a589", "#7d3c98", "#b7950b", "#5d6d7e", "#e67e22", "#1b2631"]
RESULTS = ["database", "material", "model", "payload", "shared", *compare_models.ERRORS]
SECONDS = ["database", "material", "model", "read", "fit"]
PROTOCOLS = ["database", "material", "model", "environment", "sphere_mae", "sphere_psnr", "pairs_mae", "pairs_smape"]
SPHERE, PATHS, PAIRS = 512, 1024, 1_000_000
KEY = ("database", "material", "model")


def measurements(paths):
    """(database, path) of all files, in the order of their names. A database is a folder."""
    found = []
    for path in paths:
        if os.path.isfile(path):
            found.append((os.path.basename(os.path.dirname(os.path.abspath(path))), path))
            continue
        for folder, folders, files in os.walk(path):
            folders.sort()
            database = os.path.basename(os.path.abspath(folder))
            found += [(database, os.path.join(folder, name)) for name in sorted(files)]
    return found


def named(found):
    """(database, name of the material, path): the file's name without its ending, unless two files of a database have the same one."""
    names = [(database, os.path.basename(path).rsplit(".", 1)[0].removesuffix("_rgb")) for database, path in found]
    return [(database, name if names.count((database, name)) == 1 else os.path.basename(path), path)
            for (database, name), (_, path) in zip(names, found)]


def read_rows(path, columns):
    """The rows of a file of an earlier run, by `KEY`."""
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    if any(list(row) != columns for row in rows):
        sys.exit(f"{path}: expected the columns {', '.join(columns)}")
    return {tuple(row[key] for key in KEY): row for row in rows}


def write_rows(path, columns, rows):
    with open(path + ".new", "w", encoding="utf-8", newline="") as file:
        out = csv.DictWriter(file, columns, lineterminator="\n")
        out.writeheader()
        out.writerows(rows[key] for key in sorted(rows))
    os.replace(path + ".new", path)


def models_of(path, arguments):
    """The names of the models that a measurement is fitted by. Published fits are of RGL's files."""
    return arguments.models + (path.endswith("_rgb.bsdf") * (["nbrdf"] * bool(arguments.networks) + ["nps"] * bool(arguments.codes)))


def fitted(model, name, measured, arguments, work):
    """The BRDF or function, its bytes, the bytes that all materials share, and known errors; None if there is no such fit."""
    if model == "nbrdf":
        layers = stand_ins.network_of(arguments.networks, name)
        return layers and (compare_models.network(layers), 4 * 675, 0, None)
    if model == "nps":
        shared = os.path.getsize(os.path.join(arguments.codes, "decoder.f32"))
        return compare_models.decode(arguments.codes, name, work), 4 * 7, shared, None
    if model in classic_brdfs.MODELS:
        return *classic_brdfs.fit(measured, model), 0, None
    fit = srbf.fit(measured, **compare_models.FITS[model])
    return fit.model, fit.model.nbytes, 0, fit.errors


def png_values(path):
    """Display values [height, width, 3] of an 8-bit RGB picture of the program, in [0, 1]."""
    with open(path, "rb") as file:
        content = file.read()
    width, height = (int.from_bytes(content[16 + 4 * i:20 + 4 * i], "big") for i in (0, 1))
    at, packed = 8, b""
    while at < len(content):
        size, kind = int.from_bytes(content[at:at + 4], "big"), content[at + 4:at + 8]
        if kind == b"IDAT":
            packed += content[at + 8:at + 8 + size]
        at += size + 12
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + 3 * width)
    picture = np.zeros((height + 1, width + 1, 3), np.int32)  # has a black column and row before the first
    for y, row in enumerate(rows):
        line, above, current = row[1:].reshape(width, 3).astype(np.int32), picture[y], picture[y + 1]
        if row[0] in (0, 2):
            current[1:] = line + (above[1:] if row[0] == 2 else 0) & 255
            continue
        for x in range(width):
            left, up, corner = current[x], above[x + 1], above[x]
            nearest = [abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)]
            paeth = np.where((nearest[0] <= nearest[1]) & (nearest[0] <= nearest[2]), left, np.where(nearest[1] <= nearest[2], up, corner))
            current[x + 1] = line[x] + {1: left, 3: (left + up) // 2, 4: paeth}[row[0]] & 255
    return picture[1:, 1:] / 255


def protocols(path, measured, brdf, environment, work):
    """The measures of publications. A sphere of 512 x 512 pixels and 1,024 paths under an environment: mean absolute error and PSNR of
    display values, over the pixels that show the sphere. 10⁶ pairs of cosine-weighted directions: mean absolute error of f, and the
    symmetric mean absolute percentage error |f − g| / (f + g)."""
    random = np.random.default_rng(1)

    def directions():
        sine, phi = np.sqrt(random.random(PAIRS)), 2 * np.pi * random.random(PAIRS)
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), np.sqrt(1 - sine * sine)], axis=1).astype(np.float32)

    wl, wv = directions(), directions()
    f, g = (np.asarray(function.eval(wl, wv), float) for function in (measured, brdf))
    model, picture = os.path.join(work, "model.srbf"), os.path.join(work, "pictures.png")
    brdf.save(model)
    subprocess.run([os.environ.get("SRBF", "srbf"), "render", path, model, "-o", picture, "--mesh", "sphere", "--env", environment,
                    "--no-ground",
                    "--no-occlusion", "--size", f"{SPHERE}x{SPHERE}", "--spp", str(PATHS)], check=True, stdout=subprocess.DEVNULL)
    reference, other = np.split(png_values(picture)[:SPHERE], 2, axis=1)  # without the captions below
    at = (np.arange(SPHERE) + 0.5) / SPHERE * 2 - 1
    inside = np.hypot(*np.meshgrid(at, at)) < 0.95
    apart = (reference - other)[inside]
    return {"environment": os.path.basename(environment), "sphere_mae": f"{abs(apart).mean():.6g}",
            "sphere_psnr": f"{-10 * np.log10(max((apart**2).mean(), 1e-12)):.6g}", "pairs_mae": f"{np.nanmean(abs(f - g)):.6g}",
            "pairs_smape": f"{np.nanmean((abs(f - g) / (f + g))[f + g > 0]):.6g}"}


def summary(rows):
    """A row for each model of these results."""
    lines = []
    for model in models_in(rows):
        model_rows = [row for row in rows if row["model"] == model]
        errors = {key: [float(row[key]) for row in model_rows] for key in compare_models.ERRORS}
        shared = int(model_rows[0]["shared"])
        size = text(max(int(row["payload"]) for row in model_rows)) + (f" + {text(shared)} shared" if shared else "")
        seen = errors["delta_e_itp"]
        lines.append([NAMES[model], size, str(len(model_rows)), *map(text, (statistics.fmean(seen), statistics.median(seen), max(seen))),
                      *(text(statistics.fmean(errors[key])) for key in ("worst_delta_e_itp", "flip", "psnr", "rms"))])
    return table(["model", "bytes", "materials", "ΔE_ITP, mean", "median", "worst", "worst light", "ꟻLIP", "PSNR, dB", "RMS"], lines)


def plot(rows):
    """ΔE_ITP of all materials by each model as an SVG: materials in the order of the default's error, errors on a logarithmic axis."""
    models = models_in(rows)
    first = "srbf" if "srbf" in models else models[-1]
    rank = {tuple(row[k] for k in KEY[:2]): float(row["delta_e_itp"]) for row in rows if row["model"] == first}
    order = sorted(rank, key=rank.get)
    width, height, left, top = 760, 360, 50, 20
    step = (width - left - 20) / max(len(order), 1)
    low, high = 0.2, max(50, *(float(row["delta_e_itp"]) for row in rows))

    def y(error):
        return top + (height - top - 30) * (1 - np.log(max(error, low) / low) / np.log(high / low))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height + 20}" font-family="sans-serif" font-size="12">',
           '<rect width="100%" height="100%" fill="white"/>']
    for error in (0.2, 0.5, 1, 2, 5, 10, 20, 50):
        out.append(f'<line x1="{left}" x2="{width - 20}" y1="{y(error):.1f}" y2="{y(error):.1f}" stroke="#ddd"/>'
                   f'<text x="{left - 6}" y="{y(error) + 4:.1f}" text-anchor="end">{error:g}</text>')
    for index, model in enumerate(models):
        colour = COLOURS[index % len(COLOURS)]
        for row in rows:
            material = tuple(row[k] for k in KEY[:2])
            if row["model"] == model and material in rank:
                x, error = left + (order.index(material) + 0.5) * step, float(row["delta_e_itp"])
                out.append(f'<circle cx="{x:.1f}" cy="{y(error):.1f}" r="3" fill="{colour}">'
                           f'<title>{row["material"]}: {text(error)}</title></circle>')
        x = left + index * 150
        out.append(f'<circle cx="{x + 6}" cy="{height + 4}" r="4" fill="{colour}"/>'
                   f'<text x="{x + 16}" y="{height + 8}">{NAMES[model]}</text>')
    out.append(f'<text x="{left}" y="{top - 6}">ΔE_ITP of {len(order)} materials, in the order of {NAMES[first]}</text></svg>')
    return "\n".join(out) + "\n"


def write_page(folder, results, measured):
    rows = list(results.values())
    databases = sorted({row["database"] for row in rows})
    parts = ["# Leaderboard",
             "Every measurement is fitted by each model without options. *ΔE_ITP* is the mean visible error of pictures of a "
             "sphere under eight lightings, and *worst light* that of the worst of them; 1 is just noticeable. PSNR is better if "
             "larger, all others if smaller. *Bytes* are the numbers of one material.",
             "![ΔE_ITP of each material](picture.svg)", summary(rows)]
    if len(databases) > 1:
        for database in databases:
            parts += [f"## {database}", summary([row for row in rows if row["database"] == database])]
    if measured:
        lines = []
        for model in models_in(measured.values()):
            model_rows = [row for row in measured.values() if row["model"] == model]
            means = [text(statistics.fmean(float(row[key]) for row in model_rows)) for key in PROTOCOLS[4:]]
            lines.append([NAMES[model], str(len(model_rows)), *means])
        environments = ", ".join(sorted({row["environment"] for row in measured.values()}))
        parts += ["## By the measures of publications", f"Means. A sphere of {SPHERE} × {SPHERE} pixels and {PATHS:,} paths under "
                  f"{environments}, display values; and {PAIRS:,} pairs of cosine-weighted directions.",
                  table(["model", "materials", "MAE", "PSNR, dB", "MAE of f", "SMAPE of f"], lines)]
    names, errors = models_in(rows), {}
    for row in rows:
        errors.setdefault((row["database"], row["material"]), {})[row["model"]] = text(float(row["delta_e_itp"]))
    lines = [[*material, *(by_model.get(name, "") for name in names)] for material, by_model in sorted(errors.items())]
    parts += ["## Materials", table(["database", "material", *(NAMES[name] for name in names)], lines)]
    with open(os.path.join(folder, "README.md"), "w", encoding="utf-8") as file:
        file.write("\n\n".join(parts) + "\n")
    with open(os.path.join(folder, "picture.svg"), "w", encoding="utf-8") as file:
        file.write(plot(rows))


def main():
    options = argparse.ArgumentParser(prog="./run leaderboard", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("paths", nargs="+", metavar="FILE|FOLDER")
    options.add_argument("-o", "--output", default="build/leaderboard", metavar="FOLDER")
    options.add_argument("--merge", action="store_true")
    options.add_argument("--models", nargs="+", default=DEFAULT, choices=[name for name in NAMES if name in compare_models.MODELS],
                         metavar="NAME")
    options.add_argument("--networks", metavar="FOLDER")
    options.add_argument("--codes", metavar="FOLDER")
    options.add_argument("--protocols", action="store_true")
    options.add_argument("--environment", default="studio", metavar="FILE")
    arguments = options.parse_args()
    folder, columns = arguments.output, {"results.csv": RESULTS, "seconds.csv": SECONDS, "protocols.csv": PROTOCOLS}
    os.makedirs(folder, exist_ok=True)
    tables = {name: read_rows(os.path.join(folder, name), columns[name]) for name in columns}
    results, times, measured_by = tables.values()

    def save():
        for name, rows in tables.items():
            if rows:
                write_rows(os.path.join(folder, name), columns[name], rows)

    if arguments.merge:
        for path in arguments.paths:
            if not os.path.exists(os.path.join(path, "results.csv")):
                sys.exit(f"{path}: expected a folder with results.csv")
            for name, rows in tables.items():
                rows.update(read_rows(os.path.join(path, name), columns[name]))
    found = [] if arguments.merge else named(measurements(arguments.paths))
    if not arguments.merge and not found:
        sys.exit(f"{arguments.paths[0]}: expected measurements")
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as work:
        for index, (database, name, path) in enumerate(found):
            wanted = [model for model in models_of(path, arguments) if (database, name, model) not in results or
                      arguments.protocols and model in compare_models.FITS and (database, name, model) not in measured_by]
            if not wanted:
                continue
            start = time.monotonic()
            try:
                measured = srbf.load_measurement(path)
            except srbf.Error as error:
                print(f"left out: {error}", file=sys.stderr)
                continue
            reading = time.monotonic() - start
            shown = []
            for model in wanted:
                start, key = time.monotonic(), dict(zip(KEY, (database, name, model)))
                fit = fitted(model, name, measured, arguments, work)
                if not fit:
                    continue
                seconds = time.monotonic() - start
                brdf, payload, shared, errors = fit
                errors = errors or srbf.errors(measured, brdf, max_theta=compare_models.MAX_THETA)
                results[tuple(key.values())] = {**key, "payload": str(payload), "shared": str(shared),
                                                **{error: f"{errors[error]:.6g}" for error in compare_models.ERRORS}}
                times[tuple(key.values())] = {**key, "read": f"{reading:.2f}", "fit": f"{seconds:.2f}"}
                if arguments.protocols and isinstance(brdf, srbf.Model):
                    measured_by[tuple(key.values())] = {**key, **protocols(path, measured, brdf, arguments.environment, work)}
                shown.append(f"{NAMES[model]} {text(errors['delta_e_itp'])}")
            save()
            left = (time.monotonic() - begun) / (index + 1) * (len(found) - index - 1)
            print(f"{index + 1}/{len(found)}  {name}: ΔE_ITP {', '.join(shown)}; {left / 60:.0f} min left", file=sys.stderr)
    if not results:
        sys.exit("no measurement could be read")
    save()
    write_page(folder, results, measured_by)
    print(f"{folder}/README.md")


if __name__ == "__main__":
    main()
