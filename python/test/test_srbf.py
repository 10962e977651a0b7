"""The package on the bundled measurements."""
import inspect
import os
import pathlib
import pickle
import re
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import srbf

DATA = pathlib.Path(__file__).parents[2] / "data"
PAPER, FILM = DATA / "paper_white_rgb.bsdf", DATA / "cc_ibiza_sunset_rgb.bsdf"


def directions(*shape, seed=0, least=0.05):
    w = np.random.default_rng(seed).normal(size=shape + (3,))
    w[..., 2] = np.abs(w[..., 2]) + least
    return (w / np.linalg.norm(w, axis=-1, keepdims=True)).astype(np.float32)


@pytest.fixture(scope="module")
def paper():
    return srbf.load(PAPER)


@pytest.fixture(scope="module")
def facets(paper):
    """A quick fit, for tests that any model serves."""
    return srbf.fit(paper, model="ggx", lobes=1, objective="raw").model


@pytest.fixture(scope="module", params=["gaussian", "extended", "reciprocal", "general", "su", "ggx"])
def model(request, paper):
    few = {"lobes": 2, "variates": 2}
    options = {"su": {"model": "su", "lobes": 1}, "ggx": {"model": "ggx", "lobes": 2}, "general": {"axial": False, **few}}
    return srbf.fit(paper, objective="cosine", **options.get(request.param, {"form": request.param, **few})).model


def by_formula(model, wl, wv, one_side=False):
    """Evaluates the formulas of docs/formats.md in NumPy. `one_side`: the sum of lobes of a reciprocal model, not the mean of both."""
    p = model.parameters
    if model.kind == "ggx":
        h = wl + wv
        length2 = (h * h).sum(-1)
        value = np.zeros(wl.shape) + p["diffuse"] / np.pi
        for alpha, f0, f90 in zip(p["roughness"], p["f0"], p["f90"]):
            a2, cl, cv = alpha**2, wl[:, 2], wv[:, 2]
            slope = (h[:, 0]**2 + h[:, 1]**2 + a2 * h[:, 2]**2) / length2
            masking = cv * np.sqrt(a2 + (1 - a2) * cl**2) + cl * np.sqrt(a2 + (1 - a2) * cv**2)
            schlick = (1 - np.sqrt(length2) / 2)[:, None]**5
            value += (a2 / (2 * np.pi * slope**2 * masking))[:, None] * (f0 + (f90 - f0) * schlick)
        return value
    if p["form"] == "reciprocal" and not one_side:
        return (by_formula(model, wl, wv, True) + by_formula(model, wv, wl, True)) / 2
    a, b = p["parameterization"].T
    psi = a[:, None] * wl[:, None] + b[:, None] * wv[:, None]
    psi /= np.linalg.norm(psi, axis=-1, keepdims=True)
    exponent = p["log_scale"] + np.einsum("jn,ijn->ij", p["bandwidth"], np.einsum("ink,jnk->ijn", psi, p["centre"]) - 1)
    h = wl + wv
    length = np.linalg.norm(h, axis=-1)
    across = (h[:, 0]**2 + h[:, 1]**2) / length**2
    x = np.stack([np.log(wl[:, 2] * wv[:, 2]), length / 2 - 1,
                  1 / 20 - np.sqrt((wl[:, 2] - wv[:, 2])**2 + across / 16 + 1 / 400), -np.sqrt(across)], -1)
    terms = p["exponent"].shape[1]
    return np.exp(exponent + x[:, :terms] @ p["exponent"].T) @ p["coefficient"]


def test_values_are_those_of_the_formula(model):
    if model.kind == "su":
        pytest.skip("an interpolation")
    wl, wv = directions(2000).astype(float), directions(2000, seed=1).astype(float)
    expected = by_formula(model, wl, wv)
    np.testing.assert_allclose(model.eval(wl, wv), expected, rtol=2e-4, atol=1e-6 * expected.max())


def test_results_have_the_shape_and_type_of_the_input(model):
    wl, wv = directions(4, 5), directions(5, seed=1)
    f = model.eval(wl, wv)
    assert f.shape == (4, 5, 3) and f.dtype == np.float32
    for other in (wl.astype(float), np.asfortranarray(wl), wl[::-1][::-1], wl.tolist()):
        np.testing.assert_array_equal(model.eval(other, wv), f)
    frozen = wl.copy()
    frozen.flags.writeable = False
    np.testing.assert_array_equal(model.eval(frozen, wv), f)
    np.testing.assert_array_equal(model.eval(wl[0, 0], wv[0]), f[0, 0])
    assert model.eval(wl[:0], wv).shape == (0, 5, 3)
    assert (model.eval(-wl, wv) == 0).all()
    assert model.eval_spectral(wl, wv).shape == (4, 5, 3) and model.wavelengths.shape == (0,)


def test_contiguous_arrays_are_not_copied():
    wl = directions(7)
    _, rows = srbf._pairs(wl, wl)
    assert all(np.shares_memory(row, wl) for row in rows)


def test_light_and_viewer_are_exchanged(model, paper):
    wl, wv = directions(100), directions(100, seed=1)
    for brdf in (model, paper, srbf.from_arrays(wl, wv, np.linspace(0.1, 0.2, 100))):
        np.testing.assert_allclose(brdf.exchanged().eval(wv, wl), brdf.eval(wl, wv), rtol=1e-4, atol=1e-7)


def test_samples_follow_the_density(model):
    wv = np.broadcast_to(directions(1)[0], (200_000, 3))
    wl, weight, density = model.sample(wv, rng=np.random.default_rng(1))
    assert np.allclose(np.linalg.norm(wl, axis=-1), 1, atol=1e-3) and density.shape == (200_000,)
    np.testing.assert_allclose(model.pdf(wl, wv), density, rtol=1e-4)
    hit = density > 0
    expected = (model.eval(wl, wv) * wl[:, 2:])[hit] / density[hit, None]
    np.testing.assert_allclose(weight[hit], expected, rtol=1e-3, atol=1e-6)
    assert (weight[~hit] == 0).all()
    error = weight.std(axis=0) / np.sqrt(len(wv))
    assert (np.abs(weight.mean(axis=0) - model.albedo(wv[0, 2])) < 5 * error + 0.005).all()
    # The density integrates to the fraction of samples with a valid direction.
    uniform = directions(200_000, seed=2, least=0)
    assert abs(2 * np.pi * model.pdf(uniform, wv).mean() - hit.mean()) < 0.05


def test_a_model_is_saved_pickled_and_converted(model, tmp_path):
    wl, wv = directions(50), directions(50, seed=1)
    model.save(tmp_path / "m.srbf")
    again, copy = srbf.load(tmp_path / "m.srbf"), pickle.loads(pickle.dumps(model))
    assert isinstance(again, srbf.Model) and again.kind == model.kind and again.nbytes == model.nbytes
    for other in (again, copy):
        np.testing.assert_array_equal(other.eval(wl, wv), model.eval(wl, wv))
    if model.kind == "ggx":
        srbf.convert(model, tmp_path / "m.binary")
        table = srbf.load(tmp_path / "m.binary")
        assert isinstance(table, srbf.Measurement) and table.format == "MERL"
        assert srbf.errors(model, table, max_theta=60)["heldout_squared_error_ratio_cosine"] < 0.02


def test_a_fit_reports_what_the_program_reports(paper):
    fit = srbf.fit(paper, lobes=2, variates=2)
    assert fit.reached and fit.stop_reason and fit.model.nbytes == 48
    assert fit.model.provenance["source"].endswith("paper_white_rgb.bsdf")
    assert float(fit.model.provenance["delta_e_itp"]) == pytest.approx(fit.errors["delta_e_itp"], rel=1e-3)
    same = srbf.fit(PAPER, lobes=2, variates=2, threads=1)
    np.testing.assert_array_equal(same.model.parameters["coefficient"], fit.model.parameters["coefficient"])
    errors = srbf.errors(paper, fit.model, max_theta=89)
    assert errors["heldout_cube_root_error_ratio"] == pytest.approx(fit.errors["heldout_cube_root_error_ratio"], rel=1e-5)
    assert set(errors["lightings"]) == set(srbf.lightings())
    assert srbf.errors(paper, paper)["delta_e_itp"] == 0


def test_errors_of_functions_are_those_of_their_values(paper, facets):
    model_errors, function_errors = srbf.errors(paper, facets), srbf.errors(paper, lambda wl, wv: facets.eval(wl, wv))
    for name in ("delta_e_itp", "rms", "heldout_squared_error_ratio_cosine", "albedo_error"):
        assert function_errors[name] == pytest.approx(model_errors[name], rel=1e-3)
    with pytest.raises(KeyError):
        srbf.errors(paper, lambda wl, wv: {}["missing"])
    with pytest.raises(TypeError, match="other: expected a BRDF or a function, found str"):
        srbf.errors(paper, "paper.srbf")


def test_missing_values_are_left_out():
    wl, wv, f = directions(300), directions(300, seed=1), np.full((300, 3), 0.25)
    hidden = np.arange(300) % 7 == 0
    for missing in (np.where(hidden[:, None], -999, f), np.ma.masked_array(f, np.broadcast_to(hidden[:, None], f.shape))):
        known = srbf.from_arrays(wl[~hidden], wv[~hidden], f[~hidden])
        np.testing.assert_array_equal(srbf.from_arrays(wl, wv, missing).eval(wl, wv), known.eval(wl, wv))


def test_functions_and_arrays_are_fitted():
    def lambert(wl, wv):
        assert wl.shape == wv.shape and wl.dtype == np.float32
        return np.full((len(wl), 1), 0.5 / np.pi)

    fit = srbf.fit(lambert, lobes=1, variates=1)
    np.testing.assert_allclose(fit.model.eval(directions(100), directions(100, seed=1)), 0.5 / np.pi, rtol=0.01)
    wl, wv = directions(300), directions(300, seed=1)
    samples = srbf.from_arrays(wl, wv, np.full(300, 0.25))
    np.testing.assert_allclose(samples.eval(wl, wv), 0.25, rtol=1e-4)


def test_progress_is_reported_and_can_cancel(paper):
    calls = []
    srbf.fit(paper, lobes=2, variates=2, progress=lambda stage, fraction: calls.append((stage, fraction)))
    assert calls and all(0 <= fraction <= 1 for _, fraction in calls) and [f for _, f in calls] == sorted(f for _, f in calls)
    with pytest.raises(srbf.Error) as caught:
        srbf.fit(paper, progress=lambda stage, fraction: False)
    assert caught.value.code == "cancelled"
    with pytest.raises(ZeroDivisionError):
        srbf.fit(paper, progress=lambda stage, fraction: 1 / 0)
    with pytest.raises(KeyError):
        srbf.fit(lambda wl, wv: {}["missing"])


def test_numbers_just_below_one_are_uniform(facets):
    u = np.full((4, 3), np.nextafter(1.0, 0))
    wv = np.broadcast_to(np.float32([0, 0, 1]), (4, 3))
    largest = np.full((4, 3), np.nextafter(np.float32(1), np.float32(0)))
    for ours, expected in zip(facets.sample(wv, u), facets.sample(wv, largest)):
        np.testing.assert_array_equal(ours, expected)
    for wrong in (1.0, -0.1, np.nan):
        with pytest.raises(ValueError, match="^u: "):
            facets.sample(wv, np.full((4, 3), wrong))


class NotRead(srbf.Measurement):
    """A measurement whose values must not be read."""

    def __init__(self):
        pass

    @property
    def _native(self):
        raise AssertionError("the measurement was read before the options")


@pytest.mark.parametrize("name, value, options", [
    ("model", "mlp", {}), ("channels", "bogus", {}), ("channels", "spectral", {"model": "ggx"}),
    ("max_theta", 0, {}), ("max_theta", 90, {}), ("max_theta", np.nan, {}), ("max_theta", "80", {}), ("progress", 5, {}),
    ("progress", "yes", {}), ("lobes", "many", {}), ("lobes", 0, {}), ("lobes", 65, {}), ("lobes", 2.5, {}), ("lobes", True, {}),
    ("lobes", 3, {"model": "ggx"}), ("lobes", "auto", {"model": "su"}), ("lobes", 65, {"model": "su"}), ("seed", -1, {}),
    ("seed", 2**64, {}), ("seed", 1.5, {}), ("threads", -1, {}), ("threads", 1025, {}), ("variates", 0, {}), ("variates", 9, {}),
    ("form", "round", {}), ("objective", "best", {}), ("target_delta_e", 101, {}),
    ("model", "usd", {}), ("target_delta_e", -1, {}), ("axial", "no", {}),
    ("as_measured", 1, {}), ("as_measured", True, {"form": "extended"}), ("lobes", 2, {"model": "openpbr"}),
    *((option, value, {"model": kind}) for kind in ("su", "ggx") for option, value in (
        ("variates", 2), ("form", "gaussian"), ("axial", True), ("as_measured", True), ("target_delta_e", 2.0))),
])
def test_options_are_refused_by_name_at_once(name, value, options):
    messages = "expected .*, found|only with model .*, found|spectral only with|not together with form"
    with pytest.raises(ValueError, match=f"^{name}: ({messages})"):
        srbf.fit(NotRead(), **{name: value}, **options)


def test_a_surface_has_the_parameters_of_its_program(paper):
    parameters = srbf.fit(paper, model="gltf", objective="raw").model.parameters
    assert parameters["coat_ior"] == 1.5 and (parameters["coat_color"] == 1).all() and parameters["base_diffuse_roughness"] == 0


def test_options_are_those_of_the_program(paper):
    assert {"lobes", "directions", "as_measured"} <= set(inspect.signature(srbf.fit).parameters)
    sampled = srbf.fit(paper, model="su", lobes=1, directions=9, interpolation=3, objective="raw").model.parameters
    assert sampled["direction"].shape == (9, 3) and sampled["interpolation"] == "plain"


def test_options_of_other_functions_are_refused_by_name(paper, facets, tmp_path):
    wl = directions(9)
    path = tmp_path / "a.csv"
    for name, wrong in (("max_theta", lambda: srbf.errors(paper, facets, max_theta=0)),
                        ("threads", lambda: srbf.errors(paper, facets, threads=-1)),
                        ("lighting", lambda: srbf.render(paper, "dark")), ("size", lambda: srbf.render(paper, size=2.5)),
                        ("to", lambda: srbf.code(facets, "cobol")), ("threads", lambda: srbf.convert(paper, path, threads=-1)),
                        ("threads", lambda: srbf.convert(paper, path, threads=2)),
                        ("spectra", lambda: srbf.convert(paper, path, spectra=False)),
                        ("isotropic", lambda: srbf.from_arrays(wl, wl, wl, isotropic="no")),
                        ("progress", lambda: srbf.fit(paper, progress=1)),
                        ("picture", lambda: srbf.png(np.zeros((4, 4)))), ("picture", lambda: srbf.png(np.zeros((4, 3))))):
        with pytest.raises(ValueError, match=f"^{name}: "):
            wrong()
    with pytest.raises(TypeError, match="'lobs'; expected one of model, form"):
        srbf.fit(paper, lobs=2)
    assert srbf.errors(facets, facets, max_theta=90)["heldout_squared_error_ratio_cosine"] == 0


def test_literals_are_the_librarys_names():
    from typing import get_args
    from srbf import _options, _srbf
    for literal, names in ((_options.Lighting, srbf.lightings()), (_options.Language, srbf.code_languages()),
                           (_options.HostMaterial, _srbf.host_materials())):
        assert names == [name for name in get_args(literal) if name in names]  # fewer without the extra that has them


@pytest.fixture(scope="module")
def both_sides(tmp_path_factory):
    path = tmp_path_factory.mktemp("both") / "both.csv"
    wl, wv = directions(400), directions(400, seed=1)
    sides = np.random.default_rng(2).choice([-1, 1], (2, 400))
    wl[:, 2] *= sides[0]
    wv[:, 2] *= sides[1]
    rows = [",".join(map(str, (*l, *v, 0.1 + 0.05 * (l[2] * v[2] > 0)))) for l, v in zip(wl, wv)]
    path.write_text("\n".join(["# both sides", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value", *rows]) + "\n")
    return srbf.load_measurement(path)


def as_lists(parameters):
    return {name: as_lists(value) if isinstance(value, dict) else np.asarray(value).tolist() for name, value in parameters.items()}


def test_models_are_made_of_their_parameters(model):
    again = srbf.Model.from_parameters(model.parameters, model.provenance)
    assert again == model and hash(again) == hash(model) and again.provenance == model.provenance
    assert as_lists(again.parameters) == as_lists(model.parameters)
    assert srbf.Model.from_parameters(as_lists(model.parameters)) == model  # numbers of any type
    other = model.replace(**({"diffuse": [0.1, 0.2, 0.3]} if model.kind == "ggx"
                             else {"coefficient": 2 * model.parameters["coefficient"]}))
    assert other != model and other != again and model != 5
    assert other.provenance == model.provenance


def test_models_of_both_sides_are_made_of_their_parameters(model, facets):
    both = srbf.Model.from_parameters({"reflection_front": model.parameters, "transmission_back": facets.parameters,
                                       "beam_transmission_angle": [0, 1], "beam_transmission_share": [[0.5] * 3, [0.25] * 3]})
    with pytest.raises(ValueError, match="^beam_transmission_share: missing"):
        srbf.Model.from_parameters({"reflection_front": facets.parameters, "beam_transmission_angle": [0, 1]})
    assert both.kind == "bsdf" and srbf.Model.from_parameters(both.parameters) == both
    turned = both.parameters | {"beam_transmission_azimuths": [1, 2], "beam_transmission_share": [[0.5] * 3, [0.25] * 3, [0.125] * 3]}
    assert srbf.Model.from_parameters(srbf.Model.from_parameters(turned).parameters) == srbf.Model.from_parameters(turned) != both
    with pytest.raises(ValueError, match="share.: shape: expected"):
        srbf.Model.from_parameters(turned | {"beam_transmission_share": [[0.5] * 3]})
    assert pickle.loads(pickle.dumps(both)) == both


def test_a_model_is_made_of_few_arrays():
    lobe = srbf.Model.from_parameters({"bandwidth": [[8.0]], "parameterization": [[1, 1]], "coefficient": [[0.5, 0.25, 0.125]]})
    np.testing.assert_allclose(lobe.eval([0, 0, 1], [0, 0, 1]), [0.5, 0.25, 0.125])
    tilted = lobe.replace(centre=[[[0.6, 0, 0.8]]], axial=False, exponent=np.zeros((1, 4)), form="extended")
    assert not tilted.isotropic and tilted.parameters["form"] == "extended"
    for name, value in (("bandwidth", [8.0]), ("coefficient", [[1, 2]]), ("coefficient", [[1, 2, np.inf]]), ("log_scale", [0, 0]),
                        ("centre", [[[0, 0, 2]]]), ("centre", [[[0.6, 0, 0.8]]]), ("exponent", [[1, 2]]), ("form", "horizon"),
                        ("colour", 1), ("axial", 1)):
        with pytest.raises(ValueError, match=f"^{name}"):
            lobe.replace(**{name: value})
    for name, value in (("coefficient", [[-1, 0, 0]]), ("parameterization", [[0, 0]])):
        with pytest.raises(ValueError, match=name):
            lobe.replace(**{name: value})
    with pytest.raises(ValueError, match="^bandwidth: missing"):
        srbf.Model.from_parameters({"parameterization": [[1, 1]], "coefficient": [[1, 1, 1]]})


def test_measurements_are_pickled_and_compared(paper, both_sides, facets, tmp_path):
    wl, wv = directions(60), directions(60, seed=1)
    samples = srbf.from_arrays(wl, wv, np.linspace(0.1, 0.2, 60))
    tables = [paper, both_sides, samples, samples.exchanged(), paper.exchanged()]
    for ending in sorted(filter(None, srbf.formats().values())):
        srbf.convert(facets, tmp_path / f"m{ending}")
        tables.append(srbf.load(tmp_path / f"m{ending}"))
    for i, table in enumerate(tables):
        copy = pickle.loads(pickle.dumps(table))
        assert copy == table and hash(copy) == hash(table) and repr(copy) == repr(table)
        np.testing.assert_array_equal(copy.eval(wl, wv), table.eval(wl, wv))
        assert all(table != other for other in tables[:i])
    assert srbf.load(PAPER) == paper and paper.exchanged().exchanged() == paper
    state = list(paper.__reduce__()[1])
    for wrong in (["0.0"] + state[1:], [state[0], state[1][:-1]] + state[2:], [state[0], b""] + state[2:]):
        with pytest.raises(ValueError, match="pickled BRDF"):
            srbf._unpickled(*wrong)


def test_exchanged_brdfs_are_named_so(paper, facets):
    assert "exchanged" not in repr(paper) + repr(facets) and not paper.is_exchanged
    samples = srbf.from_arrays(directions(60), directions(60, seed=1), np.full(60, 0.1))
    for brdf in (paper, facets, samples):
        assert brdf.exchanged().is_exchanged and repr(brdf.exchanged()).endswith(", exchanged>")
        assert not brdf.exchanged().exchanged().is_exchanged
    model = srbf.fit(paper.exchanged(), model="ggx", lobes=1, objective="raw").model
    wl, wv = directions(100), directions(100, seed=1)
    np.testing.assert_allclose(model.eval(wl, wv), facets.eval(wl, wv), rtol=0.1)
    assert model.provenance["exchanged"] == "light and viewer of the source" and model.is_exchanged
    assert facets.exchanged().provenance["exchanged"] == model.provenance["exchanged"]


def test_files_of_the_other_kind_are_refused(paper, facets, tmp_path):
    facets.save(tmp_path / "m.srbf")
    assert srbf.load_model(tmp_path / "m.srbf") == facets and srbf.load_measurement(PAPER) == paper
    for load, path in ((srbf.load_model, PAPER), (srbf.load_measurement, tmp_path / "m.srbf")):
        with pytest.raises(srbf.Error, match="input: expected a (measurement|model), found a (measurement|model)") as caught:
            load(path)
        assert caught.value.code == "wrong kind" and caught.value.file == str(path)


def test_other_threads_run_meanwhile(paper, facets, tmp_path):
    """In no call does another thread wait for much of its time."""
    wl, wv, f, pauses = directions(400_000), directions(400_000, seed=1), np.full((400_000, 3), 0.1, np.float32), []

    def watch():
        last = time.perf_counter()
        while not done.is_set():
            time.sleep(0.001)
            pauses.append(time.perf_counter() - last)
            last += pauses[-1]

    for work in (lambda: srbf.from_arrays(wl, wv, f), lambda: srbf.convert(facets, tmp_path / "m.bsdf"),
                 lambda: srbf.fit(paper, lobes=2, variates=2)):
        done, start = threading.Event(), time.perf_counter()
        pauses.clear()
        thread = threading.Thread(target=watch)
        thread.start()
        work()
        done.set()
        thread.join()
        assert max(pauses) < 0.25 * (time.perf_counter() - start) + 0.1


def slowness():
    """Returns how many times slower than a reference processor this one is, at least 1."""
    start = time.process_time()
    sum(range(5_000_000))
    return max(1, (time.process_time() - start) / 0.05)


@pytest.mark.parametrize("call", ["srbf.render(paper, size=4096)", "paper.sample(w)", "srbf.convert(many, f'{folder}/x.csv')",
                                  "srbf.fit(paper, target_delta_e=0.01)"])
def test_an_interrupt_ends_long_calls(call, tmp_path):
    script = f"""
import signal, srbf, time, numpy as np
folder, paper = {str(tmp_path)!r}, srbf.load({str(PAPER)!r})
signal.signal(signal.SIGINT, signal.default_int_handler)
w = np.broadcast_to(np.float32([0, 0.6, 0.8]), (20_000_000, 3))
paper.sample(w[0])
{'many = srbf.from_arrays(w[:4_000_000], w[:4_000_000], 0.2)' if 'many' in call else ''}
start = time.process_time()
try:
    print('now', flush=True)
    {call}
except KeyboardInterrupt:
    print('interrupted', time.process_time() - start)
"""
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "now\n"
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        words = process.communicate()[0].split()
        # Limits the processor time, which a busy machine does not lengthen, scaled by the processor's speed.
        assert words[0] == "interrupted" and float(words[1]) < (0.3 + 2 * slowness()) * os.cpu_count() and process.returncode == 0


def test_previews_are_enlarged_twice():
    bright = srbf._doubled(np.float32(np.arange(12).reshape(2, 2, 3)))
    assert bright.shape == (4, 4, 3)
    np.testing.assert_allclose(bright[:, 0, 0], [0, 1.5, 4.5, 6])
    np.testing.assert_allclose(bright[0, :, 2], [2, 2.75, 4.25, 5])


def test_png_is_srgb():
    import struct
    import zlib
    data = srbf.png([[[0, 0.5, 1], [2, -1, np.nan]]])
    start = data.index(b"IDAT")
    length = struct.unpack(">I", data[start - 4:start])[0]
    assert list(zlib.decompress(data[start + 4:start + 4 + length])) == [0, 0, 188, 255, 255, 0, 0]


def test_pictures_and_code_are_made(paper, facets):
    for brdf in (paper, facets):
        assert brdf._repr_png_().startswith(b"\x89PNG")
    picture = srbf.render(paper, "lamp", 64)
    assert picture.shape == (64, 64, 3) and picture[0, 0].max() == 0 and picture.max() > 0
    for language in srbf.code_languages():
        assert "white_paint_brdf(" in srbf.code(facets, language, name="white paint")
    assert "a_brdf(" in srbf.code({"a": facets, "b": facets}, "c", albedo=True) and "class AMaterial" in srbf.code({"a": facets}, "three")


@pytest.mark.parametrize("wl, wv, error, words", [
    ([1, 0], [0, 0, 1], ValueError, "shape"),
    ([0, 0, 2], [0, 0, 1], ValueError, "unit vector"),
    ([0, 0, np.nan], [0, 0, 1], ValueError, "unit vector"),
    ([0, 0, np.inf], [0, 0, 1], ValueError, "unit vector"),
    ([0, 0, 1j], [0, 0, 1], TypeError, "complex"),
    ("up", [0, 0, 1], TypeError, "dtype"),
    (None, [0, 0, 1], TypeError, "dtype"),
    (np.zeros((2, 3)) + [0, 0, 1], np.zeros((3, 3)) + [0, 0, 1], ValueError, "broadcast"),
])
def test_wrong_directions_are_refused(paper, wl, wv, error, words):
    for ask in (paper.eval, paper.pdf):
        with pytest.raises(error, match=words):
            ask(wl, wv)


def test_wrong_input_is_refused(paper, facets, tmp_path):
    (tmp_path / "cut.bsdf").write_bytes(PAPER.read_bytes()[:1000])
    for path, code in ((tmp_path / "missing", "unreadable"), (tmp_path, "unreadable"), (tmp_path / "cut.bsdf", "malformed")):
        with pytest.raises(srbf.Error) as caught:
            srbf.load(path)
        assert caught.value.code == code and caught.value.file == str(path) and caught.value.expected
    for wrong in (lambda: srbf.fit(facets), lambda: srbf.convert(paper, tmp_path / "x.png"), lambda: srbf.render(paper, size=0),
                  lambda: facets.albedo(0), lambda: facets.sample([0, 0, 1], [0, 0, 1]), lambda: srbf.errors(paper, facets, max_theta=91),
                  lambda: srbf.from_arrays([[0, 0, 1]], [[0, 0, 1]], [np.nan]), lambda: facets.save(tmp_path / "no" / "m.srbf"),
                  lambda: srbf.fit(lambda wl, wv: np.zeros((3, 3)))):
        with pytest.raises(ValueError):
            wrong()
    with pytest.raises(TypeError):
        srbf.fit(5)
    assert not (tmp_path / "no").exists() and not (tmp_path / "x.png").exists()


def run(notebook, monkeypatch, folder):
    """Runs the code of a notebook in a folder beside data/, and returns its names. IPython, which shows pictures, is replaced."""
    import json
    import types
    cells = json.loads((DATA.parent / "examples" / notebook).read_text())["cells"]
    (folder / "data").symlink_to(DATA)
    (folder / "examples").mkdir()
    monkeypatch.chdir(folder / "examples")
    monkeypatch.setitem(sys.modules, "IPython", types.ModuleType("IPython"))
    display = types.ModuleType("IPython.display")
    display.Image = bytes
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    names = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    return names


@pytest.mark.host
def test_the_notebook_runs(monkeypatch, tmp_path):
    assert run("first_steps.ipynb", monkeypatch, tmp_path)["fit"].model.nbytes == 210


PAGES = ("docs/python.md",)  # begins with the example that writes film.srbf


def python_of(page):
    """The Python examples of a page of documentation, at least one."""
    examples = re.findall(r"```python\n(.*?)```", (DATA.parent / page).read_text().replace("\n  ", "\n"), re.DOTALL)
    assert examples, page
    return examples


def test_the_first_examples_run_as_they_stand(monkeypatch, tmp_path):
    (tmp_path / "data").symlink_to(DATA)
    monkeypatch.chdir(tmp_path)
    for page in PAGES:
        exec(python_of(page)[0], {})
        assert (tmp_path / "film.srbf").exists()
        (tmp_path / "film.srbf").unlink()


@pytest.mark.host
def test_the_package_and_the_documentation_are_typed(tmp_path):
    pytest.importorskip("mypy", reason="needs mypy")
    settings = str(DATA.parent / "pyproject.toml")
    package = pathlib.Path(srbf.__file__).parent
    for i, page in enumerate(PAGES):
        (tmp_path / f"page_{i}.py").write_text("\n".join(python_of(page)))
    pages = [*sorted(map(str, tmp_path.glob("page_*.py"))), str(DATA.parent / "examples" / "read_model.py")]
    environment = {**os.environ, "MYPYPATH": str(package.parent), "PYTHONPATH": str(package.parent),
                   "MYPY_CACHE_DIR": str(tmp_path / "cache")}
    allowed = tmp_path / "allowed"  # classes of pybind11, which have their own metaclass
    allowed.write_text("srbf._srbf.Brdf\nsrbf._srbf.Request\nsrbf._srbf.Brdf.__init__\n")
    for check in (["mypy", "--strict", "--config-file", settings, *pages],
                  ["mypy.stubtest", "srbf._srbf", "--mypy-config-file", settings, "--allowlist", str(allowed)]):
        done = subprocess.run([sys.executable, "-m", *check], env=environment, capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr


def test_both_sides_are_read_and_sampled(tmp_path):
    path = tmp_path / "both.csv"
    rows = ["# both sides", "wl_x,wl_y,wl_z,wv_x,wv_y,wv_z,value"]
    rows += ["0,0,1,0,0.6,0.8,1", "0,0,-1,0,0.6,-0.8,2", "0,0,1,0,0.6,-0.8,3"]
    path.write_text("\n".join(rows) + "\n")
    both = srbf.load(str(path))
    up, away = np.array([0, 0, 1.0]), np.array([0, 0.6, 0.8])
    down = away * [1, 1, -1]
    wl, wv = np.stack([up, -up, up, down]), np.stack([away, down, down, up])
    assert np.allclose(both.eval(wl, wv)[:, 1], [1, 2, 3, 3])  # the last by reciprocity
    u = np.random.default_rng(1).random((500, 3))
    drawn, weight, pdf = both.sample(np.broadcast_to(away, (500, 3)), u)
    assert (drawn[:, 2] < 0).any() and (drawn[:, 2] > 0).any()
    assert np.isfinite(weight).all()
    kept = pdf > 0
    assert np.allclose(both.pdf(drawn[kept], np.broadcast_to(away, (kept.sum(), 3))), pdf[kept], rtol=1e-3)


def test_edits_are_models_with_other_provenance(tmp_path):
    film = srbf.load_model(DATA.parent / "test" / "edit" / "dielectric.srbf")
    body, white = film.tint(body=(0.5, 0.5, 0.5)), film.saturate(0)
    wl, wv = directions(50), directions(50, seed=1)
    assert (body.eval(wl, wv) <= film.eval(wl, wv)).all()
    np.testing.assert_allclose(white.eval(wl, wv)[:, 0], white.eval(wl, wv)[:, 2], rtol=1e-3)
    half = film.blend(white, 0.5)
    np.testing.assert_allclose(half.eval(wl, wv), (film.eval(wl, wv) + white.eval(wl, wv)) / 2, rtol=1e-3)
    few = film.turn_hue(30).rotate(10).reduce(3)
    assert few.provenance["edits"] == "hue 30; rotate 10; reduce to 3 lobes" and len(few.parameters["coefficient"]) == 3
    few.save(tmp_path / "few.srbf")
    assert srbf.load(tmp_path / "few.srbf") == few
    for edit in (lambda: film.roughen(0), lambda: film.coat(0.1, ior=1), lambda: film.tint((1, 1, -1)), lambda: film.blend(few, 2)):
        with pytest.raises(srbf.Error):
            edit()
    with pytest.raises(TypeError):
        film.tint(2)
