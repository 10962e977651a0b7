"""The files of data/ready are what the program writes for the bundled film: test/hosts/ready.py PROGRAM; with --write they are written anew. Texts are
equal; numbers that are fitted to values of a renderer's arithmetic may differ in their last digits."""
import math
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

program, data = Path(sys.argv[1]).resolve(), Path(__file__).resolve().parents[2] / "data"
NUMBER = re.compile(r"-?\d+\.\d+(?:e[-+]?\d+)?")
MEASURED = data / "cc_ibiza_sunset_rgb.bsdf"
COMMANDS = [["fit", MEASURED, "-o", "film.srbf"], ["export", "film.srbf", "--to", "three", "-o", "film.js"],
            ["export", "film.bsdf", "--to", "blender", "-o", "film.py"]]
with tempfile.TemporaryDirectory() as folder:
    shutil.copy(MEASURED, Path(folder, "film.bsdf"))
    for command in COMMANDS:
        subprocess.run([program, *command], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    for name in ("film.js", "film.py"):
        written, kept = Path(folder, name), data / "ready" / name
        if "--write" in sys.argv:
            shutil.copy(written, kept)
        texts = [path.read_text(encoding="utf-8") for path in (written, kept)]
        numbers = [[float(number) for number in NUMBER.findall(text)] for text in texts]
        same = NUMBER.sub("#", texts[0]) == NUMBER.sub("#", texts[1]) and all(
            math.isclose(a, b, rel_tol=1e-3, abs_tol=1e-5) for a, b in zip(*numbers))
        print(f"{name}: {'as the program writes it' if same else 'FAILED: the program writes another: ready.py PROGRAM --write'}")
        if not same:
            sys.exit(1)
