"""The BSDF for Mitsuba 3, where it is installed (`pip install mitsuba`); its vectorised variants need LLVM 16 or later."""
import os
import pathlib

import numpy as np
import pytest
import srbf

mi = pytest.importorskip("mitsuba")
DATA = pathlib.Path(os.environ["SRBF_SOURCE_DIR"]) / "data"


def directions(n, seed, least=0.05):
    w = np.random.default_rng(seed).normal(size=(n, 3))
    w[:, 2] = np.abs(w[:, 2]) + least
    return (w / np.linalg.norm(w, axis=-1, keepdims=True)).astype(np.float32)


def models():
    film, paper = DATA / "cc_ibiza_sunset_rgb.bsdf", DATA / "paper_white_rgb.bsdf"
    return {"film": srbf.fit(film).model, "gaussian": srbf.fit(paper, form="gaussian", lobes=4).model,
            "general": srbf.fit(film, axial=False, lobes=2, variates=2, objective="cosine").model,
            "ggx": srbf.fit(film, model="ggx", lobes=2).model, "paper": srbf.fit(paper, lobes=4).model}


@pytest.fixture(scope="module", params=["scalar_rgb", "llvm_ad_rgb"])
def variant(request):
    try:
        mi.set_variant(request.param)
        if request.param.startswith("llvm"):
            np.array(mi.Float([1.0, 2.0]) + 1)
    except Exception as error:
        pytest.skip(str(error))
    import srbf.mitsuba
    for name, model in all_models().items():
        srbf.mitsuba.register(name, model)
    return request.param


def all_models(made={}):
    if not made:
        made.update(models())
    return made


@pytest.mark.parametrize("name", ["film", "gaussian", "general", "ggx", "paper"])
def test_values_and_samples_are_the_librarys(variant, name):
    bsdf, model = mi.load_dict({"type": "srbf", "model": name}), all_models()[name]
    n = 100 if variant.startswith("scalar") else 20_000
    wi, wo, u = directions(n, 0), directions(n, 1), np.random.default_rng(2).random((n, 3), np.float32)
    context, si = mi.BSDFContext(), mi.SurfaceInteraction3f()
    if variant.startswith("scalar"):
        value, pdf, drawn, density = [], [], [], []
        for i in range(n):
            si.wi = wi[i]
            value.append(np.array(bsdf.eval(context, si, mi.Vector3f(wo[i]))))
            pdf.append(bsdf.pdf(context, si, mi.Vector3f(wo[i])))
            sample, _ = bsdf.sample(context, si, float(u[i, 2]), mi.Point2f(u[i, :2]))
            drawn.append(np.array(sample.wo))
            density.append(sample.pdf)
    else:
        si.wi = mi.Vector3f(wi.T)
        value = np.array(bsdf.eval(context, si, mi.Vector3f(wo.T))).T
        pdf = np.array(bsdf.pdf(context, si, mi.Vector3f(wo.T)))
        sample, _ = bsdf.sample(context, si, mi.Float(u[:, 2]), mi.Point2f(u[:, :2].T))
        drawn, density = np.array(sample.wo).T, np.array(sample.pdf)
    f = model.eval(wo, wi) * wo[:, 2:]
    np.testing.assert_allclose(value, f, rtol=1e-3, atol=1e-5 * f.max())
    np.testing.assert_allclose(pdf, model.pdf(wo, wi), rtol=1e-3, atol=1e-6)
    wl, _, expected = model.sample(wi, u)
    apart = np.abs(np.array(drawn) - wl).max(axis=-1) > 2e-3
    assert (apart & (expected > 0)).mean() <= 0.01  # selectors that fall between two lobes
    np.testing.assert_allclose(np.array(density)[~apart], expected[~apart], rtol=0.02, atol=1e-6)


@pytest.mark.parametrize("name", ["film", "gaussian", "general", "ggx", "paper"])
def test_mitsubas_own_test_of_samples(variant, name):
    if variant.startswith("scalar"):
        pytest.skip("it needs a vectorised variant")
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain
    for wi in ([0, 0, 1], [0.6, 0, 0.8], [0.3, -0.9, 0.3162]):
        sample, pdf = BSDFAdapter("srbf", f'<string name="model" value="{name}"/>', wi=wi)
        assert ChiSquareTest(SphericalDomain(), sample, pdf, sample_dim=3, res=101, ires=32).run(significance_level=0.002)


def test_a_sphere_is_rendered(variant, tmp_path):
    all_models()["film"].save(tmp_path / "film.srbf")
    size = 16
    scene = mi.load_dict({
        "type": "scene", "integrator": {"type": "path"}, "light": {"type": "constant"},
        "sensor": {"type": "perspective", "fov": 30, "to_world": mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0]),
                   "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}},
        "ball": {"type": "sphere", "bsdf": {"type": "srbf", "filename": str(tmp_path / "film.srbf")}}})
    picture = np.array(mi.render(scene, spp=256))
    # In uniform light the pixels in the middle, of a mean cosine of 0.99, have the albedo.
    np.testing.assert_allclose(picture[7:9, 7:9].mean(axis=(0, 1)), all_models()["film"].albedo(0.99), rtol=0.03)


def test_what_is_no_model_is_refused(variant):
    with pytest.raises(Exception, match="expected a model"):
        mi.load_dict({"type": "srbf", "filename": str(DATA / "paper_white_rgb.bsdf")})
