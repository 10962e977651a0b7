"""ꟻLIP by its authors and ΔE_ITP by colour-science, if they are installed: `pip install flip-evaluator colour-science`."""
import pathlib

import numpy as np
import pytest
import srbf

flip_evaluator = pytest.importorskip("flip_evaluator")
colour = pytest.importorskip("colour")
DATA = pathlib.Path(__file__).parents[2] / "data"
SIZE = 64


def displayed(reference, *pictures):
    """Linear sRGB values as displayed, with the exposure of docs/accuracy.md, and a mask of the sphere's pixels."""
    position = 2 * np.arange(SIZE) + 1 - SIZE
    sphere = position[:, None] ** 2 + position**2 < SIZE**2
    brightest = reference.max(axis=-1)
    lit = np.sort(brightest[brightest > 0])
    exposure = 0.75 / lit[int(0.9 * (len(lit) - 1))]
    return [np.where(sphere[..., None], np.clip(p * exposure, 0, 1), 0.16) for p in pictures], sphere


def encoded(x):
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055).astype(np.float32)


def itp(x):
    bt2020 = colour.RGB_to_RGB(x, "sRGB", "ITU-R BT.2020")
    return colour.models.RGB_to_ICtCp(100 * bt2020, method="ITU-R BT.2100-2 PQ")


@pytest.mark.parametrize("name", ["paper_white", "cc_ibiza_sunset"])
def test_flip_and_delta_e_agree_with_other_programs(name):
    measured = srbf.load(DATA / f"{name}_rgb.bsdf")
    model = srbf.fit(measured, lobes=3, variates=2, objective="cosine").model
    ours = srbf.errors(measured, model)["lightings"]
    for lighting in srbf.lightings():
        a, b = (srbf.render(brdf, lighting, SIZE) for brdf in (measured, model))
        (a, b), sphere = displayed(a, a, b)
        flip = flip_evaluator.evaluate(encoded(a), encoded(b), "LDR", applyMagma=False, parameters={"ppd": 3840 * np.pi / 180})[0]
        assert abs(flip[sphere].mean() - ours[lighting]["flip"]) <= 1e-4
        delta_e = colour.difference.delta_E_ITP(itp(a), itp(b))[sphere].mean()
        assert delta_e == pytest.approx(ours[lighting]["delta_e_itp"], rel=2e-4)
