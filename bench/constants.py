"""Constants of the default objective, chosen on four files and tested on the fifth: python3 bench/constants.py [PROGRAM FILE...]

PROGRAM is `srbf` with bench/times.patch, by which the environment variable SRBF_TIMES multiplies constants. Fits each FILE by each
setting and seed, and adds the rows to docs/constants.csv that are not there yet. Then, and without arguments, prints tables of the rows.
"""
import csv
import itertools
import math
import os
import random
import statistics
import sys

from reports import material, report, reports

CSV = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "docs", "constants.csv")
CONSTANTS = ["albedos", "pixels", "lamps", "highlights", "peaks", "offset"]
SEEDS, RANDOM_SETTINGS, LARGEST_FACTOR = range(3), 12, 3
DEFAULT = "default"
WITHOUT = "highlights=1e-9 peaks=1e-9 lamps=1e-9 albedos=1e-9 pixels=1e-9"
TERMS = {  # rows of the paper's table of terms
    "sixth roots alone, candidates chosen by pairs": WITHOUT + " stage=0",
    "the same, candidates chosen by pictures": WITHOUT,
    "all terms": DEFAULT,
    "without pixels": "pixels=1e-9",
    "without albedos": "albedos=1e-9",
    "without lamps": "lamps=1e-9",
    "without cube roots and peaks of highlights": "highlights=1e-9 peaks=1e-9",
}
ERRORS = {  # columns, of a report; `mean_` against the reciprocal mean, others against the file
    "delta_e_itp": lambda of: of["pictures"]["delta_e_itp"],
    "rms": lambda of: of["pictures"]["rms"],
    "squared_error": lambda of: of["heldout_squared_error_ratio_cosine"],
    "albedo_error": lambda of: of["albedo_error"],
    "mean_delta_e_itp": lambda of: of["mean_pictures"]["delta_e_itp"],
    "mean_worst_delta_e_itp": lambda of: of["mean_pictures"]["worst_delta_e_itp"],
    "mean_psnr": lambda of: of["mean_pictures"]["psnr"],
    "mean_rms": lambda of: of["mean_pictures"]["rms"],
}
OF_TERMS = {  # columns of the table of terms
    "delta_e_itp": ("ΔE_ITP (files)", ".2f"), "mean_delta_e_itp": ("ΔE_ITP (means)", ".2f"), "mean_worst_delta_e_itp": ("worst light (means)", ".1f"),
    "mean_psnr": ("PSNR (means)", ".1f"), "mean_rms": ("RMS of radiance (means)", ".3f"), "squared_error": ("squared error of r (files)", ".1%"), "albedo_error": ("albedo error (files)", ".1%"),
}
ALL_FOUR = "all four"  # the geometric mean of four errors, each over that of the default
CRITERIA = {"delta_e_itp": "ΔE_ITP", "rms": "RMS", "squared_error": "squared error", "albedo_error": "albedo error", ALL_FOUR: "all four"}
FORMS = {"delta_e_itp": ".2f", "rms": ".4f", "squared_error": ".2%", "albedo_error": ".2%", ALL_FOUR: ".3f"}
SINGLE = list(CRITERIA)[:4]


def settings():
    """The default, each constant divided and multiplied by the largest factor, and random factors of all, uniform in their logarithms."""
    generator = random.Random(1)
    single = [f"{name}={factor:.3g}" for name in CONSTANTS for factor in (1 / LARGEST_FACTOR, LARGEST_FACTOR)]
    several = [" ".join(f"{name}={LARGEST_FACTOR ** generator.uniform(-1, 1):.3g}" for name in CONSTANTS) for _ in range(RANDOM_SETTINGS)]
    return [DEFAULT, *single, *several]


def add_rows(program, paths):
    with open(program, "rb") as file:
        if b"SRBF_TIMES" not in file.read():
            sys.exit(f"{program}: expected a program with bench/times.patch")
    rows = read()
    wanted = [(path, setting, seed) for seed in SEEDS for setting in dict.fromkeys([*settings(), *TERMS.values()]) for path in paths]
    missing = [(path, setting, seed) for path, setting, seed in wanted if (material(path), setting, seed) not in rows]
    with open(CSV, "a", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        if not rows:
            out.writerow(["material", "setting", "seed", *ERRORS])
        fit = lambda path, setting, seed: report(program, path, "--seed", str(seed), SRBF_TIMES=setting)
        for (path, setting, seed), of in reports(fit, missing):
            out.writerow([material(path), setting, seed, *(f"{error(of):.5g}" for error in ERRORS.values())])
            file.flush()


def read():
    """The errors of each row, by file, setting and seed."""
    if not os.path.exists(CSV):
        return {}
    with open(CSV, encoding="utf-8") as file:
        return {(row["material"], row["setting"], int(row["seed"])): {key: float(row[key]) for key in ERRORS} for row in csv.DictReader(file)}


class Means:
    """Errors of settings on files: means over the seeds that have a row of each setting and file."""

    def __init__(self, rows, of_settings):
        self.settings = of_settings
        self.materials = sorted({name for name, _, _ in rows})
        self.seeds = [seed for seed in SEEDS if all(key in rows for key in itertools.product(self.materials, of_settings, [seed]))]
        self.rows = rows

    def error(self, setting, materials, criterion):
        if criterion == ALL_FOUR:
            logs = [math.log(self.error(setting, [name], one) / self.error(DEFAULT, [name], one)) for name in materials for one in SINGLE]
            return math.exp(statistics.fmean(logs))
        return statistics.fmean(self.rows[name, setting, seed][criterion] for name in materials for seed in self.seeds)

    def best(self, materials, criterion):
        return min(self.settings, key=lambda setting: self.error(setting, materials, criterion))

    def chosen(self, held_out, criterion):
        """The setting that is best on all files but one."""
        return self.best([name for name in self.materials if name != held_out], criterion)


def print_table(heads, lines):
    for line in (heads, ["---"] * len(heads), *lines):
        print("| " + " | ".join(line) + " |")
    print()


def print_terms(means):
    """Means over the files: the least and the largest of the seeds."""
    lines = []
    for name, setting in TERMS.items():
        cells = []
        for key, (_, form) in OF_TERMS.items():
            of_seeds = [statistics.fmean(means.rows[file, setting, seed][key] for file in means.materials) for seed in means.seeds]
            least, largest = (format(of(of_seeds), form) for of in (min, max))
            cells.append(f"{least.removesuffix('%')} to {largest.replace('%', ' %')}")
        lines.append([name] + cells)
    print_table(["terms", *(head for head, _ in OF_TERMS.values())], lines)


def print_choices(means):
    """Means over the files, of each criterion: errors of settings that were chosen by it in several ways."""
    ways = {
        "default": lambda name, criterion: DEFAULT,
        "chosen on the other four files": means.chosen,
        "chosen on the file itself": lambda name, criterion: means.best([name], criterion),
    }
    error = lambda setting_of, criterion: statistics.fmean(means.error(setting_of(name, criterion), [name], criterion) for name in means.materials)
    lines = [[way] + [format(error(setting_of, criterion), FORMS[criterion]).replace("%", " %") for criterion in CRITERIA] for way, setting_of in ways.items()]
    places = [sorted(means.settings, key=lambda setting: means.error(setting, means.materials, criterion)).index(DEFAULT) + 1 for criterion in CRITERIA]
    print_table(["setting", *CRITERIA.values()], [*lines, [f"place of the default among {len(means.settings)}", *map(str, places)]])


def print_other_errors(means):
    """Errors on each held-out file of the setting that is best on the other four by one criterion, over those of the default: geometric means."""
    lines = []
    for criterion, head in CRITERIA.items():
        logs = [[math.log(means.error(means.chosen(name, criterion), [name], other) / means.error(DEFAULT, [name], other)) for name in means.materials]
                for other in CRITERIA]
        lines.append([head, *(f"{math.exp(statistics.fmean(of_files)):.2f}" for of_files in logs)])
    print_table(["chosen by", *CRITERIA.values()], lines)
    print_table(["held out", "best on the other four by ΔE_ITP"], [[name, means.chosen(name, "delta_e_itp")] for name in means.materials])


def main():
    if len(sys.argv) > 1:
        add_rows(sys.argv[1], sys.argv[2:])
    rows = read()
    for of_settings, printers in ((list(TERMS.values()), [print_terms]), (settings(), [print_choices, print_other_errors])):
        means = Means(rows, of_settings)
        print(f"{len(of_settings)} settings, seeds {means.seeds}\n")
        for print_one in printers if means.seeds else ():
            print_one(means)


if __name__ == "__main__":
    main()
