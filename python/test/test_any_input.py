"""Calls of every kind of object in any order, and input of any content and shape."""
import os
import pathlib
import pickle
import shutil

import numpy as np
import pytest
import srbf
from test_srbf import directions

ROOT = pathlib.Path(__file__).parents[2]
FILES = [path for folder in ("fuzz/corpus", "test/models", "data")
         for path in sorted((ROOT / folder).rglob("*"), key=lambda path: (path.parent.name == "alta", path))
         if path.is_file() and path.stat().st_size < 1_000_000]
WL, WV = directions(5, seed=0), directions(5, seed=1)
U = np.random.default_rng(2).random((5, 3)).astype(np.float32)
CALLS = {
    "eval": lambda brdf: brdf.eval(WL, WV),
    "eval behind": lambda brdf: brdf.eval(WL * [1, 1, -1], WV),
    "eval_spectral": lambda brdf: brdf.eval_spectral(WL, WV),
    "sample": lambda brdf: brdf.sample(WV, U),
    "sample behind": lambda brdf: brdf.sample(WV * np.float32([1, 1, -1]), U),
    "pdf": lambda brdf: brdf.pdf(WL, WV),
    "albedo": lambda brdf: brdf.albedo([1, 0.3, 0.01]),
    "exchanged": lambda brdf: brdf.exchanged().eval(WL, WV),
    "properties": lambda brdf: (brdf.is_exchanged, brdf.isotropic, brdf.wavelengths, brdf.nbytes, repr(brdf), hash(brdf)),
    "pickle": lambda brdf: pickle.loads(pickle.dumps(brdf)).eval(WL, WV),
    "parameters": lambda brdf: repr((brdf.kind, brdf.parameters, brdf.provenance)
                                    if isinstance(brdf, srbf.Model) else (brdf.format, brdf.source)),
}


def one_of_each_kind():
    paths = {}
    for path in FILES:
        try:
            brdf = srbf.load(path)
        except srbf.Error:
            continue
        behind = bool((brdf.eval(WL * [1, 1, -1], WV) > 0).any())
        paths.setdefault((type(brdf), behind), path)
        if len(paths) == 4:
            break
    return paths


def test_results_do_not_depend_on_the_order_of_calls():
    kinds = one_of_each_kind()
    assert set(kinds) == {(kind, behind) for kind in (srbf.Model, srbf.Measurement) for behind in (False, True)}
    for seed, path in enumerate(kinds.values()):
        order = np.random.default_rng(seed).permutation(list(CALLS))
        once, again = srbf.load(path), srbf.load(path)
        first = {name: CALLS[name](once) for name in order}
        for name in order[::-1]:
            np.testing.assert_equal(CALLS[name](again), first[name], err_msg=f"{path}: {name}")


def mutations(data, random):
    yield data
    yield data[:random.integers(len(data) + 1)]
    for _ in range(3):
        changed = bytearray(data)
        for position in random.integers(len(data), size=2) if data else ():
            changed[position if random.random() < 0.5 else position % min(len(data), 80)] = random.integers(256)
        yield bytes(changed)


def test_files_of_any_content_are_read_or_refused(tmp_path):
    random, path, refused = np.random.default_rng(5), tmp_path / "file", 0
    for file in FILES:
        for data in mutations(file.read_bytes(), random):
            path.write_bytes(data)
            try:
                srbf.load(path)
            except srbf.Error as error:
                refused += 1
                assert error.file == str(path) and str(error).startswith(str(path))
                for text in (str(error), error.what, error.expected, error.found):
                    assert text.encode() is not None and "\n" not in text
    assert refused > 250


def test_file_names_need_not_be_utf8(tmp_path):
    table, model = (os.fsencode(tmp_path) + name for name in (b"/p\xff.bsdf", b"/p\xff.srbf"))
    shutil.copy(ROOT / "data" / "paper_white_rgb.bsdf", table)
    paper = srbf.load(os.fsdecode(table))
    assert paper.source == os.fsdecode(table)
    fitted = srbf.fit(os.fsdecode(table), model="ggx", lobes=1, objective="raw").model
    fitted.save(os.fsdecode(model))
    assert srbf.load_model(pathlib.Path(os.fsdecode(model))) == fitted
    fitted.provenance["source"].encode()
    srbf.convert(fitted, os.fsdecode(table))
    for call in (lambda: srbf.load(os.fsdecode(table) + ".none"), lambda: srbf.load_model(os.fsdecode(table)),
                 lambda: fitted.save(os.fsdecode(model) + "/m"), lambda: srbf.convert(paper, os.fsdecode(table) + "x"),
                 lambda: srbf.load(str(tmp_path) + "\0"), lambda: srbf.load(tmp_path)):
        with pytest.raises(srbf.Error) as raised:
            call()
        str(raised.value).encode()


@pytest.mark.parametrize("shape", [(7,), (7, 1), (7, 3), ()])
def test_samples_are_rows(shape):
    wl, wv, f = directions(7, seed=0), directions(7, seed=1), np.full(shape, 0.2)
    assert srbf.from_arrays(wl, wv, f).nbytes == 7 * 36


@pytest.mark.parametrize("shape", [(3, 7), (1, 7), (7, 2), (7, 4), (6,), (7, 1, 3), (7, 7, 3), (6, 3), (3,), (7, 1, 1)])
def test_samples_of_other_shapes_are_refused(shape):
    with pytest.raises(ValueError, match=rf"f: expected shape \[7, 3\].*\[7\].*found \[{', '.join(map(str, shape))}\]"):
        srbf.from_arrays(directions(7, seed=0), directions(7, seed=1), np.full(shape, 0.2))


@pytest.mark.parametrize("change", [lambda f: f.T, lambda f: f[:, 0], lambda f: f[:1], lambda f: f[..., None], lambda f: f[:, :2],
                                    lambda f: 0.2])
def test_functions_return_rows(change):
    with pytest.raises(ValueError, match=r"function: expected shape \[\d+, 3\] or \[\d+, 1\], found \["):
        srbf.fit(lambda wl, wv: change(np.full(wl.shape, 0.2)), model="ggx", lobes=1, objective="raw")


def test_anisotropic_samples_give_a_warning(recwarn):
    angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)

    def rotated(w):
        x, y, z = (w[:, None, k] for k in range(3))
        return np.stack([np.cos(angles) * x - np.sin(angles) * y, np.sin(angles) * x + np.cos(angles) * y, z + 0 * angles], -1)

    wl, wv = rotated(directions(60, seed=0)), rotated(directions(60, seed=1))
    brushed = 0.1 * (1 + 0.8 * np.cos(2 * np.arctan2(wl[..., 1], wl[..., 0])))
    srbf.from_arrays(wl, wv, 0.1 + 0.3 * wl[..., 2])
    srbf.from_arrays(wl, wv, brushed, isotropic=False)
    assert not recwarn
    with pytest.warns(UserWarning, match="isotropic: samples at the same angles but other azimuths differ by [1-9]"):
        srbf.from_arrays(wl, wv, brushed)
