"""Fits the five measurements as the front page and the paper do, and compares errors with theirs: python3 paper/check_front_page.py PROGRAM FOLDER

PROGRAM is `srbf`, and FOLDER has RGL's files; `./run paper FOLDER` calls it. The numbers of the pages are read from their tables. The exit
status is 1 if one of them differs from that of the fits, rounded as there.
"""
import os
import re
import statistics
import sys

from comparison import MEASURED
from fit_reports import material_of, report_of_fit, reports_of_fits

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")

README, PAPER, ACCURACY = "README.md", "docs/paper.md", "docs/accuracy.md"
FILM, *OTHERS = FILES = list(MEASURED)
GGX, OPENPBR, DEFAULT = ("--model", "ggx", "--lobes", "2"), ("--model", "openpbr"), ()
SIXTEEN_AS_MEASURED = ("--as-measured", "--lobes", "16")
# Pages, rows of their tables, and the options of `srbf fit` for each row.
ROWS = [
    (README, "Lambert and two GGX lobes", GGX), (README, "parameters of OpenPBR", OPENPBR),
    (README, "9 lobes (default)", DEFAULT), (README, "16 lobes, not reciprocal", SIXTEEN_AS_MEASURED),
    (PAPER, "Lambert and two GGX lobes", GGX), (PAPER, "OpenPBR", OPENPBR), (PAPER, "four lobes", ("--lobes", "4")),
    (PAPER, "nine lobes", DEFAULT), (PAPER, "sixteen lobes", ("--lobes", "16")),
    (PAPER, "twelve Gaussian lobes", ("--form", "gaussian", "--lobes", "12")),
    (PAPER, "nine lobes, fitted to cube roots", ("--objective", "cube-root", "--max-theta", "80")),
    (PAPER, "eight lobes, not reciprocal", ("--as-measured",)), (PAPER, "sixteen lobes, not reciprocal", SIXTEEN_AS_MEASURED),
]
# Columns of the tables, and the files that each is the mean of.
COLUMN_FILES = {"mean of five measurements": FILES, "mean of the five": FILES, "the film": [FILM], "the other four": OTHERS}
# Columns of the page on accuracy, after the name of the file.
SEED_COLUMNS = ["least", "median", "largest", "median against the mean"]
# Seeds of the default. Other options have seed 0 alone.
SEEDS = {DEFAULT: range(6)}
NUMBER = re.compile(r"\d[\d,]*(?:\.\d+)?")


def page(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def rows_of(path):
    """The rows of a page's tables, as cells by the heads of their columns, and by numbers from 0."""
    rows, head = [], None
    for line in page(path).splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else None
        if cells and head:
            rows.append({**dict(zip(head, cells)), **dict(enumerate(cells))})
        head = cells and (head or cells)
    return rows


def row_of(path, name):
    """The row with this name, or the first whose name begins with it."""
    rows = [(row[0].replace("*", ""), row) for row in rows_of(path)]
    for is_named in (lambda text: text == name, lambda text: text.startswith((name + ":", name + ","))):
        for text, row in rows:
            if is_named(text):
                return row
    sys.exit(f"{path}: expected a row {name!r}")


def fitted(program, folder):
    """ΔE_ITP against the file, against the reciprocal mean, and bytes, by options, file and seed."""
    paths = [os.path.join(folder, name + "_rgb.bsdf") for name in FILES]
    for path in paths:
        if not os.path.exists(path):
            sys.exit(f"{path}: expected one of RGL's five files, and found none")
    models = dict.fromkeys(options for _, _, options in ROWS)
    wanted = [(path, options, seed) for options in models for path in paths for seed in SEEDS.get(options, [0])]
    fits = {}
    for (path, options, seed), outcome in reports_of_fits(lambda path, options, seed: report_of_fit(program, path, *options, "--seed", str(seed)), wanted):
        mean_pictures = outcome.get("mean_pictures", outcome["pictures"])
        fits[options, material_of(path), seed] = outcome["pictures"]["delta_e_itp"], mean_pictures["delta_e_itp"], outcome["payload_bytes"]
    return fits


class Errors:
    """Errors of fits by options and file, one for each seed, and their means over files."""

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
            values = [errors.mean(options, files), errors.mean_of_medians(options, files)]
            for kind, text, value in zip(("", ", medians"), NUMBER.findall(row.get(column, "")), values):
                yield path, f"{name}, {column}{kind}", text, value


def numbers_of_seeds(errors):
    for name in FILES:
        row = row_of(ACCURACY, name)
        file_errors, mean_errors = errors.by_seed(DEFAULT, name), errors.by_seed(DEFAULT, name, 1)
        values = [min(file_errors), statistics.median(file_errors), max(file_errors), statistics.median(mean_errors)]
        for column, (what, value) in enumerate(zip(SEED_COLUMNS, values), 1):
            yield ACCURACY, f"{name}, {what} of six seeds", row[column], value


def numbers_of_abstract(errors):
    """Numbers that the abstract must contain."""
    abstract = next(part for part in page(PAPER).split("\n\n") if part.startswith("**Abstract.**"))
    for name, value in (("nine lobes, medians", errors.mean_of_medians(DEFAULT, FILES)), ("two GGX lobes", errors.mean(GGX, FILES))):
        yield PAPER, f"abstract, {name}", f"{value:.1f}" if f"{value:.1f}" in NUMBER.findall(abstract) else "none", value


def main():
    if len(sys.argv) != 3:
        sys.exit("expected PROGRAM FOLDER: " + __doc__.split("\n", maxsplit=1)[0])
    errors, differ = Errors(fitted(*sys.argv[1:])), 0
    print("| page | number | there | here | |\n|---|---|---|---|---|")
    for numbers_of in (numbers_of_abstract, numbers_of_rows, numbers_of_seeds):
        for path, name, text, value in numbers_of(errors):
            decimals = len(text.partition(".")[2])
            is_other = f"{value:.{decimals}f}" != text
            differ += is_other
            print(f"| {path} | {name} | {text} | {value:.{decimals + 1}f} | {'differs' * is_other} |")
    print(f"{differ} differ")
    sys.exit(1 if differ else 0)


if __name__ == "__main__":
    main()
