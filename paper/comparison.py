"""python3 paper/comparison.py [--check]: makes the tables and the plot of docs/comparison.md, and a table each of docs/accuracy.md,
docs/choosing.md and docs/paper.md, from docs/comparison.csv and docs/further_tables.csv.

Writes docs/comparison.svg, and the tables of the pages after `<!-- NAME -->`. With --check nothing is written;
the exit status is 1 if a page has other numbers.
"""
import csv
import math
import os
import statistics
import sys
import typing

HERE = os.path.dirname(os.path.abspath(__file__))
CSV, FURTHER, PAGE, PLOT, ACCURACY, CHOOSING, PAPER = (os.path.join(HERE, "..", "docs", name) for name in (
    "comparison.csv", "further_tables.csv", "comparison.md", "comparison.svg", "accuracy.md", "choosing.md", "paper.md"))


class Model(typing.NamedTuple):
    curve: str | None  # in the plot
    label: str | None = None  # of its rows and columns; None if only some tables have the model, under labels of their own
    by_material: bool = False  # it is in the tables by file and by kind
    measured_only: bool = False  # it has rows for the measurements alone


def sized(curve, name, sizes):
    """Models of several sizes, which have rows for the measurements alone."""
    return {name.format(size): Model(curve, measured_only=True) for size in sizes}


# All models, in the order of columns.
MODELS = {
    "ggx": Model("GGX", "Lambert, 1 GGX"),
    "ggx-2": Model("GGX", "Lambert, 2 GGX", by_material=True),
    "abc": Model("ABC", "ABC, our fit ‡"),
    "openpbr": Model("OpenPBR", "OpenPBR", by_material=True),
    "nbrdf": Model(None, "NBRDF, 32-bit floats", by_material=True, measured_only=True),
    "nps": Model("neural process", "neural process", by_material=True, measured_only=True),
    "srbf-4": Model("srbf", "srbf, 4 lobes", by_material=True),
    "srbf": Model("srbf", "srbf, 9 lobes", by_material=True),
    "srbf-16": Model("srbf", "srbf, 16 lobes", by_material=True),
    "as-measured-8": Model("as measured", "8 lobes, not reciprocal", by_material=True),
    "su": Model("view by view", "view by view, 5 lobes"),
    **sized("srbf", "srbf-{}", (1, 2, 6, 32)),
    **sized("GTR lobes", "gtr-{}-pictures", (1, 2, 3, 6)),
    **sized("cosine lobes", "lafortune-{}-pictures", (1, 3, 8)),
    **sized("small network", "network-{}-pictures", (2, 4, 6, 9)),
    **sized("small network, ∛f", "network-{}", (4, 6)),
    **sized("principal components", "pca-{}", (4, 8, 16)),
    "nbrdf-16": Model("NBRDF", measured_only=True),
    **{f"as-measured-{lobes}": Model("as measured") for lobes in (4, 12, 16)},
    "cosine": Model(None),
    "log": Model(None),
    "cube-root": Model("as measured, ∛f"),
}
# The losses that models minimise: pixels of pictures and values, errors of cube roots, or another loss of values.
PIXELS, CUBE_ROOTS = "minimises pixels of pictures and values", "minimises errors of cube roots"
VALUES = "minimises another loss of values"
# The colour and the loss of each curve.
CURVES = {"srbf": ("#c0392b", PIXELS), "as measured": ("#e59866", PIXELS), "as measured, ∛f": ("#e59866", CUBE_ROOTS),
          "view by view": ("#e08e0b", VALUES), "GGX": ("#2471a3", PIXELS), "OpenPBR": ("#17a589", PIXELS), "ABC": ("#b7950b", CUBE_ROOTS),
          "NBRDF": ("#7d3c98", VALUES), "neural process": ("#5d6d7e", VALUES), "GTR lobes": ("#5dade2", PIXELS),
          "cosine lobes": ("#52be80", PIXELS), "small network": ("#a569bd", PIXELS), "small network, ∛f": ("#a569bd", CUBE_ROOTS),
          "principal components": ("#7f8c8d", VALUES)}
# Curves of models whose materials share further numbers.
SHARING_CURVES = {"neural process", "principal components"}
# The measurements and their short names.
MEASURED = {"cc_ibiza_sunset": "film", "cg_sunflower": "sunflower", "colodur_napoli_4f": "napoli", "paper_white": "paper",
            "vch_golden_yellow": "yellow"}
COLUMNS = ["delta_e_itp", "worst_delta_e_itp", "flip", "psnr", "rms", "symmetric_error", "albedo_error"]
MEASURES = {"delta_e_itp": "ΔE_ITP, mean", "worst_delta_e_itp": "ΔE_ITP, worst light", "flip": "ꟻLIP", "psnr": "PSNR", "rms": "RMS",
            "symmetric_error": "relative", "albedo_error": "albedo", "heldout_squared_error_ratio_cosine": "squared error of f cosθl",
            "heldout_cube_root_error_ratio": "cube roots"}


def read(path=CSV):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        for key in row.keys() - {"material", "kind", "model"}:
            row[key] = float(row[key])
    return rows


def text(value):
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def table(heads, lines):
    return "\n".join("| " + " | ".join(line) + " |" for line in [heads, ["---"] * len(heads), *lines])


def rows_of_model(rows, model):
    return [row for row in rows if row["model"] == model]


def measured_rows(rows):
    return [row for row in rows if row["material"] in MEASURED]


def rows_of_all_materials(rows):
    """The rows without those of models that have rows for the measurements alone."""
    return [row for row in rows if not MODELS[row["model"]].measured_only]


def models_in(rows):
    """The models with a label that have rows, in the order of columns."""
    present = {row["model"] for row in rows}
    return [model for model in MODELS if model in present and MODELS[model].label]


def mean(rows, key):
    return statistics.fmean(row[key] for row in rows)


def marked(model, name):
    """The name, with a dagger if the model's loss has pixels of pictures."""
    return name + (" †" if model.endswith("-pictures") or model.startswith(("srbf", "as-measured", "ggx", "openpbr")) else "")


def bold_if_equal(value, best):
    """The text of a value, which is bold if it is that of the best value."""
    return f"**{text(value)}**" if text(value) == text(best) else text(value)


def with_bold_best(names, values, largest=frozenset()):
    """Lines of names and texts of values; the least value of each column is bold, or the largest of columns in `largest`."""
    best = [(max if i in largest else min)(column) for i, column in enumerate(zip(*values))]
    return [cells + list(map(bold_if_equal, row, best)) for cells, row in zip(names, values)]


def with_bold_least(values):
    """Texts of a row of values, of which the least is bold."""
    return [bold_if_equal(value, min(values)) for value in values]


MEANS_EXTRA_LABELS = {"network-6-pictures": "small network, 6 neurons", "as-measured-16": "16 lobes, not reciprocal",
                      "nbrdf-16": "NBRDF, rounded to 16-bit floats"}


def means_table(rows):
    """A row for each model, in order of bytes: its bytes and mean errors."""
    names, values = [], []
    by_model = {model: rows_of_model(rows, model) for model in [*models_in(rows), *MEANS_EXTRA_LABELS]}
    for model in sorted(by_model, key=lambda model: max(row["payload"] + row["shared"] for row in by_model[model])):
        shared = f" + {text(by_model[model][0]['shared'])} shared" if by_model[model][0]["shared"] else ""
        payload = text(max(row["payload"] for row in by_model[model]))
        names.append([marked(model, MEANS_EXTRA_LABELS.get(model) or MODELS[model].label), payload + shared])
        values.append([mean(by_model[model], key) for key in COLUMNS])
    return table(["model", "bytes", "ΔE_ITP", "worst light", "ꟻLIP", "PSNR, dB", "RMS", "relative", "albedo"],
                 with_bold_best(names, values, {COLUMNS.index("psnr")}))


def kinds_table(rows):
    models = [model for model in models_in(rows) if MODELS[model].by_material]
    lines = []
    for kind in [*sorted({row["kind"] for row in rows}), "all"]:
        kind_rows = [row for row in rows if kind in (row["kind"], "all")]
        errors = [mean(rows_of_model(kind_rows, model), "delta_e_itp") for model in models]
        default = [row["delta_e_itp"] for row in rows_of_model(kind_rows, "srbf")]
        lines.append([kind, str(len(default))] + with_bold_least(errors) + [text(min(default)), text(max(default))])
    medians = [statistics.median(row["delta_e_itp"] for row in rows_of_model(rows, model)) for model in models]
    lines.append(["median of all", ""] + with_bold_least(medians) + ["", ""])
    return table(["kind", "materials"] + [MODELS[model].label for model in models] + ["9 lobes, least", "9 lobes, largest"], lines)


MEASURED_EXTRA_LABELS = {"network-6-pictures": "small network, 186 bytes", "as-measured-16": "16 lobes, not reciprocal"}


def measured_table(rows):
    """ΔE_ITP of each measurement by all models."""
    names = {**{model: MODELS[model].label for model in models_in(rows) if MODELS[model].by_material}, **MEASURED_EXTRA_LABELS}
    lines = []
    for material in MEASURED:
        by_model = {row["model"]: row for row in rows if row["material"] == material}
        lines.append([material] + with_bold_least([by_model[model]["delta_e_itp"] for model in names]))
    return table(["measurement", *names.values()], lines)


EQUAL_BYTES_LABELS = {"srbf-4": "srbf, 4 lobes", "gtr-6-pictures": "6 GTR lobes", "lafortune-8-pictures": "8 cosine lobes",
                      "network-4-pictures": "small network, 4 neurons", "srbf-6": "srbf, 6 lobes",
                      "network-6-pictures": "small network, 6 neurons", "network-6": "the same, ∛f",
                      "srbf": "srbf, 9 lobes", "network-9-pictures": "small network, 9 neurons", "nbrdf-16": "NBRDF, rounded"}


def equal_bytes_table(rows):
    """Means of all measures for models of similar sizes, and the median of squared errors, whose mean one file determines."""
    names, values = [], []
    for model, name in EQUAL_BYTES_LABELS.items():
        model_rows = rows_of_model(rows, model)
        names.append([marked(model, name), text(model_rows[0]["payload"])])
        squared_errors = [row["heldout_squared_error_ratio_cosine"] for row in model_rows]
        values.append([mean(model_rows, key) for key in MEASURES] + [statistics.median(squared_errors)])
    return table(["model", "bytes", *MEASURES.values(), "squared error, median"],
                 with_bold_best(names, values, {list(MEASURES).index("psnr")}))


MEASURES_LABELS = {"nbrdf": "NBRDF, 32-bit floats", "nps": "neural process", "network-6-pictures": "small network, 186 bytes"}


def measures_table(rows):
    """Lists, for each measure, the measurements on which a network has a smaller error than the default."""
    lines = []
    for key, name in MEASURES.items():
        sign = -1 if key == "psnr" else 1
        cells = []
        for model in MEASURES_LABELS:
            default, other = ({row["material"]: sign * row[key] for row in rows_of_model(rows, compared)}
                              for compared in ("srbf", model))
            smaller = [material for material in MEASURED if other[material] < default[material]]
            names = ", ".join(MEASURED[material] for material in smaller) or "none"
            cells.append("all five" if len(smaller) == len(MEASURED) else names)
        lines.append([name] + cells)
    return table(["measure", *MEASURES_LABELS.values()], lines)


NETWORKS_LABELS = {"nbrdf-16": "NBRDF, 1,350 bytes", "srbf": "nine lobes, 210 bytes", "network-6-pictures": "network, 186 bytes"}


def networks_table(rows):
    """Means of the default and of networks, and in brackets their means without the film. The best are bold."""
    models = NETWORKS_LABELS

    def means_of(rows):
        values = [[mean(rows_of_model(rows, model), key) for key in COLUMNS] for model in models]
        return with_bold_best([[]] * len(models), values, {COLUMNS.index("psnr")})

    without_film = means_of([row for row in rows if row["material"] != "cc_ibiza_sunset"])
    lines = [[name] + [f"{of_all} ({of_others})" for of_all, of_others in zip(line, other)]
             for name, line, other in zip(models.values(), means_of(rows), without_film)]
    return table(["model", "ΔE_ITP", "worst light", "ꟻLIP", "PSNR, dB", "RMS of radiance", "relative error", "albedo error"], lines)


OPTION_LABELS = {"srbf": "**none**", "as-measured-8": "`--as-measured`",
                 "cosine": "`--as-measured --objective cosine`", "log": "`--as-measured --objective log`",
                 "cube-root": "`--as-measured --objective cube-root`", "su": "`--model su --lobes 5`"}


def options_table(rows):
    """Errors of the program's options on the five measurements and on all materials."""
    lines = []
    for model, name in OPTION_LABELS.items():
        model_rows = rows_of_model(rows, model)
        columns = ["delta_e_itp", "flip", "psnr", "rms", "heldout_squared_error_ratio_cosine", "heldout_cube_root_error_ratio",
                   "albedo_error"]
        percent = {"heldout_squared_error_ratio_cosine", "heldout_cube_root_error_ratio", "albedo_error"}
        lines.append([name, text(max(row["payload"] for row in model_rows)), text(mean(measured_rows(model_rows), "delta_e_itp"))]
                     + [text(mean(model_rows, key) * (100 if key in percent else 1)) for key in columns])
    return table(["options", "bytes", "ΔE_ITP, five", "ΔE_ITP, all", "ꟻLIP", "PSNR, dB", "RMS", "f cosθl ≤ 80°, %",
                  "cube root ≤ 80°, %", "albedo ≤ 80°, %"], lines)


SIZE_LABELS = {"ggx-2": "Lambert and two GGX lobes", "openpbr": "parameters of OpenPBR", "srbf-4": "4 lobes", "srbf": "**9 lobes**",
               "srbf-16": "16 lobes",
               "as-measured-8": "8 lobes, not reciprocal", "as-measured-16": "16 lobes, not reciprocal"}


def sizes_table(rows):
    """ΔE_ITP by size, for all materials and for the five measurements."""
    lines = []
    for model, name in SIZE_LABELS.items():
        model_rows = rows_of_model(rows, model)
        errors = [row["delta_e_itp"] for row in model_rows]
        lines.append([name, text(max(row["payload"] for row in model_rows))]
                     + [text(value) for value in (statistics.fmean(errors), statistics.median(errors), max(errors),
                                                  mean(measured_rows(model_rows), "delta_e_itp"))])
    return table(["model", "bytes", "mean", "median", "largest", "mean of the five measurements"], lines)


def stand_ins_table(rows):
    """Errors of the default and of fits as measured on the stand-ins, which are reciprocal."""
    rest = [row for row in rows if row["material"] not in MEASURED]
    default, other = ({row["material"]: row["delta_e_itp"] for row in rows_of_model(rest, model)}
                      for model in ("srbf", "as-measured-8"))
    lines = []
    for model, errors, against in (("srbf", default, other), ("as-measured-8", other, default)):
        larger = [material for material in sorted(errors) if errors[material] > 1.1 * against[material]]
        names = "".join(f", {material} ({text(errors[material])} and {text(against[material])})"
                        for material in larger) if model == "srbf" else ""
        lines.append([MODELS[model].label, text(statistics.fmean(errors.values())), text(statistics.median(errors.values())),
                      str(sum(errors[material] < against[material] for material in errors)),
                      str(len(larger)) + names.replace(", ", ": ", 1)])
    return table(["model", "mean of the stand-ins", "median", "smaller error on", "larger by more than a tenth on"], lines)


def further_table(rows):
    """Errors on the tables by which no constant was chosen."""
    errors = {model: sorted(row["delta_e_itp"] for row in rows_of_model(rows, model)) for model in models_in(rows)}
    lines = []
    for model, values in errors.items():
        measures = (statistics.fmean(values), statistics.median(values), values[len(values) * 95 // 100], values[-1])
        lines.append([MODELS[model].label] + [text(value) for value in measures])
    return table(["model", "mean", "median", "95 %", "largest"], lines)


def mark(x, y, colour, loss, hollow=False):
    """A disc, a square or a triangle, by the loss. It is hollow if materials share further numbers."""
    fill = f'fill="#fff" stroke="{colour}" stroke-width="2"' if hollow else f'fill="{colour}"'
    if loss == CUBE_ROOTS:
        return f'<rect x="{x - 4:.1f}" y="{y - 4:.1f}" width="8" height="8" {fill}/>'
    if loss == VALUES:
        return f'<path d="M{x:.1f} {y - 5:.1f}l5 9h-10z" {fill}/>'
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" {fill}/>'


def points_of(rows, curve):
    """The mean payload, mean ΔE_ITP and shared bytes of a curve's models, in order of bytes."""
    present = {row["model"] for row in rows}
    by_model = [rows_of_model(rows, name) for name, model in MODELS.items() if model.curve == curve and name in present]
    return sorted((mean(model_rows, "payload"), mean(model_rows, "delta_e_itp"), model_rows[0]["shared"]) for model_rows in by_model)


def panel(rows, title, x0, y0, width, height):
    """ΔE_ITP over bytes, both logarithmic. Bytes that materials share are named beside hollow marks."""
    def x(value):
        return x0 + width * (math.log10(value) - 0.8) / 4.5

    def y(value):
        return y0 + height * (1 - (math.log10(value) + 0.4) / 2.05)

    parts = [f'<text x="{x0}" y="{y0 - 8}" font-weight="bold">{title}</text>',
             f'<rect x="{x0}" y="{y0}" width="{width}" height="{height}" fill="none" stroke="#999"/>']
    for value in (10, 100, 1000, 10_000, 100_000):
        label = {1000: "1 k", 10_000: "10 k", 100_000: "100 k"}.get(value, str(value))
        parts.append(f'<path d="M{x(value):.1f} {y0}v{height}" stroke="#eee"/>'
                     f'<text x="{x(value):.1f}" y="{y0 + height + 15}" text-anchor="middle">{label}</text>')
    for value in (1, 3, 10, 30):
        parts.append(f'<path d="M{x0} {y(value):.1f}h{width}" stroke="#eee"/>'
                     f'<text x="{x0 - 6}" y="{y(value) + 4:.1f}" text-anchor="end">{value}</text>')
    for curve, (colour, loss) in CURVES.items():
        points = [(x(size), y(error), shared) for size, error, shared in points_of(rows, curve)]
        line = " ".join(f"{a:.1f},{b:.1f}" for a, b, _ in points)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        for a, b, shared in points:
            parts.append(mark(a, b, colour, loss, bool(shared)))
        if points and points[-1][2]:
            a, b, shared = points[-1]
            parts.append(f'<text x="{a + 9:.1f}" y="{b + 4:.1f}" font-size="11" fill="{colour}">+ {text(shared)} shared</text>')
    return "\n".join(parts)


def plot(rows):
    rest = rows_of_all_materials(rows)
    kinds = sorted({row["kind"] for row in rows})
    parts = [panel(measured_rows(rows), "five measurements", 50, 40, 470, 430)]
    for i, kind in enumerate(kinds):
        kind_rows = [row for row in rest if row["kind"] == kind]
        parts.append(panel(kind_rows, f"{kind} ({len(rows_of_model(kind_rows, 'srbf'))})", 580 + 215 * (i % 3), 40 + 250 * (i // 3), 165,
                           180))
    for i, (curve, (colour, loss)) in enumerate(CURVES.items()):
        left, top = 30 + 150 * (i % 8), 530 + 24 * (i // 8)
        parts.append(mark(left, top - 4, colour, loss, curve in SHARING_CURVES) + f'<text x="{left + 13}" y="{top}">{curve}</text>')
    for i, loss in enumerate((PIXELS, CUBE_ROOTS, VALUES)):
        parts.append(mark(60 + 400 * i, 586, "#222", loss) + f'<text x="{73 + 400 * i}" y="590">{loss}</text>')
    parts.append('<text x="600" y="508" text-anchor="middle">bytes of a material, without what materials share</text>')
    parts.append('<text transform="translate(14 255) rotate(-90)" text-anchor="middle">mean ΔE_ITP</text>')
    return ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1240 605" '
            'font-family="DejaVu Sans, Verdana, sans-serif" font-size="13" fill="#222">'
            '<rect width="1240" height="605" fill="#fff"/>\n' + "\n".join(parts) + "\n</svg>\n")


def replace_table(page, name, new_table):
    """Replaces a table, the lines that begin with | after its mark."""
    begin = page.index(f"<!-- {name} -->\n") + len(f"<!-- {name} -->\n")
    end = begin
    while page.startswith("|", end):
        end = page.index("\n", end) + 1
    return page[:begin] + new_table + "\n" + page[end:]


def pages(rows):
    """The pages with their tables, by path."""
    measured, rest = measured_rows(rows), rows_of_all_materials(rows)
    tables = {PAGE: [("measurements", measured_table(measured)), ("means of measurements", means_table(measured)),
                     ("equal bytes", equal_bytes_table(measured)), ("kinds", kinds_table(rest)), ("stand-ins", stand_ins_table(rows)),
                     ("further tables", further_table(read(FURTHER))), ("measures", measures_table(measured))],
              ACCURACY: [("options", options_table(rows))], CHOOSING: [("sizes", sizes_table(rows))],
              PAPER: [("networks", networks_table(measured))]}
    made = {}
    for path, page_tables in tables.items():
        with open(path, encoding="utf-8") as file:
            made[path] = file.read()
        for name, new_table in page_tables:
            made[path] = replace_table(made[path], name, new_table)
    return made


def write_or_check(contents, name, script):
    """Writes `contents`, texts by path. With --check it exits with a message if a file differs."""
    for path, content in contents.items():
        if "--check" in sys.argv:
            with open(path, encoding="utf-8") as file:
                if file.read() != content:
                    sys.exit(f"{os.path.basename(path)} has other numbers than {name}.csv: python3 {script}")
        else:
            with open(path, "w", encoding="utf-8") as file:
                file.write(content)


def main():
    rows = read()
    write_or_check({**pages(rows), PLOT: plot(rows)}, "comparison", "paper/comparison.py")


if __name__ == "__main__":
    main()
