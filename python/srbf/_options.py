"""The options of fits, checked by their names before anything is computed, within the ranges of the command line."""
from __future__ import annotations

import operator
import os
from typing import Any, Callable, Literal, Optional, Sequence, Union, get_args

import numpy as np

from . import _srbf

#: "pm" (parameterized multivariate), "su" (view by view), "ggx" (Lambert and GGX) or "openpbr" (parameters of OpenPBR)
Kind = Literal["pm", "su", "ggx", "openpbr"]
Form = Literal["gaussian", "horizon", "extended"]
#: whose parameters a surface (model "openpbr") has: all of OpenPBR, those of glTF, or of Blender's Principled BSDF
Surface = Literal["openpbr", "gltf", "principled"]
Objective = Literal["raw", "cosine", "log", "cube-root", "relative", "appearance"]
Channels = Literal["rgb", "spectral"]
Lighting = Literal["overcast", "window", "sunset", "studio", "flash", "lamp", "side", "back"]
#: values of samples: f [1/sr], the reflectance factor π f, or f cosθ of the viewer
Quantity = Literal["bsdf", "factor", "cosine"]
Language = Literal["glsl", "hlsl", "wgsl", "msl", "c"]
Progress = Union[bool, Callable[[str, float], Optional[bool]]]
Path = Union[str, "os.PathLike[str]"]

#: [name, kind of models or "" for all] → least, most, whether it is a whole number; least > most: not a number
_RANGES = {(name, model): (least, most, whole) for name, model, least, most, whole in _srbf.fit_options()}


def one_of(name: str, value: Any, names: Sequence[str]) -> str:
    if not isinstance(value, str) or value not in names:
        raise ValueError(f"{name}: expected one of {', '.join(names)}, found {value!r}")
    return value


def whole(name: str, value: Any, least: int, most: int, or_else: str = "") -> int:
    try:
        number = operator.index(value)
    except TypeError:
        number = None
    if number is None or isinstance(value, bool) or not least <= number <= most:
        raise ValueError(f"{name}: expected a whole number {least} to {most}{or_else}, found {value!r}")
    return number


def number(name: str, value: Any, least: float, most: float) -> float:
    if isinstance(value, (str, bool)) or not hasattr(value, "__float__") or not least <= float(value) <= most:
        raise ValueError(f"{name}: expected a number {least:g} to {most:g}, found {value!r}")
    return float(value)


def flag(name: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name}: expected True or False, found {value!r}")
    return bool(value)


def _quoted(name: str) -> str:
    return f'"{name}"'


def option(name: str, value: Any, model: str = "pm", or_else: str = "") -> Any:
    """The value of an option of the table, of models of that kind; `or_else` is what else is taken, for the message."""
    kinds = [kind for option, kind in _RANGES if option == name]
    if "" not in kinds and model not in kinds:
        raise ValueError(f'{name}: only with model={" or ".join(map(_quoted, kinds))}, found model={_quoted(model)}')
    least, most, is_whole = _RANGES[name, "" if "" in kinds else model]
    if least > most:
        return one_of(name, value, _srbf.forms()) if name == "form" else flag(name, value)
    if not is_whole:
        return number(name, value, least, most)
    return whole(name, value, int(least), int(most), or_else)


def read(columns: Any, quantity: Any, floor: Any) -> tuple[str, str, float]:
    """What a file of samples does not state, as the extension takes it."""
    if not isinstance(columns, str):
        raise ValueError(f"columns: expected names as one text, found {columns!r}")
    named = "" if quantity is None else one_of("quantity", quantity, get_args(Quantity))
    return columns, named, number("floor", floor, 0, 1e12)


def check_progress(value: Any) -> None:
    if not isinstance(value, bool) and not callable(value):
        raise ValueError(f"progress: expected True, False or a function of (stage, fraction), found {value!r}")


def request(model: str, *, lobes: Any, objective: Optional[str], channels: str, seed: Any, surface: Optional[str] = None,
            **options: Any) -> _srbf.Request:
    """What a fit is asked for; an option that is None is not given."""
    made = _srbf.Request()
    made.model = one_of("model", model, get_args(Kind))
    if surface is not None:
        if model != "openpbr":
            raise ValueError(f'surface: only with model="openpbr", found model="{model}"')
        made.surface = one_of("surface", surface, _srbf.openpbr_surfaces())
    made.channels = one_of("channels", channels, get_args(Channels))
    if objective is not None:
        made.objective = one_of("objective", objective, _srbf.objectives())
    made.seed = whole("seed", seed, 0, 2**64 - 1)
    if channels != "rgb" and model != "pm":
        raise ValueError(f'channels: "{channels}" only with model="pm", found model="{model}"')
    if isinstance(lobes, str) and lobes == "auto" and model == "pm":
        made.automatic = True
    elif lobes is not None:
        made.lobes = option("lobes", lobes, model, ' or "auto"' if model == "pm" else "")
    for name, value in options.items():
        if value is not None:
            setattr(made, name, option(name, value, model))
    if made.reciprocal and (variates := options.get("variates")) is not None and variates % 2 == 1:
        raise ValueError(f"variates: expected an even number with reciprocal=True, found {variates}")
    return made
