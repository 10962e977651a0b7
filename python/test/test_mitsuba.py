"""The BSDF for Mitsuba 3, if it is installed (`pip install mitsuba`). Its vectorised variants need LLVM 16 or later."""
import functools
import pathlib

import numpy as np
import pytest
import srbf
from test_srbf import directions, python_of, run

mi = pytest.importorskip("mitsuba")
DATA = pathlib.Path(__file__).parents[2] / "data"


@functools.cache
def all_models():
    film, paper = DATA / "cc_ibiza_sunset_rgb.bsdf", DATA / "paper_white_rgb.bsdf"
    fits = {"film": (film, {}), "as measured": (film, {"as_measured": True}), "gaussian": (paper, {"form": "gaussian", "lobes": 4}),
            "general": (film, {"axial": False, "lobes": 2, "variates": 2, "objective": "cosine"}),
            "ggx": (film, {"model": "ggx", "lobes": 2}), "surface": (film, {"model": "openpbr"}), "paper": (paper, {"lobes": 4})}
    return {name: srbf.fit(path, **options).model for name, (path, options) in fits.items()}


SCALAR, VECTORISED = "scalar_rgb", "llvm_ad_rgb"


@pytest.fixture(scope="module", params=[SCALAR, VECTORISED])
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


def only(name):
    """Marks a test that applies to this variant only."""
    return pytest.mark.parametrize("variant", [name], indirect=True)


@pytest.mark.parametrize("name", ["film", "gaussian", "general", "ggx", "surface", "paper"])
def test_values_and_samples_are_the_librarys(variant, name):
    bsdf, model = mi.load_dict({"type": "srbf", "model": name}), all_models()[name]
    n = 100 if variant.startswith("scalar") else 20_000
    wi, wo, u = directions(n, seed=0), directions(n, seed=1), np.random.default_rng(2).random((n, 3), np.float32)
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
    differs = np.abs(np.array(drawn) - wl).max(axis=-1) > 2e-3
    assert (differs & (expected > 0)).mean() <= 0.01  # selectors at the boundary between two lobes
    np.testing.assert_allclose(np.array(density)[~differs], expected[~differs], rtol=0.02, atol=1e-6)


@only(VECTORISED)
@pytest.mark.parametrize("name", ["film", "gaussian", "general", "ggx", "paper"])
def test_samples_pass_mitsubas_own_test(variant, name):
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
    # In uniform light, the central pixels have the albedo at their mean cosine, 0.99.
    np.testing.assert_allclose(picture[7:9, 7:9].mean(axis=(0, 1)), all_models()["film"].albedo(0.99), rtol=0.03)


def test_measurements_are_refused(variant):
    with pytest.raises(Exception, match="expected a model"):
        mi.load_dict({"type": "srbf", "filename": str(DATA / "paper_white_rgb.bsdf")})


NUMBERS = {"film": ("coefficient", "log_scale", "bandwidth", "parameterization", "exponent"),
           "gaussian": ("coefficient", "log_scale", "bandwidth", "parameterization"),
           "general": ("coefficient", "log_scale", "bandwidth", "parameterization", "exponent", "centre"),
           "ggx": ("diffuse", "roughness", "f0", "f90")}


@pytest.mark.parametrize("name", NUMBERS)
def test_parameters_are_the_numbers_of_the_model(variant, name):
    model = all_models()[name]
    bsdf = mi.load_dict({"type": "srbf", "model": name})
    parameters = mi.traverse(bsdf)
    assert set(parameters.keys()) == set(NUMBERS[name])
    for key in NUMBERS[name]:
        np.testing.assert_array_equal(np.array(parameters[key]), model.parameters[key])
    assert bsdf.model == model
    context, si = mi.BSDFContext(), mi.SurfaceInteraction3f()
    wi, wo = np.float32([0, 0.6, 0.8]), np.float32([0.1, -0.5, 0.8])
    wo /= np.linalg.norm(wo)
    si.wi = mi.Vector3f(wi)
    before = np.array(bsdf.eval(context, si, mi.Vector3f(wo))).ravel()
    brightness = "f0" if name == "ggx" else "coefficient"
    for key in (brightness, "diffuse") if name == "ggx" else (brightness, ):
        parameters[key] = mi.TensorXf(2 * np.array(parameters[key]))
    parameters.update()
    if name == "ggx":
        parameters["f90"] = mi.TensorXf(2 * np.array(parameters["f90"]))
        parameters.update()
    np.testing.assert_allclose(np.array(bsdf.eval(context, si, mi.Vector3f(wo))).ravel(), 2 * before, rtol=1e-3)
    np.testing.assert_array_equal(bsdf.model.parameters[brightness], 2 * model.parameters[brightness])
    np.testing.assert_allclose(bsdf.model.eval(wo, wi) * wo[2], 2 * before, rtol=1e-3)
    assert all_models()[name] == model


@only(VECTORISED)
@pytest.mark.parametrize("name", NUMBERS)
def test_values_are_differentiable(variant, name):
    import drjit as dr
    bsdf = mi.load_dict({"type": "srbf", "model": name})
    parameters = mi.traverse(bsdf)
    context, si = mi.BSDFContext(), mi.SurfaceInteraction3f()
    si.wi, wo = mi.Vector3f(directions(500, seed=3, least=0.3).T), mi.Vector3f(directions(500, seed=4, least=0.3).T)

    def mean(factor, key, start):
        parameters[key] = mi.TensorXf(mi.Float(start.ravel()) + factor * mi.Float(np.abs(start).ravel()), start.shape)
        parameters.update()
        return dr.mean(dr.ravel(bsdf.eval(context, si, wo)))

    for key in NUMBERS[name]:
        start = np.array(parameters[key])
        factor = mi.Float(0)
        dr.enable_grad(factor)
        dr.backward(mean(factor, key, start))
        step = 1e-3 / max(1.0, np.abs(start).max())
        difference = (mean(step, key, start)[0] - mean(-step, key, start)[0]) / (2 * step)
        mean(0.0, key, start)
        assert np.isfinite(dr.grad(factor)[0])
        assert dr.grad(factor)[0] == pytest.approx(difference, rel=0.05, abs=2e-3), key


def test_models_that_are_not_reciprocal_warn_once(variant, monkeypatch, recwarn):
    import srbf.mitsuba
    monkeypatch.setattr(srbf.mitsuba, "_warned", False)
    exchanged = all_models()["as measured"].exchanged()
    srbf.mitsuba.register("exchanged", exchanged)
    for name in ("exchanged", "film", "ggx"):  # the last two are reciprocal
        mi.load_dict({"type": "srbf", "model": name})
    assert not recwarn.list
    for _ in range(2):
        mi.load_dict({"type": "srbf", "model": "as measured"})
    assert len(recwarn.list) == 1 and "exchanged()" in str(recwarn.list[0].message)


@only(VECTORISED)
def test_an_old_llvm_is_named(variant, monkeypatch):
    import srbf.mitsuba
    monkeypatch.setattr(srbf.mitsuba, "_llvm_version", lambda: (15, 0, 6))
    with pytest.raises(Exception, match="expected LLVM 16 or later, found 15.0.6"):
        mi.load_dict({"type": "srbf", "model": "film"})


def test_unknown_names_are_refused(variant):
    with pytest.raises(Exception, match="register, found \"nobody\""):
        mi.load_dict({"type": "srbf", "model": "nobody"})


@only(SCALAR)
def test_scalar_variants_are_compiled(variant):
    import time
    context, si = mi.BSDFContext(), mi.SurfaceInteraction3f()
    si.wi, wo = [0, 0.6, 0.8], mi.Vector3f(0, -0.6, 0.8)
    bsdf = mi.load_dict({"type": "srbf", "model": "film"})
    bsdf.eval(context, si, wo)
    start = time.process_time()
    for _ in range(1000):
        bsdf.eval_pdf(context, si, wo)
    assert time.process_time() - start < 0.2  # 20 us per call; the printed formulas took a millisecond


@only(VECTORISED)
def test_the_code_of_the_page_runs(variant, monkeypatch, tmp_path):
    (tmp_path / "data").symlink_to(DATA)
    monkeypatch.chdir(tmp_path)
    names = {}
    exec("\n".join(python_of("docs/python.md")), names)
    assert not names["refined"].is_exchanged and set(names["optimiser"].keys()) <= set(names["parameters"].keys())


@only(VECTORISED)
def test_the_notebook_recovers_the_numbers(variant, monkeypatch, tmp_path):
    names = run("refine_in_mitsuba.ipynb", monkeypatch, tmp_path)
    np.testing.assert_allclose(np.array(names["optimiser"]["tint"]).ravel(), names["tint"], rtol=0.1)
    np.testing.assert_allclose(np.array(names["optimiser"]["sharpness"]), names["sharpness"], rtol=0.05)
    assert (tmp_path / "examples" / "refined.srbf").exists()
