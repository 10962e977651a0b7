"""docs/performance_fits.svg: python3 docs/figures/fits.py SRBF [RUNS]

The time of fits of the bundled film with two threads, by instruction set: the least `fit_seconds` of RUNS (3) runs of each, on a machine
that does nothing else. Prints the numbers too.
"""
import json
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
FILM = os.path.join(HERE, "..", "..", "data", "cc_ibiza_sunset_rgb.bsdf")
SETS = {"AVX-512": ("AVX3", "#2a6fb0"), "AVX2": ("AVX2", "#7fb2dd"), "SSE4": ("SSE4", "#c9dff0")}  # name for SRBF_INSTRUCTIONS, and colour
FITS = [("nine lobes, 210 bytes", []), ("sixteen lobes, 364 bytes", ["--lobes", "16"]), ("as measured, 208 bytes", ["--as-measured"]),
        ("view by view, 92,160 bytes", ["--model", "su", "--lobes", "5"])]
BASELINE = ("Lambert and one GGX lobe", ["--model", "ggx"])
LEFT, WIDTH = 250, 380  # pixels of the bars


def seconds(program, options, instructions, runs):
    environment = dict(os.environ, SRBF_INSTRUCTIONS=instructions)
    with tempfile.TemporaryDirectory() as work:
        command = [program, "fit", FILM, "-o", os.path.join(work, "film.srbf"), "--threads", "2", "--json", "-", *options]
        reports = [subprocess.run(command, env=environment, check=True, capture_output=True).stdout for _ in range(runs)]
    return min(json.loads(report)["fit_seconds"] for report in reports)


def svg(bars):
    """Bars of (label, seconds, colour), and the legend below."""
    longest = max(value for _, value, _ in bars)
    height = 56 + 24 * len(bars) + 24
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 {height}" font-family="sans-serif" font-size="13">'
             f'<rect width="720" height="{height}" fill="#fff"/>',
             '<text x="10" y="18" font-weight="bold">A fit of the vinyl film, on two cores</text>']
    for i, (label, value, colour) in enumerate(bars):
        y, width = 32 + 24 * i, max(1, round(WIDTH * value / longest))
        parts.append(f'<text x="{LEFT - 8}" y="{y + 13}" text-anchor="end">{label}</text><rect x="{LEFT}" y="{y}" width="{width}" height="18" '
                     f'fill="{colour}"/><text x="{LEFT + width + 6}" y="{y + 13}" fill="#444">{value:.3g} s</text>')
    for i, (name, colour) in enumerate([(name, colour) for name, (_, colour) in SETS.items()] + [("any", "#999")]):
        x, y = LEFT + 100 * i, height - 26
        parts.append(f'<rect x="{x}" y="{y}" width="12" height="12" fill="{colour}"/><text x="{x + 18}" y="{y + 11}" fill="#444">{name}</text>')
    return "\n".join(parts) + "\n</svg>\n"


def main():
    program, runs = os.path.abspath(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 3
    bars = [(label, seconds(program, options, instructions, runs), colour)
            for label, options in FITS for instructions, colour in SETS.values()]
    bars.append((BASELINE[0], seconds(program, BASELINE[1], SETS["AVX-512"][0], runs), "#999"))
    for label, value, _ in bars:
        print(f"{value:8.3f} s  {label}")
    with open(os.path.join(HERE, "..", "performance_fits.svg"), "w", encoding="utf-8") as file:
        file.write(svg(bars))


if __name__ == "__main__":
    main()
