"""The table of docs/paper.md that shows what each term of the default objective adds: python3 paper/ablation.py [PROGRAM FILE... | --check]

PROGRAM is `srbf` with paper/times.patch, by which the environment variable SRBF_TIMES multiplies constants. Fits each FILE with each
setting and seed, and adds the rows that docs/ablation.csv lacks. Then, and without arguments, writes the table from the rows.
"""
import csv
import os
import statistics
import sys

import comparison
from fit_reports import material_of, report_of_fit, reports_of_fits

CSV = os.path.join(comparison.HERE, "..", "docs", "ablation.csv")
SEEDS = range(3)
WITHOUT = "highlights=1e-9 peaks=1e-9 albedos=1e-9 pixels=1e-9"
# Rows of the table, and their settings of SRBF_TIMES.
TERMS = {
    "sixth roots alone, candidates chosen by pairs": WITHOUT + " stage=0",
    "the same, candidates chosen by pictures": WITHOUT,
    "all terms": "default",
    "without pixels": "pixels=1e-9",
    "without albedos": "albedos=1e-9",
    "without cube roots and peaks of highlights": "highlights=1e-9 peaks=1e-9",
}
# Columns of docs/ablation.csv, and their numbers in a report: against the file, or against the reciprocal mean (`mean_`).
ERRORS = {
    "delta_e_itp": lambda outcome: outcome["pictures"]["delta_e_itp"],
    "rms": lambda outcome: outcome["pictures"]["rms"],
    "squared_error": lambda outcome: outcome["heldout_squared_error_ratio_cosine"],
    "albedo_error": lambda outcome: outcome["albedo_error"],
    "mean_delta_e_itp": lambda outcome: outcome["mean_pictures"]["delta_e_itp"],
    "mean_worst_delta_e_itp": lambda outcome: outcome["mean_pictures"]["worst_delta_e_itp"],
    "mean_psnr": lambda outcome: outcome["mean_pictures"]["psnr"],
    "mean_rms": lambda outcome: outcome["mean_pictures"]["rms"],
}
COLUMNS = {
    "delta_e_itp": ("ΔE_ITP (files)", ".2f"), "mean_delta_e_itp": ("ΔE_ITP (means)", ".2f"),
    "mean_worst_delta_e_itp": ("worst light (means)", ".1f"),
    "mean_psnr": ("PSNR (means)", ".1f"), "mean_rms": ("RMS of radiance (means)", ".3f"),
    "squared_error": ("squared error of r (files)", ".1%"), "albedo_error": ("albedo error (files)", ".1%"),
}


def read():
    """Returns the errors of each row, by file, setting and seed."""
    if not os.path.exists(CSV):
        return {}
    with open(CSV, encoding="utf-8") as file:
        return {(row["material"], row["setting"], int(row["seed"])): {key: float(row[key]) for key in ERRORS}
                for row in csv.DictReader(file)}


def add_rows(program, paths):
    with open(program, "rb") as file:
        if b"SRBF_TIMES" not in file.read():
            sys.exit(f"{program}: expected a program with paper/times.patch")
    rows = read()
    wanted = [(path, setting, seed) for seed in SEEDS for setting in TERMS.values() for path in paths]
    missing = [(path, setting, seed) for path, setting, seed in wanted if (material_of(path), setting, seed) not in rows]
    with open(CSV, "a", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        if not rows:
            out.writerow(["material", "setting", "seed", *ERRORS])

        def fit(path, setting, seed):
            return report_of_fit(program, path, "--seed", str(seed), SRBF_TIMES=setting)

        for (path, setting, seed), outcome in reports_of_fits(fit, missing):
            out.writerow([material_of(path), setting, seed, *(f"{error(outcome):.5g}" for error in ERRORS.values())])
            file.flush()


def ablation_table(rows):
    """Returns the table of the means over the files, each as the least and the largest of the seeds."""
    materials, lines = sorted({name for name, _, _ in rows}), []
    for name, setting in TERMS.items():
        line = [name]
        for key, (_, form) in COLUMNS.items():
            seed_means = [statistics.fmean(rows[file, setting, seed][key] for file in materials) for seed in SEEDS]
            least, largest = (format(extreme(seed_means), form) for extreme in (min, max))
            line.append(f"{least.removesuffix('%')} to {largest.replace('%', ' %')}")
        lines.append(line)
    return comparison.table(["terms", *(head for head, _ in COLUMNS.values())], lines)


def main():
    if len(sys.argv) > 2:
        add_rows(sys.argv[1], sys.argv[2:])
    with open(comparison.PAPER, encoding="utf-8") as file:
        page = file.read()
    page = comparison.replace_table(page, "ablation", ablation_table(read()))
    comparison.write_or_check({comparison.PAPER: page}, "ablation", "paper/ablation.py")


if __name__ == "__main__":
    main()
