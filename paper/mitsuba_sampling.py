"""mitsuba_sampling.py FILE.bsdf..: the relative variance of f cosθ / pdf, luminance, by Mitsuba's `measured`, which samples
RGL's tables, and by srbf: of the file, of the default fit, and of Lambert with one GGX lobe. Each samples its own values.
A viewer here is a light of the file, since `measured` takes them so; for srbf the file is exchanged.

First the relative RMS, at 4000 random pairs within 80°, between f cosθ of Mitsuba and of srbf, whose light is Mitsuba's `wi`
or `wo`, over positive values. Needs mitsuba of PyPI and the package srbf (docs/python.md)."""
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


def difference(bsdf, brdf):
    random = np.random.default_rng(1)
    z, phi = 1 - random.random((2, 4000)) * (1 - np.cos(np.radians(80))), 2 * np.pi * random.random((2, 4000))
    r = np.sqrt(1 - z * z)
    wi, wo = np.stack([r * np.cos(phi), r * np.sin(phi), z], -1).astype(np.float32)
    at = dr.zeros(mi.SurfaceInteraction3f, len(wi))
    at.wi = mi.Vector3f(wi.T)
    theirs = np.array(bsdf.eval(mi.BSDFContext(), at, mi.Vector3f(wo.T))).reshape(3, -1).T.clip(0)
    return [np.sqrt(((brdf.eval(*pair) * wo[:, 2:] - theirs) ** 2).sum() / (theirs**2).sum()) for pair in ((wi, wo), (wo, wi))]


def main():
    mi.set_variant("llvm_ad_rgb")
    u = np.random.default_rng(1).random((DRAWS, 3)).astype(np.float32)
    for path in sys.argv[1:]:
        apart = difference(mi.load_dict({"type": "measured", "filename": path}), srbf.load(path))
        print(f"{pathlib.Path(path).stem}: with wi as the light {apart[0]:.2g}, with wo {apart[1]:.2g}")
    print("file,sampled by," + ",".join(map(str, DEGREES)))
    for path in sys.argv[1:]:
        bsdf = mi.load_dict({"type": "measured", "filename": path})
        rows = {"RGL's tables, in Mitsuba": lambda wv: by_mitsuba(bsdf, wv, u)}
        table = srbf.load(path).exchanged()
        rows["the file, by srbf"] = lambda wv: table.sample(np.broadcast_to(wv, (DRAWS, 3)), u)[1]
        for name, options in (("default fit", {}), ("Lambert and GGX", {"model": "ggx"})):
            model = srbf.fit(path, **options).model
            rows[name] = lambda wv, model=model: model.sample(np.broadcast_to(wv, (DRAWS, 3)), u)[1]
        for name, weights in rows.items():
            views = [(np.sin(t), 0, np.cos(t)) for t in np.radians(DEGREES)]
            print(pathlib.Path(path).stem, name, *(f"{variance(weights(np.array(wv))):.4f}" for wv in views), sep=",", flush=True)


if __name__ == "__main__":
    main()
