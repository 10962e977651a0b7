"""Measured BRDFs as a few spherical radial basis functions.

A BRDF's values are f_r [1/sr] for R, G, B in linear sRGB, without the cosine. `wl` points to the light and `wv` to the viewer: unit
vectors in the local frame, whose +z axis is the normal, in arrays of shape [..., 3] whose leading axes broadcast. float32 arrays that
are contiguous are not copied.
"""
from __future__ import annotations

import dataclasses
import os
import struct
import warnings
import zlib
from typing import Any, Callable, Literal, Mapping, Optional, Sequence, TypeVar, Union

import numpy as np
import numpy.typing as npt

__all__ = ["Brdf", "Error", "Fit", "Measurement", "Model", "code", "code_languages", "convert", "errors", "fit", "fit_batch", "formats", "forms",
           "from_arrays", "lightings", "load", "load_measurement", "load_model", "load_texels", "objectives", "png", "render"]

Array = npt.NDArray[np.float32]


class Error(ValueError):
    """What is wrong with an input.

    Attributes: `file` (or the computation that reports it), `offset` (byte of a binary file, line of a text; None: unknown), `what`,
    `expected`, `found`, and `code`: "malformed", "unreadable", "wrong kind", "argument", "no data" or "cancelled".
    """

    def __init__(self, message: str, file: str = "", offset: Optional[int] = None, what: str = "", expected: str = "", found: str = "",
                 code: str = ""):
        super().__init__(message)
        self.file, self.offset, self.what = file, offset, what
        self.expected, self.found, self.code = expected, found, code


from . import _srbf  # noqa: E402  (it raises Error)
from . import _options  # noqa: E402
from ._options import Language, Lighting, Path, Progress  # noqa: E402

if int(np.__version__.split(".")[0]) >= 2 and not _srbf.knows_numpy_2:
    raise ImportError(f"srbf was built with a pybind11 before 2.12, which NumPy {np.__version__} does not fit; build it with `pip install .`")

__version__: str = _srbf.version


def _numbers(array: npt.ArrayLike, name: str, last: Optional[int] = 3) -> Array:
    """`array` as float32, with that many numbers along its last axis."""
    array = np.asarray(array)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{name}: expected real numbers, found dtype {array.dtype}")
    if last is not None and (array.ndim == 0 or array.shape[-1] != last):
        raise ValueError(f"{name}: expected shape [..., {last}], found {list(array.shape)}")
    return array.astype(np.float32, copy=False)


def _rows(arrays: Sequence[Array], names: Sequence[str]) -> tuple[tuple[int, ...], list[Array]]:
    """The common leading shape of arrays [..., 3], and the arrays as contiguous rows [n, 3]."""
    try:
        shape = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
    except ValueError:
        shapes = ", ".join(f"{name} {list(array.shape)}" for name, array in zip(names, arrays))
        raise ValueError(f"shapes that do not broadcast: {shapes}") from None
    return shape, [np.ascontiguousarray(np.broadcast_to(array, shape + array.shape[-1:])).reshape(-1, array.shape[-1])
                   for array in arrays]


def _pairs(wl: npt.ArrayLike, wv: npt.ArrayLike) -> tuple[tuple[int, ...], list[Array]]:
    return _rows((_numbers(wl, "wl"), _numbers(wv, "wv")), ("wl", "wv"))


_AnyBrdf = TypeVar("_AnyBrdf", bound="Brdf")


class Brdf:
    """A measurement or a model. Thread-safe; the interpreter's lock is released while it computes."""

    def __init__(self, held: _srbf.Brdf):
        self._held = held

    def __eq__(self, other: object) -> bool:
        """Whether it is of the same kind with the same numbers; file names and provenance do not count."""
        if type(other) is not type(self):
            return NotImplemented
        return self._held.numbers() == other._held.numbers()

    def __hash__(self) -> int:
        return hash(self._held.numbers())

    def __reduce__(self) -> tuple[Any, ...]:
        data = self._held.pickled()
        return _unpickled, (__version__, data, zlib.crc32(data), self._held.is_exchanged())

    def eval(self, wl: npt.ArrayLike, wv: npt.ArrayLike) -> Array:
        """f_r [1/sr] of shape [..., 3]: 0 where a direction is below the horizon, NaN where nothing was measured."""
        shape, rows = _pairs(wl, wv)
        return self._held.evaluate(*rows).reshape(shape + (3,))

    def eval_spectral(self, wl: npt.ArrayLike, wv: npt.ArrayLike) -> Array:
        """f_r [1/sr] at `wavelengths` [..., C]; of a BRDF without wavelengths R, G, B."""
        shape, rows = _pairs(wl, wv)
        return self._held.evaluate_channels(*rows).reshape(shape + (-1,))

    def sample(self, wv: npt.ArrayLike, u: Optional[npt.ArrayLike] = None,
               rng: Optional[np.random.Generator] = None) -> tuple[Array, Array, Array]:
        """Importance-samples the light: directions [..., 3], weights f_r cos(theta_l) / pdf [..., 3] and densities [...].

        `u` [..., 3] are numbers uniform in [0, 1): a point of the square and the choice of a lobe; without them `rng` draws. A draw
        without a direction is (0, 0, -1), with density and weight 0.
        """
        views = _numbers(wv, "wv")
        if u is None:
            u = (rng or np.random.default_rng()).random(views.shape, np.float32)
        given = np.asarray(u)
        uniform = _numbers(given, "u")
        if not ((given >= 0) & (given < 1)).all():
            raise ValueError("u: expected numbers in [0, 1)")
        if given.dtype != np.float32:
            uniform = np.minimum(uniform, np.nextafter(np.float32(1), np.float32(0)))  # a number just below 1 may have become 1
        shape, (rows, numbers) = _rows((views, uniform), ("wv", "u"))
        wl, weight, density = self._held.sample(rows, numbers)
        return wl.reshape(shape + (3,)), weight.reshape(shape + (3,)), density.reshape(shape)

    def pdf(self, wl: npt.ArrayLike, wv: npt.ArrayLike) -> Array:
        """The density of `sample` [1/sr], of shape [...]; 0 below the horizon."""
        shape, rows = _pairs(wl, wv)
        return self._held.density(*rows).reshape(shape)

    def albedo(self, cos_v: npt.ArrayLike) -> Array:
        """Directional albedo [..., 3] of views at the cosines `cos_v` [...] in (0, 1], in the mean over azimuths; within 1 % or 0.002 for
        smooth and glossy BRDFs."""
        cosine = _numbers(cos_v, "cos_v", None)
        if not ((cosine > 0) & (cosine <= 1)).all():
            raise ValueError("cos_v: expected cosines in (0, 1]")
        return self._held.reflected(np.ascontiguousarray(cosine).reshape(-1)).reshape(cosine.shape + (3,))

    def exchanged(self: _AnyBrdf) -> _AnyBrdf:
        """The BRDF with light and viewer exchanged."""
        return type(self)(self._held.exchanged())

    @property
    def is_exchanged(self) -> bool:
        """Whether light and viewer are those of its file, or of the data that a model was fitted to, exchanged."""
        return self._held.is_exchanged()

    @property
    def isotropic(self) -> bool:
        """Whether f_r depends only on the difference of the azimuths."""
        return self._held.isotropic()

    @property
    def wavelengths(self) -> Array:
        """[nm], of a spectral BRDF; otherwise empty."""
        return self._held.wavelengths()

    @property
    def nbytes(self) -> int:
        """Of a model its stored numbers, of a measurement its file."""
        return self._held.nbytes()

    def _repr_png_(self) -> bytes:
        picture = _doubled(_srbf.render(self._held, "studio", 64, True)) if self._held.is_searched() else \
            _srbf.render(self._held, "studio", 160, True)
        return png(picture * (0.75 / max(float(np.percentile(picture.max(axis=-1), 90)), 1e-9)))


def _doubled(picture: Array) -> Array:
    """With twice as many pixels along each side, interpolated."""
    for axis in (0, 1):
        n = picture.shape[axis]
        nearest = np.repeat(np.arange(n), 2)
        next_one = np.clip(nearest + np.tile([-1, 1], n), 0, n - 1)
        picture = np.float32(0.75) * np.take(picture, nearest, axis) + np.float32(0.25) * np.take(picture, next_one, axis)
    return picture


class Measurement(Brdf):
    """A measured BRDF."""

    @property
    def format(self) -> str:
        """One of `formats()`, or "arrays"; of columns that were named "columns", of tensor trees "BSDF tree"."""
        return self._held.kind()

    @property
    def notes(self) -> list[str]:
        """What its reader assumed of units, azimuths and names, and what it masked as no value; a line each."""
        return self._held.notes()

    @property
    def source(self) -> str:
        """The file's name."""
        return self._held.source()

    def __repr__(self) -> str:
        return f"<srbf.Measurement {self.source!r}, {self.format}, {self.nbytes:,} bytes{', exchanged' * self.is_exchanged}>"


class Model(Brdf):
    """A fitted BRDF."""

    @classmethod
    def from_parameters(cls, parameters: Mapping[str, Any], provenance: Optional[Mapping[str, str]] = None) -> "Model":
        """The model of these numbers, named as in `parameters`, whose inverse it is. They are rounded to the 16-bit floats of the model
        file. Of a multivariate model `log_scale`, `centre`, `exponent`, `form` and `axial` may be left out (0, +z, none, and what
        follows from the arrays). Raises ValueError, of a number out of its range Error."""
        return cls(_srbf.model_of(dict(parameters), dict(provenance or {})))

    def replace(self, **parameters: Any) -> "Model":
        """The model with some of its numbers replaced, rounded as in `from_parameters`."""
        return Model.from_parameters({**self.parameters, **parameters}, self.provenance)

    @property
    def kind(self) -> str:
        """"pm" (parameterized multivariate), "su" (view by view), "ggx" (Lambert and GGX), "openpbr" (a surface) or "bsdf" (reflection and transmission)."""
        return self._held.kind()

    @property
    def parameters(self) -> dict[str, Any]:
        """The numbers of the formula as arrays, by the names of the model file (docs/formats.md); centres as unit vectors. Of a BSDF those
        of each part."""
        return self._held.parameters()

    @property
    def provenance(self) -> dict[str, str]:
        """Source, options and errors of the fit."""
        return self._held.provenance()

    def save(self, path: Path) -> None:
        """Writes the model file."""
        self._held.save(_file_name(path))

    def __repr__(self) -> str:
        return f"<srbf.Model {self.kind}, {self.nbytes:,} bytes{', exchanged' * self.is_exchanged}>"


def _unpickled(version: str, data: bytes, checksum: int, exchanged: bool) -> Brdf:
    if version != __version__:
        raise ValueError(f"pickled BRDF: expected one of srbf {__version__}, found {version}; files keep models for other versions")
    if zlib.crc32(data) != checksum:
        raise ValueError("pickled BRDF: it is damaged")
    return _brdf(_srbf.unpickled(data, exchanged))


@dataclasses.dataclass
class Fit:
    """What a fit found."""

    model: Model
    #: the measures of docs/accuracy.md by their names in JSON: on the matrix, held out ("heldout_..."), of albedo, and of pictures
    errors: Optional[dict[str, Any]]
    seconds: float
    stop_reason: Optional[str]
    #: whether a requested size or ΔE_ITP was reached
    reached: bool

    def __repr__(self) -> str:
        seen = "" if not self.errors or "delta_e_itp" not in self.errors else f", delta_e_itp {self.errors['delta_e_itp']:.2f}"
        return f"<srbf.Fit {self.model!r}{seen}, {self.seconds:.2f} s>"

    def _repr_png_(self) -> bytes:
        return self.model._repr_png_()


def _brdf(held: _srbf.Brdf) -> Union[Model, Measurement]:
    return Model(held) if held.is_model() else Measurement(held)


def _file_name(path: Path) -> bytes:
    """The bytes of a name, which need not be UTF-8."""
    name = os.fsencode(path)
    if b"\0" in name:
        raise Error(f"file name: expected one without NUL, found {path!r}", what="file name", expected="one without NUL", found=repr(path),
                    code="argument")
    return name


def load(path: Path, *, columns: str = "", quantity: Optional[_options.Quantity] = None, floor: float = 0) -> Union[Model, Measurement]:
    """Reads a measurement in one of `formats()`, or a model, recognised by its content. Raises Error."""
    return _brdf(_srbf.load(_file_name(path), *_options.read(columns, quantity, floor)))


def load_measurement(path: Path, *, columns: str = "", quantity: Optional[_options.Quantity] = None, floor: float = 0) -> Measurement:
    """`load` of a measurement. Raises Error for a model too."""
    brdf = load(path, columns=columns, quantity=quantity, floor=floor)
    if isinstance(brdf, Measurement):
        return brdf
    raise _wrong_kind(path, "a measurement", "a model")


def load_model(path: Path) -> Model:
    """`load` of a model. Raises Error for a measurement too."""
    brdf = load(path)
    if isinstance(brdf, Model):
        return brdf
    raise _wrong_kind(path, "a model", "a measurement")


def _wrong_kind(path: Path, expected: str, found: str) -> Error:
    shown = os.fsencode(path).decode("utf-8", "backslashreplace")
    return Error(f"{shown}: input: expected {expected}, found {found}", os.fsdecode(path), None, "input", expected, found, "wrong kind")


def from_arrays(wl: npt.ArrayLike, wv: npt.ArrayLike, f: npt.ArrayLike, isotropic: bool = True) -> Measurement:
    """Samples at pairs of directions [..., 3] as a measurement, f [..., 3] or, for grey ones, [...], [..., 1] or one number. Samples that are not
    finite or below the horizon are dropped. Raises ValueError for f of another shape. Warns if `isotropic`, with which only the difference
    of the azimuths counts, does not hold."""
    shape, (lights, views) = _pairs(wl, wv)
    values = _numbers(f, "f", None)
    if values.ndim == 0:
        values = np.broadcast_to(values, shape)
    if values.shape == shape:
        values = values[..., None]
    if values.shape not in ((*shape, 1), (*shape, 3)):
        raise ValueError(f"f: expected shape {[*shape, 3]} or, for grey ones, {[*shape]}, as of wl and wv, found {list(np.shape(f))}")
    rows = np.ascontiguousarray(np.broadcast_to(values, (*shape, 3))).reshape(-1, 3)
    held = _srbf.from_arrays(lights, views, rows, _options.flag("isotropic", isotropic))
    _warn_of_change(held.change_by_azimuth())
    return Measurement(held)


def _warn_of_change(by_azimuth: float) -> None:
    if by_azimuth > 0:
        warnings.warn(f"isotropic: samples at the same angles but other azimuths differ by {100 * by_azimuth:.0f} % (root mean square), "
                      "which isotropic=True averages; isotropic=False keeps them", stacklevel=3)


class _Shown:
    """Progress as the caller wants it: a callback, or a bar of tqdm where it is installed."""

    def __init__(self, progress: Progress):
        _options.check_progress(progress)
        self.bar: Any = None
        self.callback = progress if callable(progress) else None
        if progress is True:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                return
            self.bar = tqdm(total=100, unit="%", leave=False, bar_format="{desc}: {percentage:.0f}%|{bar}| {remaining}")
            self.callback = self.show

    def show(self, stage: str, fraction: float) -> None:
        self.bar.set_description(stage, refresh=False)
        self.bar.update(100 * fraction - self.bar.n)

    def __enter__(self) -> Optional[Callable[[str, float], Optional[bool]]]:
        return self.callback

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.close()


def _fit_of(outcome: dict[str, Any]) -> Fit:
    return Fit(Model(outcome["model"]), outcome["errors"], outcome["seconds"], outcome["stop_reason"], outcome["reached"])


def fit(brdf: Union[Measurement, Path, Callable[[Array, Array], npt.ArrayLike]], *, progress: Progress = False, **options: Any) -> Fit:
    """Fits a measurement, a file of one, or a function f(wl, wv) of arrays [n, 3] that returns f_r as [n, 3] or [n, 1].

    The options are those of `srbf fit --help`, by their names with "_" for "-": `model` "pm", "su", "ggx" or "openpbr" (of OpenPBR, or
    of another `surface`); `lobes` a number or "auto", or instead of it the size by `budget` [bytes] or `target_delta_e`; `form` one of
    `forms()`; `objective` one of `objectives()`; `max_theta` [degrees]; `channels` "rgb" or "spectral"; flags as `axial` True or False;
    `threads` 0: all. None: the default. The outcome depends on `seed` alone.

    `progress`: True for a bar of tqdm, or a function of (stage, fraction) that may return False to cancel. Ctrl-C cancels.
    """
    request = _options.request(options)
    with _Shown(progress) as callback:
        measured = load_measurement(brdf) if isinstance(brdf, (str, os.PathLike)) else brdf
        if isinstance(measured, Brdf):
            return _fit_of(_srbf.fit(measured._held, request, callback))
        if not callable(measured):
            raise TypeError(f"brdf: expected a measurement, a path or a function, found {type(brdf).__name__}")
        return _fit_of(_srbf.fit_function(measured, request, callback))


_options.show_options(fit)


def fit_batch(wl: npt.ArrayLike, wv: npt.ArrayLike, f: npt.ArrayLike, *, lobes: int = 4, isotropic: bool = True,
              progress: Progress = False, **options: Any) -> list[Fit]:
    """Fits T materials or texels measured at the same M pairs: wl, wv [M, 3], f [T, M, 3], NaN where nothing was measured. Each takes one
    thread, and a shorter search than `fit`; its errors are those at its own values. A texel that cannot be fitted, a black one, say, has
    a model of coefficients 0, errors None and `reached` False. The options are those of `fit`. Warns as `from_arrays` does."""
    lights, views, values = _numbers(wl, "wl"), _numbers(wv, "wv"), _numbers(f, "f")
    if lights.ndim != 2 or views.shape != lights.shape or values.ndim != 3 or values.shape[1:] != lights.shape:
        raise ValueError(f"expected wl [M, 3], wv [M, 3], f [T, M, 3], found {list(lights.shape)}, {list(views.shape)}, {list(values.shape)}")
    if isinstance(lobes, str):
        raise ValueError(f"lobes: expected a number, found {lobes!r}")
    request = _options.request({"lobes": lobes, **options})
    rows = [np.ascontiguousarray(array) for array in (lights, views, values)]
    is_isotropic = _options.flag("isotropic", isotropic)
    if is_isotropic and values.size > 0:
        _warn_of_change(_srbf.change_by_azimuth(rows[0], rows[1], np.ascontiguousarray(values.mean(axis=0))))
    with _Shown(progress) as callback:
        return [_fit_of(outcome) for outcome in _srbf.fit_batch(rows[0], rows[1], rows[2], request, is_isotropic, callback)]


_options.show_options(fit_batch)


def load_texels(path: Path) -> list[Fit]:
    """The fits of one slab of texels, a file that `srbf map` wrote. Their errors hold one number, "error", by the objective's
    measure; a texel that could not be fitted has errors None and `reached` False."""
    return [Fit(Model(held), {"error": error} if state == 0 else None, 0.0, None, state == 0)
            for held, error, state in _srbf.load_stack(_file_name(path))]


def errors(reference: Brdf, other: Union[Brdf, Callable[[Array, Array], npt.ArrayLike]], *, max_theta: float = 80,
           threads: int = 0) -> dict[str, Any]:
    """The measures of docs/accuracy.md of `other` against `reference`, both directions within `max_theta` [degrees] of the normal, as
    `srbf compare --json` names them. `other` may be a function f(wl, wv) as `fit` takes one: a model of your own."""
    theta, count = _options.number("max_theta", max_theta, 1, 90), _options.threads(threads)
    if isinstance(other, Brdf):
        return _srbf.errors(reference._held, other._held, theta, count)
    if not callable(other):
        raise TypeError(f"other: expected a BRDF or a function, found {type(other).__name__}")
    return _srbf.errors_of_function(reference._held, other, theta, count)


def forms() -> list[str]:
    """The names of the forms of multivariate models that `fit` takes."""
    return _srbf.fit_options()["form"]


def objectives() -> list[str]:
    """The names of the objectives of `fit`."""
    return _srbf.fit_options()["objective"]


def code_languages() -> list[str]:
    """The names of the languages that `code` writes besides "three"."""
    return _srbf.code_languages()


def lightings() -> list[str]:
    """The names of the lightings of `render`."""
    return _srbf.lightings()


def formats() -> dict[str, str]:
    """The measured formats, and the endings of the files that `convert` writes; "": it writes none."""
    return _srbf.formats()


def render(brdf: Brdf, lighting: Lighting = "studio", size: int = 256) -> Array:
    """Linear radiance [size, size, 3] of a sphere by direct light, seen from far away; 0 beside it. Without noise."""
    return _srbf.render(brdf._held, _options.one_of("lighting", lighting, lightings()), _options.whole("size", size, 1, 4096), False)


def convert(brdf: Brdf, path: Path, *, spectra: bool = True, threads: int = 0) -> None:
    """Writes the BRDF as a table in one of `formats()`, by the ending of `path`. RGL files have spectra of the same material
    beside the colours unless `spectra` is False, as Mitsuba's RGB variants need it. `threads`: of all but samples."""
    _srbf.convert(brdf._held, _file_name(path), _options.flag("spectra", spectra), _options.threads(threads))


def code(models: Union[Model, Mapping[str, Model]], to: Union[Language, Literal["three"]], *, name: str = "material", sampling: bool = False, albedo: bool = False) -> str:
    """Source code that stands alone, `to` one of `code_languages()` or "three", as `srbf export` writes it. Of one model with
    functions `name`_brdf and so on (of a BSDF `name`_bsdf and `name`_beam), or of several by their names; `name` then begins the names of
    what they share."""
    named = {name: models} if isinstance(models, Model) else models
    language = _options.one_of("to", to, ["three", *code_languages()])
    return _srbf.code([model._held for model in named.values()], list(named), language, _srbf.identifier(name),
                      _options.flag("sampling", sampling), _options.flag("albedo", albedo))


def png(picture: npt.ArrayLike) -> bytes:
    """Linear values [height, width, 3] as a PNG file in sRGB; what is outside of [0, 1] is clipped. A picture of `render` must be
    multiplied by an exposure before."""
    linear = _numbers(picture, "picture")
    if linear.ndim != 3 or linear.size == 0:
        raise ValueError(f"picture: expected shape [height, width, 3], found {list(linear.shape)}")
    shown = np.clip(np.nan_to_num(linear), 0, 1)
    encoded = np.where(shown <= 0.0031308, 12.92 * shown, 1.055 * shown ** (1 / 2.4) - 0.055)
    pixels = (255 * encoded + 0.5).astype(np.uint8)
    height, width = pixels.shape[:2]
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
