"""Compares errors on the front page and in the paper with those of fits: python3 paper/check_front_page.py PROGRAM FOLDER | --stored

PROGRAM is `srbf`, which fits RGL's five files in FOLDER as the pages do; `./run paper FOLDER` calls it. With --stored nothing is fitted:
the errors are those of docs/comparison.csv, of seed 0, and the errors of other seeds those of docs/accuracy.md. The numbers of the pages
are read from their tables. The exit status is 1 if one of them differs, rounded as there.
"""
import csv
import os
import re
import statistics
import sys

from comparison import MEASURED
from fit_reports import material_of, report_of_fit, reports_of_fits

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")

README, PAPER, ACCURACY, STORED = "README.md", "docs/paper.md", "docs/accuracy.md", "docs/comparison.csv"
FILM, *OTHERS = FILES = list(MEASURED)
GGX, OPENPBR, DEFAULT = ("--model", "ggx", "--lobes", "2"), ("--model", "openpbr"), ()
AS_MEASURED, SIXTEEN_AS_MEASURED = ("--as-measured",), ("--as-measured", "--lobes", "16")
# Pages, rows of their tables, and the options of `srbf fit` for each row.
ROWS = [
    (README, "Lambert and two GGX lobes", GGX), (README, "parameters of OpenPBR", OPENPBR),
    (README, "9 lobes (default)", DEFAULT), (README, "16 lobes, not reciprocal", SIXTEEN_AS_MEASURED),
    (PAPER, "Lambert and two GGX lobes", GGX), (PAPER, "OpenPBR", OPENPBR), (PAPER, "four lobes", ("--lobes", "4")),
    (PAPER, "nine lobes", DEFAULT), (PAPER, "sixteen lobes", ("--lobes", "16")),
    (PAPER, "twelve Gaussian lobes", ("--form", "gaussian", "--lobes", "12")),
    (PAPER, "nine lobes, fitted to cube roots", ("--objective", "cube-root", "--max-theta", "80")),
    (PAPER, "eight lobes, not reciprocal", AS_MEASURED), (PAPER, "sixteen lobes, not reciprocal", SIXTEEN_AS_MEASURED),
]
# The model in comparison.csv for options. Some rows of the pages are of models that we do not fit.
STORED_MODELS = {GGX: "ggx-2", OPENPBR: "openpbr", DEFAULT: "srbf", ("--lobes", "4"): "srbf-4", ("--lobes", "16"): "srbf-16",
                 AS_MEASURED: "as-measured-8", SIXTEEN_AS_MEASURED: "as-measured-16"}
STORED_ROWS = [(README, "a small network", "network-6-pictures"), (README, "NBRDF", "nbrdf-16"), (PAPER, "NBRDF", "nbrdf-16"),
               (PAPER, "neural process", "nps")]
# Columns of the tables, and the files that each is the mean of.
COLUMN_FILES = {"mean of five measurements": FILES, "mean of the five": FILES, "the film": [FILM], "the other four": OTHERS}
# Columns of the page on accuracy, after the name of the file.
SEED_COLUMNS = ["least", "median", "largest", "median against the mean"]
MEDIANS = re.compile(r"medians of six seeds are (\d+\.\d+), (\d+\.\d+) and (\d+\.\d+)", re.I)  # by the front page
# Seeds of the default. Other options have seed 0 alone.
SEEDS = {DEFAULT: range(6)}
NUMBER = re.compile(r"\d[\d,]*(?:\.\d+)?")


def page(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def rows_of(path):
    """Returns the rows of a page's tables. Their cells are found by the heads of their columns, and by numbers from 0."""
    rows, head = [], None
    for line in page(path).splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else None
        if cells and head:
            rows.append({**dict(zip(head, cells)), **dict(enumerate(cells))})
        head = cells and (head or cells)
    return rows


def row_of(path, name):
    """Returns the row with this name, or the first row whose name begins with it."""
    rows = [(row[0].replace("*", ""), row) for row in rows_of(path)]
    for is_named in (lambda text: text == name, lambda text: text.startswith((name + ":", name + ","))):
        for text, row in rows:
            if is_named(text):
                return row
    sys.exit(f"{path}: expected a row {name!r}")


def fitted(program, folder):
    """Returns ΔE_ITP against the file, ΔE_ITP against the reciprocal mean, and bytes, by options, file and seed."""
    paths = [os.path.join(folder, name + "_rgb.bsdf") for name in FILES]
    for path in paths:
        if not os.path.exists(path):
            sys.exit(f"{path}: expected one of RGL's five files, and found none")
    models = dict.fromkeys(options for _, _, options in ROWS)
    wanted = [(path, options, seed) for options in models for path in paths for seed in SEEDS.get(options, [0])]
    fits = {}

    def report(path, options, seed):
        return report_of_fit(program, path, *options, "--seed", str(seed))
    for (path, options, seed), outcome in reports_of_fits(report, wanted):
        mean_pictures = outcome.get("mean_pictures", outcome["pictures"])
        fits[options, material_of(path), seed] = outcome["pictures"]["delta_e_itp"], mean_pictures["delta_e_itp"], outcome["payload_bytes"]
    return fits


def numbers_of_rows(rows, size_of, error_of):
    """Yields page, name, the number on the page as text, and the number of fits, for rows (page, name, model)."""
    for path, name, model in rows:
        row = row_of(path, name)
        size = max(size_of(model, file) for file in FILES)
        yield path, f"{name}, bytes", NUMBER.search(row["bytes"])[0].replace(",", ""), size
        for column, files in COLUMN_FILES.items():
            if column in row:
                yield path, f"{name}, {column}", row[column], statistics.fmean(error_of(model, file) for file in files)


def numbers_of_medians(median_of):
    for text, files in zip(MEDIANS.search(" ".join(page(README).split())).groups(), (FILES, [FILM], OTHERS)):
        yield README, f"medians of {len(files)}", text, statistics.fmean(map(median_of, files))


def stored_numbers():
    """Yields such numbers of comparison.csv, and of the page on accuracy."""
    with open(os.path.join(ROOT, STORED), encoding="utf-8") as file:
        rows = {(row["material"], row["model"]): row for row in csv.DictReader(file)}

    def error_of(model, file):
        return float(rows[file, model]["delta_e_itp"])
    models = [(path, name, STORED_MODELS[options]) for path, name, options in ROWS if options in STORED_MODELS]
    yield from numbers_of_rows(models + STORED_ROWS, lambda model, file: int(rows[file, model]["payload"]), error_of)
    seeds = {file: row_of(ACCURACY, file) for file in FILES}
    yield from numbers_of_medians(lambda file: float(seeds[file][2]))
    # An error of seed 0 lies between the least and the largest of six seeds.
    for file, row in seeds.items():
        for model, least, largest in (("srbf", 1, 3), ("as-measured-8", 5, 7)):
            nearest = min(max(round(error_of(model, file), 2), float(row[least])), float(row[largest]))
            yield ACCURACY, f"{file}, {model}, seed 0 within the six", f"{nearest:.2f}", error_of(model, file)


def fitted_numbers(program, folder):
    """Yields such numbers of fits."""
    fits = fitted(program, folder)

    def by_seed(file, which=0):
        return [fits[DEFAULT, file, seed][which] for seed in SEEDS[DEFAULT]]

    def error_of(options, file):
        return fits[options, file, 0][0]

    def median_of(file):
        return statistics.median(by_seed(file))
    abstract = next(part for part in page(PAPER).split("\n\n") if part.startswith("**Abstract.**"))
    for name, value in (("nine lobes, medians", statistics.fmean(map(median_of, FILES))),
                        ("two GGX lobes", statistics.fmean(error_of(GGX, file) for file in FILES))):
        yield PAPER, f"abstract, {name}", f"{value:.1f}" if f"{value:.1f}" in NUMBER.findall(abstract) else "none", value
    yield from numbers_of_rows(ROWS, lambda options, file: fits[options, file, 0][2], error_of)
    yield from numbers_of_medians(median_of)
    for file in FILES:
        row, errors = row_of(ACCURACY, file), by_seed(file)
        values = [min(errors), statistics.median(errors), max(errors), statistics.median(by_seed(file, 1))]
        for column, (what, value) in enumerate(zip(SEED_COLUMNS, values), 1):
            yield ACCURACY, f"{file}, {what} of six seeds", row[column], value


def main():
    words, differ = sys.argv[1:], 0
    if words != ["--stored"] and len(words) != 2:
        sys.exit("expected PROGRAM FOLDER or --stored: " + __doc__.split("\n", maxsplit=1)[0])
    print("| page | number | there | here | |\n|---|---|---|---|---|")
    for path, name, text, value in stored_numbers() if words == ["--stored"] else fitted_numbers(*words):
        decimals = len(text.partition(".")[2])
        is_other = f"{value:.{decimals}f}" != text
        differ += is_other
        print(f"| {path} | {name} | {text} | {value:.{decimals + 1}f} | {'differs' * is_other} |")
    print(f"{differ} differ")
    sys.exit(1 if differ else 0)


if __name__ == "__main__":
    main()
