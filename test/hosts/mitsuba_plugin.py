"""Checks the plugin of examples/mitsuba in the variant scalar_rgb.

The plugin is built with the installed library of PROGRAM's build, for the Mitsuba of this Python. Checks:
  - The picture of a sphere under a directional light is that of the model.
  - The picture of a measurement is that of Mitsuba's `measured`.
  - Values are those of `srbf eval`.
  - Samples have the density and the weights that the other functions return, on both sides of a BSDF, too.
  - Samples follow the brushing of an anisotropic surface.
  - An input that the plugin refuses gives a message of one line.

Usage: mitsuba_plugin.py PROGRAM. The test is skipped without mitsuba or nanobind.
"""
# needs: numpy1 mitsuba nanobind
import importlib.util
import math
import subprocess
import sys
import tempfile
from importlib.metadata import version

from support.checks import ROOT, arguments, expect, finish, skip

if not all(map(importlib.util.find_spec, ("mitsuba", "nanobind"))):
    skip("no mitsuba or nanobind")
from support import lit_sphere
import mitsuba as mi
import numpy as np
from support.visible_error import delta_e

program, film = arguments()[0], ROOT / "data/cc_ibiza_sunset_rgb.bsdf"
CELLS, FINER, SAMPLES = (48, 48), 10, 100000  # of cosθ and φ; points along an edge of a cell, by which its integrals are found
GLOSSY = int(mi.BSDFFlags.GlossyReflection), int(mi.BSDFFlags.GlossyTransmission)
STRAIGHT = {int(mi.BSDFFlags.Null): np.array([-1, -1, -1]), int(mi.BSDFFlags.DeltaReflection): np.array([-1, -1, 1])}  # beams: wo of wi


def run(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout[-3000:] + done.stderr[-3000:])


def film_of(size):
    return {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb", "component_format": "float32",
            "rfilter": {"type": "box"}}


def picture_of(bsdf):
    camera = mi.ScalarTransform4f().look_at(origin=[0, 0, lit_sphere.DISTANCE], target=[0, 0, 0], up=[0, 1, 0])
    return np.array(mi.render(mi.load_dict({
        "type": "scene", "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0},
        "light": {"type": "directional", "direction": list(-lit_sphere.TO_LIGHT),
                  "irradiance": {"type": "rgb", "value": lit_sphere.IRRADIANCE}},
        "ball": {"type": "sphere", "bsdf": bsdf},
        "camera": {"type": "perspective", "fov": math.degrees(2 * lit_sphere.HALF_FIELD), "to_world": camera,
                   "film": film_of(lit_sphere.SIZE), "sampler": {"type": "stratified", "sample_count": 16}},
    })), dtype=float)


def refusal(bsdf):
    try:
        mi.load_dict(bsdf)
    except RuntimeError as error:
        return str(error)
    return ""


def directions(z, phi):
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], -1)


def interaction(wi):
    at = mi.SurfaceInteraction3f()
    at.wi = mi.Vector3f(*map(float, wi))
    return at


def integrals(bsdf, at):
    """Returns the integrals of density and value (green) over cells of the sphere, by the midpoints of smaller cells."""
    z = (np.arange(CELLS[0] * FINER) + 0.5) / (CELLS[0] * FINER) * 2 - 1
    phi = (np.arange(CELLS[1] * FINER) + 0.5) / (CELLS[1] * FINER) * 2 * np.pi
    points = directions(*np.meshgrid(z, phi, indexing="ij")).reshape(-1, 3).tolist()
    both = [bsdf.eval_pdf(mi.BSDFContext(), at, mi.Vector3f(*wo)) for wo in points]
    area = 4 * np.pi / (CELLS[0] * CELLS[1] * FINER**2)
    values = np.array([(density, value[1]) for value, density in both]) * area
    return values.reshape(CELLS[0], FINER, CELLS[1], FINER, 2).sum((1, 3))


def uniform_numbers(count):
    return np.random.default_rng(1).random((count, 3)).astype(np.float32).clip(0, np.float32(1 - 2**-24)).tolist()


def relative_variance(bsdf, z):
    """Returns the mean weight of samples over azimuths of the viewer."""
    views = [interaction(directions(np.array(z), np.array(phi))) for phi in np.arange(8) * np.pi / 4]
    weights = np.array([[bsdf.sample(mi.BSDFContext(), at, a, mi.Point2f(b, c))[1][1] for a, b, c in uniform_numbers(4000)]
                        for at in views])
    return float((weights.var(1) / weights.mean(1)**2).mean())


def check_samples(name, bsdf, wi):
    """Checks samples by the density (χ²) and by the integral of the value. Returns the mean of all weights, with beams."""
    at, context = interaction(wi), mi.BSDFContext()
    drawn = [bsdf.sample(context, at, a, mi.Point2f(b, c)) for a, b, c in uniform_numbers(SAMPLES)]
    scattered = [(s, weight[1]) for s, weight in drawn if s.sampled_type in GLOSSY]
    beams = [(s, weight[1]) for s, weight in drawn if s.sampled_type in STRAIGHT]
    agree = all(abs(bsdf.pdf(context, at, s.wo) - s.pdf) <= 1e-3 * s.pdf and
                abs(bsdf.eval(context, at, s.wo)[1] - weight * s.pdf) <= 1e-3 * weight * s.pdf + 1e-6 for s, weight in scattered[::20])
    agree = agree and all(np.allclose(s.wo, STRAIGHT[s.sampled_type] * wi, atol=1e-6) for s, _ in beams)
    wo = np.array([s.wo for s, _ in scattered])
    rows = np.floor((wo[:, 2] + 1) / 2 * CELLS[0]).clip(0, CELLS[0] - 1)
    columns = np.floor(np.arctan2(wo[:, 1], wo[:, 0]) / (2 * np.pi) % 1 * CELLS[1])
    found = np.histogram2d(rows, columns, bins=CELLS, range=[[0, CELLS[0]], [0, CELLS[1]]])[0].ravel()
    cell_integrals = integrals(bsdf, at)
    expected = SAMPLES * cell_integrals[..., 0].ravel()
    # Cells with few samples are pooled, and so are samples that are not scattered.
    many = expected >= 10
    expected, found = (np.concatenate([counts[many], [counts[~many].sum(), SAMPLES - counts.sum()]]) for counts in (expected, found))
    statistic, freedom = ((found - expected)**2 / np.maximum(expected, 10)).sum(), len(found) - 1
    deviations = ((statistic / freedom)**(1 / 3) - 1 + 2 / (9 * freedom)) / math.sqrt(2 / (9 * freedom))  # of a normal distribution
    weights, beam_weights = (np.array([weight for _, weight in kind]) for kind in (scattered, beams))
    mean, integral = weights.sum() / SAMPLES, cell_integrals[..., 1].sum()
    expect(agree and deviations < 3.5 and abs(mean - integral) < 4 * math.sqrt((weights**2).sum()) / SAMPLES + 0.003 * integral,
           f"{name}, cosθ {wi[2]:+.1f}: χ² is {deviations:+.1f} deviations off, mean of weights {mean:.4f}, integral "
           f"{integral:.4f}; {len(beams)} beams")
    return mean + beam_weights.sum() / SAMPLES


def seen_in_white(bsdf, wi):
    """Returns the path-traced radiance (green) of a flat surface in white surroundings, which is its albedo for this viewer, with beams."""
    return np.array(mi.render(mi.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": 3},
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": 1}},
        "surface": {"type": "rectangle", "to_world": mi.ScalarTransform4f().scale(100), "bsdf": bsdf},
        "camera": {"type": "orthographic", "film": film_of(8),
                   "to_world": mi.ScalarTransform4f().look_at((10 * wi).tolist(), [0, 0, 0], [0, 1, 0])},
    }), spp=4096))[..., 1].mean()


with tempfile.TemporaryDirectory() as folder:
    run("cmake", "--install", program.parent, "--prefix", f"{folder}/prefix")
    run("cmake", "-G", "Ninja", "-S", ROOT / "examples/mitsuba", "-B", f"{folder}/plugin", f"-DCMAKE_PREFIX_PATH={folder}/prefix",
        f"-DPython_EXECUTABLE={sys.executable}")
    run("cmake", "--build", f"{folder}/plugin")
    mi.set_variant("scalar_rgb")
    mi.file_resolver().append(f"{folder}/plugin")
    mi.set_log_level(mi.LogLevel.Error)
    model = f"{folder}/film.srbf"
    run(program, "fit", film, "-o", model)

    inside, plugin, measured = lit_sphere.points()[0], {"type": "srbf_cpp", "filename": model}, {"type": "measured", "filename": str(film)}
    file_bsdf = {"type": "srbf_cpp", "filename": str(film), "exchange": True}
    apart = lit_sphere.picture_error(picture_of(plugin), lit_sphere.reference(program, model, folder))
    expect(apart < 0.2, f"Mitsuba {version('mitsuba')}: the picture differs from the model by a ΔE_ITP of {apart:.3f}")
    apart = delta_e(picture_of(file_bsdf)[inside], picture_of(measured)[inside])
    expect(apart < 0.2, f"the picture of the file differs from that of `measured` by {apart:.3f}")

    pairs = lit_sphere.pairs()[::999]
    pairs = pairs[(pairs[:, 2] > 0.05) & (pairs[:, 5] > 0.05)]
    bsdf = mi.load_dict(plugin)
    values = np.array([bsdf.eval(mi.BSDFContext(), interaction(pair[3:]), mi.Vector3f(*pair[:3].tolist())) for pair in pairs])
    np.testing.assert_allclose(values * lit_sphere.IRRADIANCE, lit_sphere.reflected(program, model, pairs, folder), rtol=2e-4, atol=1e-6)
    print("ok   values are those of `srbf eval`")

    for name, material in (("default", plugin), ("the file", file_bsdf),
                           ("BSDF", {"type": "srbf_cpp", "filename": str(ROOT / "test/models/1/bsdf.srbf")})):
        bsdf = mi.load_dict(material)
        for z in (0.9, 0.3) if name != "BSDF" else (0.7, -0.4):
            wi = directions(np.array(z), np.array(0.5))
            albedo, seen = check_samples(name, bsdf, wi), seen_in_white(material, wi)
            expect(abs(seen - albedo) < 0.01 * albedo,
                   f"its radiance in white surroundings is {seen:.4f}, the mean of all weights {albedo:.4f}")
    run(program, "convert", ROOT / "test/models/1/openpbr_brushed.srbf", "-o", f"{folder}/brushed.csv")
    variance = relative_variance(mi.load_dict({"type": "srbf_cpp", "filename": f"{folder}/brushed.csv"}), 0.7)
    expect(variance < 0.6,
           f"samples follow a brushed surface: their relative variance at 45° is {variance:.2f} (0.87 by a density that does not)")
    back, zero = interaction([0.6, 0, -0.8]), mi.load_dict(plugin)
    both = mi.load_dict({"type": "twosided", "bsdf": plugin})
    expect(not any(zero.eval(mi.BSDFContext(), back, mi.Vector3f(0, 0, z))[1] for z in (1, -1)) and
           zero.sample(mi.BSDFContext(), back, 0.5, mi.Point2f(0.3, 0.7))[1][1] == 0, "a BRDF is black from the back")
    expect(both.eval(mi.BSDFContext(), back, mi.Vector3f(0, 0, -1))[1] > 0, "with `twosided` it is not")

    error = refusal({"type": "srbf_cpp", "filename": f"{folder}/absent.srbf"})
    expect("absent.srbf" in error and "\n" not in error.strip(), f"a file that is not there: {error.strip()}")
    mi.set_variant("scalar_spectral")
    error = refusal(plugin)
    expect("srbf_cpp" in error and "scalar_spectral" in error, f"another variant: {error.strip()}")
finish()
