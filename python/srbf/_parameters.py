"""The numbers of models as arrays: names and shapes, checked before a model is made of them."""
from __future__ import annotations

from typing import Any, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _srbf
from ._options import flag, one_of, whole

Shape = Sequence[Union[int, str]]  # a letter: as many as another array has, or as it comes
_PM: dict[str, Shape] = {"bandwidth": ("J", "N"), "parameterization": ("N", 2), "coefficient": ("J", 3), "log_scale": ("J",),
                         "centre": ("J", "N", 3), "exponent": ("J", "F"), "wavelength": ("C",), "spectrum": ("J", "C")}
_SU: dict[str, Shape] = {"bandwidth": ("n", "J"), "coefficient": ("n", "J", 3), "centre": ("n", "J", 3), "shape": ("n", "J"),
                         "direction": ("n", 3)}
_GGX: dict[str, Shape] = {"roughness": ("L",), "diffuse": (3,), "f0": ("L", 3), "f90": ("L",)}
_PBR: dict[str, Shape] = {name: (size,) for name, size in _srbf.openpbr_parameters().items()}
_PARTS = ("reflection_front", "reflection_back", "transmission_front", "transmission_back")
_BEAMS = ("reflection_front", "reflection_back", "transmission", "transmission_back")


def _text(shape: Shape) -> str:
    return "[" + ", ".join(map(str, shape)) + "]"


def _arrays(given: Mapping[str, Any], shapes: Mapping[str, Shape]) -> tuple[dict[str, Any], dict[str, int]]:
    """The arrays of these names, as float32, and what the letters of their shapes stand for."""
    arrays: dict[str, Any] = {}
    sizes: dict[str, int] = {}
    for name, shape in shapes.items():
        if name not in given:
            continue
        array = np.asarray(given[name])
        if array.dtype.kind not in "fiu":
            raise TypeError(f"{name}: expected real numbers, found dtype {array.dtype}")
        if array.ndim == len(shape):
            for length, axis in zip(array.shape, shape):
                if isinstance(axis, str):
                    sizes.setdefault(axis, length)
        expected = [sizes.get(axis, axis) if isinstance(axis, str) else axis for axis in shape]
        if list(array.shape) != expected:
            raise ValueError(f"{name}: expected shape {_text(shape)} = {_text(expected)}, found {list(array.shape)}")
        if not np.isfinite(array).all():
            raise ValueError(f"{name}: expected finite numbers")
        arrays[name] = np.ascontiguousarray(array, np.float32)
    return arrays, sizes


def _require(given: Mapping[str, Any], required: Sequence[str], others: Sequence[str]) -> None:
    for name in required:
        if name not in given:
            raise ValueError(f"{name}: missing")
    for name in given:
        if name not in required and name not in others:
            raise ValueError(f"{name}: expected one of {', '.join([*required, *others])}")


def _unit(name: str, vectors: npt.NDArray[np.float32]) -> None:
    if not (np.abs((vectors * vectors).sum(-1) - 1) < 1e-3).all():
        raise ValueError(f"{name}: expected unit vectors")


def _pm(given: Mapping[str, Any]) -> dict[str, Any]:
    values = "spectrum" if "spectrum" in given else "coefficient"
    _require(given, ["bandwidth", "parameterization", values] + ["wavelength"] * (values == "spectrum"), [*_PM, "form", "axial"])
    of, sizes = _arrays(given, _PM)
    J, N = sizes["J"], sizes["N"]
    of.setdefault("log_scale", np.zeros(J, np.float32))
    of.setdefault("centre", np.broadcast_to(np.array([0, 0, 1], np.float32), (J, N, 3)).copy())
    of.setdefault("exponent", np.zeros((J, 0), np.float32))
    _unit("centre", of["centre"])
    forms = {terms: form for form, terms in _srbf.terms_of_forms().items()}
    terms = of["exponent"].shape[1]
    if terms not in forms:
        raise ValueError(f"exponent: expected shape [J, F], F one of {', '.join(map(str, forms))}, found F = {terms}")
    of["form"] = one_of("form", given.get("form", forms[terms]), [forms[terms]])
    along_z = bool((np.abs(of["centre"][..., 2]) == 1).all())
    of["axial"] = flag("axial", given.get("axial", along_z))
    if of["axial"] and not along_z:
        raise ValueError("centre: expected (0, 0, 1) or (0, 0, -1) of an axial model")
    return of


def _su(given: Mapping[str, Any]) -> dict[str, Any]:
    _require(given, ["bandwidth", "coefficient", "centre"], [*_SU, "interpolation", "neighbours", "discretise", "index", "index_size"])
    of, _ = _arrays(given, _SU)
    _unit("centre", of["centre"])
    directions = _srbf.view_directions(of["bandwidth"].shape[0])
    if "direction" in of and np.abs(of["direction"] - directions).max(initial=0) > 1e-5:
        raise ValueError("direction: expected the Fibonacci set of the hemisphere")
    of["interpolation"] = one_of("interpolation", given.get("interpolation", "rotated"), ["rotated", "plain"])
    of["discretise"] = one_of("discretise", given.get("discretise", "view"), ["view", "light"])
    of["neighbours"] = whole("neighbours", given.get("neighbours", 3), 1, 7)
    if "index" in given:
        of["index"] = one_of("index", given["index"], ["cube", "parabolic"])
        of["index_size"] = whole("index_size", given.get("index_size", 0), 0, 1024)
    return of


def _ggx(given: Mapping[str, Any]) -> dict[str, Any]:
    _require(given, list(_GGX), [])
    return _arrays(given, _GGX)[0]


def _openpbr(given: Mapping[str, Any]) -> dict[str, Any]:
    _require(given, list(_PBR), ["is_exchanged"])
    return _arrays(given, _PBR)[0] | {"is_exchanged": flag("is_exchanged", given.get("is_exchanged", False))}


def _bsdf(given: Mapping[str, Any]) -> dict[str, Any]:
    beams: dict[str, Shape] = {}
    for beam in _BEAMS:
        nodes = f"{beam} nodes" if f"beam_{beam}_azimuths" in given else beam
        beams |= {f"beam_{beam}_angle": (beam, ), f"beam_{beam}_azimuths": (beam, ), f"beam_{beam}_share": (nodes, 3)}
    _require(given, [], [*_PARTS, *beams])
    of, _ = _arrays(given, beams)
    for beam in _BEAMS:
        if any(name.startswith(f"beam_{beam}_a") or name == f"beam_{beam}_share" for name in of):
            _require(given, [f"beam_{beam}_angle", f"beam_{beam}_share"], list(given))
    return of | {part: held_of(given[part], {}) for part in _PARTS if part in given}


def held_of(given: Mapping[str, Any], provenance: Mapping[str, str]) -> _srbf.Brdf:
    """The model of these numbers."""
    if any(name in given for name in _PARTS):
        kind, of = "bsdf", _bsdf(given)
    elif "base_color" in given:
        kind, of = "openpbr", _openpbr(given)
    elif "diffuse" in given:
        kind, of = "ggx", _ggx(given)
    elif "parameterization" in given:
        kind, of = "pm", _pm(given)
    else:
        kind, of = "su", _su(given)
    return _srbf.model_of(kind, of, dict(provenance))
