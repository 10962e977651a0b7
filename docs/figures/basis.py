"""docs/basis.svg and the tables of docs/basis.md, from docs/basis.csv and docs/comparison.csv: python3 docs/figures/basis.py [--check | LIBRARY.srbf...]

LIBRARY: files of `srbf basis FILES --lobes J --active K`, from which docs/basis.csv is written first. With --check nothing is written; the
exit status is 1 if the page or the plot has other numbers.
"""
import csv
import json
import math
import os
import statistics
import struct
import sys


sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "paper"))
import comparison  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
CSV, PAGE, PLOT = (os.path.join(HERE, "..", name) for name in ("basis.csv", "basis.md", "basis.svg"))
OWN = {f"as-measured-{lobes}": f"{lobes} lobes" for lobes in (4, 8, 12, 16)}  # fits of their own in comparison.csv, of the form of libraries
COLOURS = {16: "#b3d1ea", 32: "#6fa8d8", 64: "#2a6fb0", 128: "#123f6b", "own": "#c0392b", "neural": "#5d6d7e"}
WANTED = 1.5  # times the mean error of fits of 8 lobes


def rows_of(path):
    """The rows of a sparse library: of each material its error."""
    with open(path, "rb") as file:
        head = json.loads(file.read(struct.unpack("<Q", file.read(8))[0]))
        begin = file.tell()
        _, active, _ = head["coefficient"]["shape"]
        lobes = head["bandwidth"]["shape"][0]
        shared = sum(2 * math.prod(head[name]["shape"]) for name in ("bandwidth", "parameterization", "log_scale", "exponent"))
        first, last = head["aux.error"]["data_offsets"]
        file.seek(begin + first)
        errors = struct.unpack(f"<{(last - first) // 2}e", file.read(last - first))
    return [[name, lobes, active, 8 * active, shared, f"{error:.6g}"] for name, error in zip(head["__metadata__"]["names"].split("\n"), errors)]


def write_csv(paths):
    with open(CSV, "w", encoding="utf-8", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["material", "lobes", "active", "payload", "shared", "delta_e_itp"])
        out.writerows(sorted((row for path in paths for row in rows_of(path)), key=lambda row: (row[1], row[2])))


class Errors:
    """Of the libraries by (lobes, active), and of other models by name: the error of each material; bytes with a share of what is shared."""

    def __init__(self):
        self.error, self.bytes, self.payload = {}, {}, {}
        with open(CSV, encoding="utf-8") as file:
            for row in csv.DictReader(file):
                key = int(row["lobes"]), int(row["active"])
                self.error.setdefault(key, {})[row["material"]] = float(row["delta_e_itp"])
                self.payload[key] = int(row["payload"]), int(row["shared"])
        self.libraries = sorted(self.error)
        self.count = len(self.error[self.libraries[0]])
        for row in comparison.read():
            if row["model"] in (*OWN, "nps"):
                self.error.setdefault(row["model"], {})[row["material"]] = row["delta_e_itp"]
                self.payload[row["model"]] = row["payload"], row["shared"]
        for key, (payload, shared) in self.payload.items():
            self.bytes[key] = payload + (0 if key == "nps" else shared / self.count)

    def mean(self, key, materials=None):
        return statistics.fmean(error for name, error in self.error[key].items() if materials is None or name in materials)


def panel(errors, title, materials, x0, y0, width, height):
    """ΔE_ITP over bytes, both logarithmic; the dashed line is what is wanted. The decoder of the hollow mark is not in its bytes."""
    x = lambda value: x0 + width * math.log(value / 20) / math.log(500 / 20)
    y = lambda value: y0 + height * (1 - (math.log10(value) - 0.1) / 0.9)
    parts = [f'<text x="{x0}" y="{y0 - 8}" font-weight="bold">{title}</text>',
             f'<rect x="{x0}" y="{y0}" width="{width}" height="{height}" fill="none" stroke="#999"/>']
    for value in (20, 50, 100, 200, 500):
        parts.append(f'<path d="M{x(value):.1f} {y0}v{height}" stroke="#eee"/>'
                     f'<text x="{x(value):.1f}" y="{y0 + height + 15}" text-anchor="middle">{value}</text>')
    for value in (1.5, 2, 3, 4, 6, 8):
        parts.append(f'<path d="M{x0} {y(value):.1f}h{width}" stroke="#eee"/>'
                     f'<text x="{x0 - 6}" y="{y(value) + 4:.1f}" text-anchor="end">{value:g}</text>')
    wanted = WANTED * errors.mean("as-measured-8", materials)
    parts.append(f'<path d="M{x0} {y(wanted):.1f}h{width}" stroke="#555" stroke-dasharray="5 4"/>')
    curves = {lobes: [key for key in errors.libraries if key[0] == lobes] for lobes in sorted({key[0] for key in errors.libraries})}
    curves["own"] = list(OWN)
    if materials is not None:
        curves["neural"] = ["nps"]
    for curve, keys in curves.items():
        points = [(x(errors.bytes[key]), y(errors.mean(key, materials))) for key in keys]
        line = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[curve]}" stroke-width="2"/>')
        parts += [comparison.mark(a, b, COLOURS[curve], curve == "neural") for a, b in points]
        if curve == "neural":
            a, b = points[0]
            parts.append(f'<text x="{a + 9:.1f}" y="{b + 4:.1f}" font-size="11" fill="{COLOURS[curve]}" stroke="#fff" '
                         f'stroke-width="3" paint-order="stroke">+ {errors.payload["nps"][1]:,.0f} shared</text>')
    return "\n".join(parts)


def plot(errors):
    parts = [panel(errors, f"{errors.count} materials", None, 60, 40, 290, 230),
             panel(errors, "the five measurements among them", comparison.MEASURED, 420, 40, 290, 230)]
    lobes = sorted({key[0] for key in errors.libraries})
    names = {**{J: f"{J} shared lobes" for J in lobes}, "own": "lobes of their own", "neural": "neural process"}
    for i, (curve, name) in enumerate(names.items()):
        top = 60 + 26 * i
        parts.append(comparison.mark(738, top - 4, COLOURS[curve], curve == "neural") + f'<text x="750" y="{top}">{name}</text>')
    top = 60 + 26 * len(names)
    parts.append(f'<path d="M730 {top - 4}h16" stroke="#555" stroke-dasharray="5 4"/><text x="750" y="{top}">1.5 × 8 of their own</text>')
    parts.append(f'<text x="385" y="308" text-anchor="middle">bytes of a material, with its share of the lobes that {errors.count} share</text>')
    parts.append('<text transform="translate(18 155) rotate(-90)" text-anchor="middle">mean ΔE_ITP</text>')
    return ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 900 322" font-family="DejaVu Sans, Verdana, sans-serif" font-size="13" fill="#222">'
            '<rect width="900" height="322" fill="#fff"/>\n' + "\n".join(parts) + "\n</svg>\n")


def name_of(key):
    if isinstance(key, tuple):
        return f"{key[0]} shared, {key[1]} active"
    return f"a fit of its own, {OWN[key]}"


def errors_table(errors):
    """Of the libraries with 8 and 16 active lobes; the plot has all."""
    lines = []
    for key in [*OWN, *(key for key in errors.libraries if key[1] in (8, 16))]:
        payload, shared = errors.payload[key]
        mean = errors.mean(key)
        lines.append([name_of(key), f"{payload:.0f}" + (f" + {shared / errors.count:.0f}" if shared else ""), f"{mean:.2f}",
                      f"{statistics.median(errors.error[key].values()):.2f}", f"{mean / errors.mean('as-measured-8'):.2f}"])
    return comparison.table(["", "bytes a material", "mean ΔE_ITP", "median", "of the mean of 8 own lobes"], lines)


def main():
    if "--check" not in sys.argv and len(sys.argv) > 1:
        write_csv(sys.argv[1:])
    errors = Errors()
    with open(PAGE, encoding="utf-8") as file:
        page = file.read()
    page = comparison.replaced(page, "errors", errors_table(errors))
    comparison.write_or_check({PAGE: page, PLOT: plot(errors)}, "basis", "docs/figures/basis.py")


if __name__ == "__main__":
    main()
