"""mitsuba_paths.py [--picture TO.jpg] PROGRAM PLUGINS FILE.bsdf..: compares times and noise of paths in Mitsuba 3, scalar_rgb.

PROGRAM is `srbf`, PLUGINS the folder of the compiled plugin of examples/mitsuba, FILE an RGL file. A ball on a floor of the
same material, Mitsuba's or the plugin's, is lit by a window and a sky, or by an environment. For each material it prints:
  - microseconds of processor time of a path of one vertex and of at most five, the least of RUNS
  - the relative variance of the luminance of a path of at most five vertices, and its product with the time, in two ways:
    the mean variance of the pixels over the square of their mean, where bright pixels count most, and the mean of their
    relative variances
  - the mean of the picture, and its distance from that of `measured` in units of noise, RMS over pixels: 1 if they agree.
`measured` takes the first direction of a file for the viewer, so light and viewer are exchanged for srbf.

With --picture it draws `measured`, the default fit, and Lambert with GGX after equal time; below them are the file and the
visible errors of both models without noise. Needs mitsuba and numpy of PyPI, and Pillow for the picture. Use one core:
taskset -c 1 python bench/mitsuba_paths.py .."""
import pathlib
import subprocess
import sys
import tempfile
import time

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "test"))
from support import visible_error  # noqa: E402

SIZE, PATHS, RUNS = 256, 16, 5
EQUAL, CONVERGED, DARKEST = 8, 64, 40  # of a picture: paths of `measured`, runs without visible noise, the ΔE_ITP that is drawn black
# Indices of the channels of `moment` that have the luminance and its square.
Y, SQUARE = 4, 7
ENVIRONMENT = pathlib.Path(__file__).resolve().parent.parent / "data/studio.hdr"


def grey(value):
    return {"type": "rgb", "value": 3 * [value]}


def scene_of(bsdf, lights, vertices):
    at, flat = mi.ScalarTransform4f().look_at, mi.ScalarTransform4f().rotate([1, 0, 0], -90)
    emitters = {"sky": {"type": "envmap", "filename": str(ENVIRONMENT)}} if lights == "environment" else {
        "sky": {"type": "constant", "radiance": grey(0.3)},
        "window": {"type": "rectangle", "to_world": at([-3, 4, 3], [0, 1, 0], [0, 1, 0]), "light": {"type": "area", "radiance": grey(9)}},
    }
    return mi.load_dict({
        "type": "scene", **emitters,
        # `moment` adds squares of colours to the film, and a film with them does not warn of negative values, which takes time.
        "integrator": {"type": "moment", "nested": {"type": "path", "max_depth": vertices + 1, "rr_depth": 100}},
        "floor": {"type": "rectangle", "to_world": flat @ mi.ScalarTransform4f().scale(50), "bsdf": bsdf},
        "ball": {"type": "sphere", "center": [0, 1, 0], "bsdf": bsdf},
        "camera": {"type": "perspective", "fov": 35, "to_world": at([0, 3, 5], [0, 0.8, 0], [0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                            "component_format": "float32"}},
    })


def drawn(scene, seed, paths=PATHS):
    """Returns the processor time of a picture [s], and the picture: means of colour, luminance and its square over a pixel's paths."""
    begin = time.process_time()
    picture = mi.render(scene, spp=paths, seed=seed)
    took = time.process_time() - begin
    return took, np.array(picture).astype(float)[..., [0, 1, 2, Y, SQUARE]]


def materials_of(program, file, folder):
    fits = {name: f"{folder}/{name}.srbf" for name in ("default", "exchanged", "ggx")}
    for name, options in (("default", []), ("exchanged", ["--as-measured", "--exchange"]), ("ggx", ["--model", "ggx"])):
        subprocess.run([program, "fit", file, *options, "-o", fits[name]], check=True, stdout=subprocess.DEVNULL)
    return {
        "diffuse": {"type": "diffuse"},
        "roughconductor, GGX": {"type": "roughconductor", "distribution": "ggx", "alpha": 0.2},
        "principled": {"type": "principled", "roughness": 0.4, "metallic": 0.5},
        "measured": {"type": "measured", "filename": file},
        "srbf, the file": {"type": "srbf_cpp", "filename": file, "exchange": True},
        "srbf, default": {"type": "srbf_cpp", "filename": fits["default"]},
        "srbf, --as-measured": {"type": "srbf_cpp", "filename": fits["exchanged"]},
        "srbf, --model ggx": {"type": "srbf_cpp", "filename": fits["ggx"]},
    }


def compare(materials, lights):
    scenes = {name: [scene_of(bsdf, lights, vertices) for vertices in (1, 5)] for name, bsdf in materials.items()}
    runs = [[[drawn(scene, run) for scene in group] for group in scenes.values()] for run in range(RUNS)]
    times = np.array([[[took for took, _ in group] for group in run] for run in runs]).min(0) * 1e6 / (SIZE * SIZE * PATHS)
    mean, square = (np.mean([[group[1][1][..., i] for group in run] for run in runs], axis=0) for i in (3, 4))
    variance = np.maximum(square - mean**2, 1e-9 * mean**2) * RUNS * PATHS / (RUNS * PATHS - 1)  # squares are rounded
    measured = list(materials).index("measured")
    for i, name in enumerate(materials):
        relative = np.array([variance[i].mean() / mean[i].mean()**2, (variance[i] / mean[i]**2).mean()])
        noise = np.sqrt((variance[i] + variance[measured]) / (RUNS * PATHS))
        apart = np.sqrt((((mean[i] - mean[measured]) / noise) ** 2).mean())
        numbers = *times[i], *relative, *(relative * times[i][1]), mean[i].mean(), apart
        print(f"{name:20}" + "".join(f"{number:9.3f}" for number in numbers), flush=True)


def draw_equal_time(materials, to):
    from PIL import Image, ImageDraw, ImageFont

    chosen = {"measured, by the file": "measured", "srbf, the default": "srbf, default", "Lambert and GGX": "srbf, --model ggx"}
    scenes = [scene_of(materials[name], "window", 5) for name in chosen.values()]
    runs = [[drawn(scene, run) for scene in scenes] for run in range(CONVERGED)]
    seconds = np.array([[took for took, _ in run] for run in runs]).min(0)
    converged = np.mean([[picture for _, picture in run] for run in runs], axis=0)[..., :4]
    file, font = converged[0, ..., :3], ImageFont.load_default(15)
    exposed = visible_error.exposure(file.reshape(-1, 3))
    sheet = Image.new("RGB", (SIZE * len(chosen), 2 * (SIZE + 44)), "white")

    def add(column, row, pixels, text):
        sheet.paste(Image.fromarray(pixels), (column * SIZE, row * (SIZE + 44)))
        ImageDraw.Draw(sheet).text((column * SIZE + 6, row * (SIZE + 44) + SIZE + 3), text, fill="black", font=font)

    for i, label in enumerate(chosen):
        paths = round(EQUAL * seconds[0] / seconds[i])
        noisy = drawn(scenes[i], CONVERGED, paths)[1][..., :4]
        noise = np.sqrt(((noisy / converged[i] - 1)[..., 3] ** 2).mean())
        add(i, 0, visible_error.displayed(noisy[..., :3], exposed), f"{label}:\n{paths} paths in equal time, noise {100 * noise:.0f} %")
        apart = np.linalg.norm(np.subtract(*(visible_error.itp(np.clip(exposed * picture, 0, 1))
                                             for picture in (converged[i, ..., :3], file))), axis=-1)
        print(f"{label}: {1e6 * seconds[i] / (SIZE * SIZE * PATHS):.2f} us, {paths} paths, noise {noise:.3f}, "
              f"visible error {apart.mean():.1f}", flush=True)
        if i == 0:
            text = f"measured, after\n{CONVERGED * PATHS} paths: almost no noise"
            add(i, 1, visible_error.displayed(file, exposed), text)
            continue
        errors = np.repeat(255 - 255 * np.minimum(apart / DARKEST, 1), 3).reshape(SIZE, SIZE, 3).astype(np.uint8)
        add(i, 1, errors, f"its visible error without noise:\nmean {apart.mean():.1f}, black {DARKEST} or more")
    sheet.save(to, quality=50, optimize=True)


def main():
    arguments = sys.argv[1:]
    to = arguments[1] if arguments[0] == "--picture" else None
    program, plugins, *files = arguments[2 if to else 0:]
    dr.set_thread_count(1)
    mi.file_resolver().append(plugins)
    for file in files:
        with tempfile.TemporaryDirectory() as folder:
            materials = materials_of(program, file, folder)
            if to:
                draw_equal_time(materials, to)
                continue
            for lights in ("window", "environment"):
                print(f"{pathlib.Path(file).stem}, {lights}: us of one vertex, of five, variance of bright, of all, x us, x us, "
                      "mean, distance")
                compare(materials, lights)


main()
