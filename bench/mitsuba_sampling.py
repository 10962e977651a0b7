"""mitsuba_sampling.py FILE.bsdf...: the relative variance of f cosθ / pdf, luminance, by Mitsuba's `measured`, which samples the
tables that RGL's format has for it, and by srbf's default fit and Lambert with one GGX lobe. Each samples its own values.

A viewer here is a light of the file, since `measured` takes them so. Needs mitsuba of PyPI and the package srbf (docs/python.md)."""
import pathlib
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

import srbf

DRAWS = 1 << 18
DEGREES = 5, 45, 60, 75, 85
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def variance(weight):
    weight = weight @ LUMINANCE
    return weight.var() / weight.mean() ** 2


def by_mitsuba(bsdf, wv, u):
    at = dr.zeros(mi.SurfaceInteraction3f, DRAWS)
    at.wi = mi.Vector3f(*map(float, wv))
    _, weight = bsdf.sample(mi.BSDFContext(), at, mi.Float(u[:, 2]), mi.Point2f(u[:, 0], u[:, 1]))
    return np.array(weight).reshape(3, DRAWS).T


def main():
    mi.set_variant("llvm_ad_rgb")
    u = np.random.default_rng(1).random((DRAWS, 3)).astype(np.float32)
    print("file,sampled by," + ",".join(map(str, DEGREES)))
    for path in sys.argv[1:]:
        bsdf = mi.load_dict({"type": "measured", "filename": path})
        rows = {"RGL's tables, in Mitsuba": lambda wv: by_mitsuba(bsdf, wv, u)}
        for name, options in (("default fit", {}), ("Lambert and GGX", {"model": "ggx"})):
            model = srbf.fit(path, **options).model
            rows[name] = lambda wv, model=model: model.sample(np.broadcast_to(wv, (DRAWS, 3)), u)[1]
        for name, weights in rows.items():
            views = [(np.sin(t), 0, np.cos(t)) for t in np.radians(DEGREES)]
            print(pathlib.Path(path).stem, name, *(f"{variance(weights(np.array(wv))):.4f}" for wv in views), sep=",", flush=True)


if __name__ == "__main__":
    main()
