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


class Errors:
    """Returns errors of fits by options and file, one for each seed, and their means over files."""

    def __init__(self, fits):
        self.fits = fits

    def by_seed(self, options, name, which=0):
        return [self.fits[options, name, seed][which] for seed in SEEDS.get(options, [0])]

    def mean(self, options, names):
        return statistics.fmean(self.by_seed(options, name)[0] for name in names)

    def mean_of_medians(self, options, names):
        return statistics.fmean(statistics.median(self.by_seed(options, name)) for name in names)


def numbers_of_rows(errors):
    """Yields page, name, the number on the page as text, and the number of the fits."""
    for path, name, options in ROWS:
        row = row_of(path, name)
        yield path, f"{name}, bytes", row["bytes"], max(errors.fits[options, file, 0][2] for file in FILES)
        for column, files in COLUMN_FILES.items():
            if column in row:
                yield path, f"{name}, {column}", row[column], errors.mean(options, files)


def numbers_of_medians(errors):
    for text, files in zip(MEDIANS.search(" ".join(page(README).split())).groups(), (FILES, [FILM], OTHERS)):
        yield README, f"medians of {len(files)}", text, errors.mean_of_medians(DEFAULT, files)


def numbers_of_seeds(errors):
    for name in FILES:
        row = row_of(ACCURACY, name)
        file_errors, mean_errors = errors.by_seed(DEFAULT, name), errors.by_seed(DEFAULT, name, 1)
        values = [min(file_errors), statistics.median(file_errors), max(file_errors), statistics.median(mean_errors)]
        for column, (what, value) in enumerate(zip(SEED_COLUMNS, values), 1):
            yield ACCURACY, f"{name}, {what} of six seeds", row[column], value


def numbers_of_abstract(errors):
    """Returns the numbers that the abstract must contain."""
    abstract = next(part for part in page(PAPER).split("\n\n") if part.startswith("**Abstract.**"))
    for name, value in (("nine lobes, medians", errors.mean_of_medians(DEFAULT, FILES)), ("two GGX lobes", errors.mean(GGX, FILES))):
        yield PAPER, f"abstract, {name}", f"{value:.1f}" if f"{value:.1f}" in NUMBER.findall(abstract) else "none", value


def stored_numbers():
    """Yields page, name, the number on the page as text, and the number of comparison.csv or of the page on accuracy."""
    with open(os.path.join(ROOT, STORED), encoding="utf-8") as file:
        rows = {(row["material"], row["model"]): row for row in csv.DictReader(file)}
    models = [(path, name, STORED_MODELS[options]) for path, name, options in ROWS if options in STORED_MODELS]
    for path, name, model in models + STORED_ROWS:
        row = row_of(path, name)
        size = max(int(rows[file, model]["payload"]) for file in FILES)
        yield path, f"{name}, bytes", NUMBER.search(row["bytes"])[0].replace(",", ""), size
        for column, files in COLUMN_FILES.items():
            if column in row:
                yield path, f"{name}, {column}", row[column], statistics.fmean(float(rows[file, model]["delta_e_itp"]) for file in files)
    seeds = {file: row_of(ACCURACY, file) for file in FILES}
    for text, files in zip(MEDIANS.search(" ".join(page(README).split())).groups(), (FILES, [FILM], OTHERS)):
        yield README, f"medians of {len(files)}", text, statistics.fmean(float(seeds[file][2]) for file in files)
    # An error of seed 0 lies between the least and the largest of six seeds.
    for file, row in seeds.items():
        for model, least, largest in (("srbf", 1, 3), ("as-measured-8", 5, 7)):
            error = float(rows[file, model]["delta_e_itp"])
            nearest = min(max(round(error, 2), float(row[least])), float(row[largest]))
            yield ACCURACY, f"{file}, {model}, seed 0 within the six", f"{nearest:.2f}", error


def fitted_numbers(program, folder):
    errors = Errors(fitted(program, folder))
    for numbers_of in (numbers_of_abstract, numbers_of_rows, numbers_of_medians, numbers_of_seeds):
        yield from numbers_of(errors)


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
