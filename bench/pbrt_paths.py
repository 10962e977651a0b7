"""pbrt_paths.py PBRT SRBF FILE: compares agreement, times and noise of paths in pbrt-v4 by the material of examples/pbrt.

PBRT is a pbrt that has the material, SRBF the program `srbf`, FILE a measurement, for example an RGL file. The scene is
examples/pbrt/ball.pbrt. Its materials are `diffuse`; the default fit of FILE, by `srbf` and as a table by `measured`; and
FILE itself, with light and viewer exchanged, by both. For each one it prints:
  - the start: seconds of processor time of a picture with one path per pixel, the least of RUNS
  - microseconds of one more path, by a picture with PATHS paths per pixel, some of which miss the ball
  - the relative variance of a path's luminance in the ball, in two ways: the mean variance of the pixels over the square of
    their mean, where bright pixels count most, and the mean of their relative variances.
Then it prints for fit and file the relative difference of both pictures, RMS over squares of 8 x 8 pixels and colours, and
the difference that noise alone makes. Needs numpy. Use one core: taskset -c 1 python3 bench/pbrt_paths.py .."""
import pathlib
import resource
import subprocess
import sys
import tempfile

import numpy as np

PATHS, RUNS, SIZE, SQUARE = 32, 12, 160, 8
BALL = np.hypot(*(np.indices((SIZE, SIZE)) - (SIZE - 1) / 2)) < 65
SCENE = pathlib.Path(__file__).resolve().parent.parent / "examples/pbrt/ball.pbrt"
MATERIALS = {
    "diffuse": '"diffuse"',
    "srbf, fit": '"srbf" "string filename" "film.srbf"',
    "measured, fit": '"measured" "string filename" "fit.bsdf"',
    "srbf, file": '"srbf" "string filename" "file.bsdf" "bool exchange" true',
    "measured, file": '"measured" "string filename" "file.bsdf"',
}


def prepare(program, file, folder):
    for command in (["fit", file, "-o", "film.srbf"], ["convert", "film.srbf", "-o", "fit.bsdf"],
                    ["convert", file, "--exchange", "-o", "file.bsdf"]):
        subprocess.run([program, *command], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def drawn(pbrt, material, paths, seed, folder):
    """Returns the processor time of a picture [s], and its colours."""
    text = SCENE.read_text()
    for old, new in ((MATERIALS["srbf, fit"], material), ("ball.png", "ball.pfm"),
                     ('"independent" "integer pixelsamples" 64', f'"independent" "integer pixelsamples" {paths} "integer seed" {seed}')):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    (folder / "ball.pbrt").write_text(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([pbrt, "--nthreads", "1", "--quiet", "ball.pbrt"], cwd=folder, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    picture = np.frombuffer((folder / "ball.pfm").read_bytes()[-12 * SIZE * SIZE:], "<f4").reshape(SIZE, SIZE, 3)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, picture.astype(float)


def compare(name, ours, theirs):
    ours, theirs = (picture.reshape(RUNS, SIZE // SQUARE, SQUARE, SIZE // SQUARE, SQUARE, 3).mean((2, 4)) for picture in (ours, theirs))
    apart = (ours - theirs) / theirs.mean(0)  # for each run, in which both materials have the same seeds
    distance, noise = np.sqrt((apart.mean(0) ** 2).mean()), np.sqrt(apart.var(0, ddof=1).mean() / RUNS)
    print(f"{name}: apart {100 * distance:.2f} %, by noise alone {100 * noise:.2f} %")


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: pbrt_paths.py PBRT SRBF FILE")
    pbrt, program, file = (str(pathlib.Path(argument).resolve()) for argument in sys.argv[1:])
    pictures = {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        prepare(program, file, folder)
        print("material, start, us a path, variance of bright, of all")
        for name, material in MATERIALS.items():
            start = min(drawn(pbrt, material, 1, run, folder)[0] for run in range(RUNS))
            runs = [drawn(pbrt, material, PATHS, run, folder) for run in range(RUNS)]
            pictures[name] = np.array([picture for _, picture in runs])
            path = (min(took for took, _ in runs) - start) * 1e6 / ((PATHS - 1) * SIZE * SIZE)
            luminance = pictures[name][:, BALL] @ [0.2126, 0.7152, 0.0722]
            variance, mean = PATHS * luminance.var(0, ddof=1), luminance.mean(0)
            print(f"{name:15}{start:8.2f}{path:8.2f}{variance.mean() / mean.mean()**2:8.3f}{(variance / mean**2).mean():8.3f}", flush=True)
    for name in ("fit", "file"):
        compare(name, pictures[f"srbf, {name}"], pictures[f"measured, {name}"])


main()
