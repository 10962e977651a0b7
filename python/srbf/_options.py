"""Options, checked by their names before anything is computed."""
from __future__ import annotations

import inspect
import operator
import os
from typing import Any, Callable, Literal, Mapping, Optional, Sequence, Union, get_args

import numpy as np

from . import _srbf

Lighting = Literal["overcast", "window", "sunset", "studio", "flash", "lamp", "side", "back"]
#: the quantity of samples: f [1/sr], the reflectance factor π f, or f cosθ of the viewer
Quantity = Literal["bsdf", "factor", "cosine"]
Language = Literal["glsl", "hlsl", "wgsl", "msl", "c"]
HostMaterial = Literal["radiance", "three", "three-webgpu", "unity"]  # a whole material of a program, in its own language
Progress = Union[bool, Callable[[str, float], Optional[bool]]]
Path = Union[str, "os.PathLike[str]"]

def one_of(name: str, value: Any, names: Sequence[str]) -> str:
    if not isinstance(value, str) or value not in names:
        raise ValueError(f"{name}: expected one of {', '.join(names)}, found {value!r}")
    return value


def integer(name: str, value: Any, low: int, high: int) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        number = None
    if number is None or isinstance(value, bool) or not low <= number <= high:
        raise ValueError(f"{name}: expected a whole number {low} to {high}, found {value!r}")
    return number


def number(name: str, value: Any, low: float, high: float) -> float:
    if isinstance(value, (str, bool)) or not hasattr(value, "__float__") or not low <= float(value) <= high:
        raise ValueError(f"{name}: expected a number {low:g} to {high:g}, found {value!r}")
    return float(value)


def flag(name: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name}: expected True or False, found {value!r}")
    return bool(value)


def threads(value: Any) -> int:
    return integer("threads", value, 0, _srbf.max_threads)


def read(columns: Any, quantity: Any, floor: Any) -> tuple[str, str, float]:
    """The arguments of the extension for what a file of samples does not state."""
    if not isinstance(columns, str):
        raise ValueError(f"columns: expected names as one text, found {columns!r}")
    named = "" if quantity is None else one_of("quantity", quantity, get_args(Quantity))
    return columns, named, number("floor", floor, 0, 1e12)


def check_progress(value: Any) -> None:
    if not isinstance(value, bool) and not callable(value):
        raise ValueError(f"progress: expected True, False or a function of (stage, fraction), found {value!r}")


def _text(value: Any) -> str:
    """The value as on a command line. A string that is a number keeps its quotes, so that it is refused."""
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value)).lower()
    if isinstance(value, str):
        return value if value[:1].isalpha() else repr(value)
    if hasattr(value, "__index__"):
        return str(operator.index(value))
    return repr(float(value)) if hasattr(value, "__float__") else repr(value)


def request(options: Mapping[str, Any]) -> _srbf.Request:
    """The request of a fit. Options that are None keep their defaults."""
    for name in options:
        if name not in _srbf.fit_options():
            raise TypeError(f"unexpected keyword argument {name!r}; expected one of {', '.join(_srbf.fit_options())}")
    return _srbf.Request({name: _text(value) for name, value in options.items() if value is not None})


def show_options(function: Callable[..., Any]) -> None:
    """Adds the options of fits to the signature that `help` shows."""
    signature = inspect.signature(function)
    named = [p for p in signature.parameters.values() if p.kind != p.VAR_KEYWORD]
    options = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None)
               for name in _srbf.fit_options() if name not in signature.parameters]
    setattr(function, "__signature__", signature.replace(parameters=named + options))
