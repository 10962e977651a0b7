"""Measured BRDFs as a few spherical radial basis functions.

A BRDF's values are f_r [1/sr] for R, G, B in linear sRGB, without the cosine. `wl` points to the light and `wv` to the viewer. Both are
unit vectors in the local frame, whose +z axis is the normal, in arrays of shape [..., 3] whose leading axes broadcast. Contiguous
float32 arrays are not copied.
"""
from __future__ import annotations

import dataclasses
import os
import struct
import warnings
import zlib
from typing import Any, Callable, Mapping, Optional, Sequence, TypeVar, Union

import numpy as np
import numpy.typing as npt

__all__ = ["Brdf", "Error", "Fit", "Measurement", "Model", "code", "code_languages", "convert", "errors", "fit", "formats", "forms",
           "from_arrays", "lightings", "load", "load_measurement", "load_model", "objectives", "png", "render"]

Array = npt.NDArray[np.float32]


class Error(ValueError):
    """An invalid input, or a computation that failed.

    Attributes: `file` (or the computation that reports it), `offset` (byte in a binary file, line in a text file; None: unknown), `what`,
    `expected`, `found`, and `code`: "malformed", "unreadable", "wrong kind", "argument", "no data" or "cancelled".
    """

    def __init__(self, message: str, file: str = "", offset: Optional[int] = None, what: str = "", expected: str = "", found: str = "",
                 code: str = ""):
        super().__init__(message)
        self.file, self.offset, self.what = file, offset, what
        self.expected, self.found, self.code = expected, found, code


from . import _srbf  # noqa: E402  (_srbf raises Error)
from . import _options  # noqa: E402
from ._options import HostMaterial, Language, Lighting, Path, Progress  # noqa: E402

if int(np.__version__.split(".")[0]) >= 2 and not _srbf.knows_numpy_2:
    raise ImportError(f"srbf was built with a pybind11 before 2.12, which does not support NumPy {np.__version__}; "
                      "build it with `pip install .`")

__version__: str = _srbf.version


def _numbers(array: npt.ArrayLike, name: str, last: Optional[int] = 3) -> Array:
    """`array` as float32, with `last` numbers along its last axis; None: any number. Masked ones are NaN."""
    array = np.asarray(array.astype(np.float32).filled(np.nan) if isinstance(array, np.ma.MaskedArray) else array)
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
    """A measurement or a model. Thread-safe. Releases the interpreter's lock while it computes."""

    def __init__(self, native: _srbf.Brdf):
        self._native = native

    def __eq__(self, other: object) -> bool:
        """True if both have the same type, and files of the same bytes. File names and provenance do not count."""
        if type(other) is not type(self):
            return NotImplemented
        return self._content() == other._content()

    def __hash__(self) -> int:
        return hash(self._content())

    def _content(self) -> tuple[Any, ...]:
        return self._native.file_bytes(False), self._native.reading()[1:], isinstance(self, Measurement) and self.is_exchanged

    def __reduce__(self) -> tuple[Any, ...]:
        data = self._native.file_bytes(True)
        return _unpickled, (__version__, data, zlib.crc32(data), self._native.reading(), self.is_exchanged)

    def eval(self, wl: npt.ArrayLike, wv: npt.ArrayLike) -> Array:
        """f_r [1/sr] of shape [..., 3]; 0 where a direction is below the horizon, NaN where nothing was measured."""
        shape, rows = _pairs(wl, wv)
        return self._native.evaluate(*rows).reshape(shape + (3,))

    def eval_spectral(self, wl: npt.ArrayLike, wv: npt.ArrayLike) -> Array:
        """f_r [1/sr] at `wavelengths`, of shape [..., C]. A BRDF without wavelengths has the channels R, G, B."""
        shape, rows = _pairs(wl, wv)
        return self._native.evaluate_channels(*rows).reshape(shape + (-1,))

    def sample(self, wv: npt.ArrayLike, u: Optional[npt.ArrayLike] = None,
               rng: Optional[np.random.Generator] = None) -> tuple[Array, Array, Array]:
        """Importance-samples the light: directions [..., 3], weights f_r cos(theta_l) / pdf [..., 3] and densities [...].

        `u` [..., 3] are uniform random numbers in [0, 1): a point in the square, and a selector for the lobe. Without `u`, they are drawn
        from `rng`. A sample without a valid direction is (0, 0, -1), with density and weight 0.
        """
        views = _numbers(wv, "wv")
        if u is None:
            u = (rng or np.random.default_rng()).random(views.shape, np.float32)
        exact = np.asarray(u)
        uniform = _numbers(exact, "u")
        if not ((exact >= 0) & (exact < 1)).all():
            raise ValueError("u: expected numbers in [0, 1)")
        if exact.dtype != np.float32:
            uniform = np.minimum(uniform, np.nextafter(np.float32(1), np.float32(0)))  # a float64 just below 1 may round to 1
        shape, (rows, numbers) = _rows((views, uniform), ("wv", "u"))
        wl, weight, density = self._native.sample(rows, numbers)
        return wl.reshape(shape + (3,)), weight.reshape(shape + (3,)), density.reshape(shape)

    def pdf(self, wl: npt.ArrayLike, wv: npt.ArrayLike) -> Array:
        """The density of `sample` [1/sr], of shape [...]; 0 below the horizon."""
        shape, rows = _pairs(wl, wv)
        return self._native.pdf(*rows).reshape(shape)

    def albedo(self, cos_v: npt.ArrayLike) -> Array:
        """Directional albedo [..., 3] of views with cosines `cos_v` [...] in (0, 1], averaged over azimuths. Accurate to 1 % or
        0.002 for smooth and glossy BRDFs."""
        cosine = _numbers(cos_v, "cos_v", None)
        if not ((cosine > 0) & (cosine <= 1)).all():
            raise ValueError("cos_v: expected cosines in (0, 1]")
        return self._native.albedo(np.ascontiguousarray(cosine).reshape(-1)).reshape(cosine.shape + (3,))

    def exchanged(self: _AnyBrdf) -> _AnyBrdf:
        """The BRDF with light and viewer exchanged."""
        return type(self)(self._native.exchanged())

    @property
    def is_exchanged(self) -> bool:
        """True if light and viewer are exchanged, compared with the file or with the data that a model was fitted to."""
        return self._native.is_exchanged()

    @property
    def isotropic(self) -> bool:
        """True if f_r depends only on the difference of the azimuths."""
        return self._native.isotropic()

    @property
    def wavelengths(self) -> Array:
        """The wavelengths [nm] of a spectral BRDF; otherwise empty."""
        return self._native.wavelengths()

    @property
    def nbytes(self) -> int:
        """The bytes of a model's stored numbers, or of a measurement's file."""
        return self._native.nbytes()

    def _repr_png_(self) -> bytes:
        picture = _doubled(_srbf.render(self._native, "studio", 64, True)) if self._native.is_slow() else \
            _srbf.render(self._native, "studio", 160, True)
        return png(picture * (0.75 / max(float(np.percentile(picture.max(axis=-1), 90)), 1e-9)))


def _doubled(picture: Array) -> Array:
    """The picture with twice as many pixels along each side, interpolated linearly."""
    for axis in (0, 1):
        n = picture.shape[axis]
        nearest = np.repeat(np.arange(n), 2)
        neighbour = np.clip(nearest + np.tile([-1, 1], n), 0, n - 1)
        picture = np.float32(0.75) * np.take(picture, nearest, axis) + np.float32(0.25) * np.take(picture, neighbour, axis)
    return picture


class Measurement(Brdf):
    """A measured BRDF."""

    @property
    def format(self) -> str:
        """One of `formats()`, or "arrays", "columns" (if the columns were named) or "BSDF tree" (tensor trees)."""
        return self._native.kind()

    @property
    def notes(self) -> list[str]:
        """What the reader assumed about units, azimuths and names, and what it masked as invalid; one line each."""
        return self._native.notes()

    @property
    def source(self) -> str:
        """The name of the file."""
        return self._native.source()

    def __repr__(self) -> str:
        return f"<srbf.Measurement {self.source!r}, {self.format}, {self.nbytes:,} bytes{', exchanged' * self.is_exchanged}>"


class Model(Brdf):
    """A fitted BRDF."""

    @classmethod
    def from_parameters(cls, parameters: Mapping[str, Any], provenance: Optional[Mapping[str, str]] = None) -> "Model":
        """Makes a model of these numbers, which have the names and meanings of `parameters`. They are rounded to the 16-bit floats of the
        model file. For a multivariate model, `log_scale`, `centre`, `exponent`, `form` and `axial` may be omitted (0, +z, none, and what
        follows from the arrays). Raises ValueError, and Error for a number out of its range."""
        return cls(_srbf.model_of(dict(parameters), dict(provenance or {})))

    def replace(self, **parameters: Any) -> "Model":
        """The model with some of its numbers replaced, rounded as in `from_parameters`."""
        return Model.from_parameters({**self.parameters, **parameters}, self.provenance)

    @property
    def kind(self) -> str:
        """The kind of model, as its file has it: "pm", "bsdf", or another name that `srbf fit --model` takes."""
        return self._native.kind()

    @property
    def parameters(self) -> dict[str, Any]:
        """The numbers of the formula as arrays, with the names of the model file (docs/formats.md) and with centres as unit vectors. A BSDF
        has a dictionary for each of its parts."""
        return self._native.parameters()

    @property
    def provenance(self) -> dict[str, str]:
        """Source, options and errors of the fit."""
        return self._native.provenance()

    # Edits (docs/editing.md) of multivariate models of colours. Each returns a model, whose provenance has "edits",
    # and "limited", which is also a warning, if it would reflect more light than it may.

    def roughen(self, factor: float) -> "Model":
        """Multiplies the roughness of the highlight by `factor` (0.1 to 10), as for facets. Fits the lobes again."""
        return _edited(self._native.roughened(factor))

    def tint(self, highlight: Sequence[float] = (1, 1, 1), body: Sequence[float] = (1, 1, 1)) -> "Model":
        """Multiplies the colours of highlight and body by these, 0 to 10 in R, G, B."""
        return _edited(self._native.tinted(highlight, body))

    def saturate(self, factor: float) -> "Model":
        """Multiplies the distance of colours from grey of the same luminance by `factor` (0 to 4)."""
        return _edited(self._native.saturated(factor))

    def turn_hue(self, degrees: float) -> "Model":
        """Turns colours about grey, and keeps their luminance."""
        return _edited(self._native.hue_turned(degrees))

    def rotate(self, degrees: float) -> "Model":
        """Turns the tangent from x to y. An isotropic model does not change."""
        return Model(self._native.rotated(degrees))

    def coat(self, roughness: float = 0.1, ior: float = 1.5, tint: Sequence[float] = (1, 1, 1)) -> "Model":
        """The surface under a clear coat of this roughness (0.02 to 1) and index of refraction (1.05 to 3); `tint` is the colour of white
        light that passes it twice. A refit with three more lobes."""
        return _edited(self._native.coated(roughness, ior, tint))

    def reduce(self, lobes: int) -> "Model":
        """A fit of this number of lobes to the model."""
        return _edited(self._native.reduced(lobes))

    def blend(self, other: "Model", mix: float = 0.5) -> "Model":
        """(1 - mix) of this model and mix of `other`, with the lobes of both."""
        return Model(self._native.blended(other._native, mix))

    def save(self, path: Path) -> None:
        """Writes the model file."""
        self._native.save(_file_name(path))

    def __repr__(self) -> str:
        return f"<srbf.Model {self.kind}, {self.nbytes:,} bytes{', exchanged' * self.is_exchanged}>"


def _unpickled(version: str, data: bytes, checksum: int, reading: tuple[Any, ...], exchanged: bool) -> Brdf:
    if version != __version__:
        raise ValueError(f"pickled BRDF: expected one of srbf {__version__}, found {version}; files keep models for other versions")
    if zlib.crc32(data) != checksum:
        raise ValueError("pickled BRDF: it is damaged")
    brdf = _brdf(_srbf.unpickled(data, reading))
    return brdf if brdf.is_exchanged == exchanged else brdf.exchanged()


@dataclasses.dataclass
class Fit:
    """The result of a fit."""

    model: Model
    #: the measures of docs/accuracy.md by their names in JSON: on the matrix, held out ("heldout_..."), albedo and pictures; and "headline"
    errors: Optional[dict[str, Any]]
    seconds: float
    stop_reason: Optional[str]
    #: true if the requested ΔE_ITP was reached
    reached: bool

    def __repr__(self) -> str:
        error = "" if not self.errors or "delta_e_itp" not in self.errors else f", delta_e_itp {self.errors['judged_delta_e_itp']:.2f}"
        return f"<srbf.Fit {self.model!r}{error}, {self.seconds:.2f} s>"

    def _repr_png_(self) -> bytes:
        return self.model._repr_png_()


def _brdf(native: _srbf.Brdf) -> Union[Model, Measurement]:
    return Model(native) if native.is_model() else Measurement(native)


def _file_name(path: Path) -> bytes:
    """The bytes of a file name, which need not be UTF-8."""
    name = os.fsencode(path)
    if b"\0" in name:
        raise Error(f"file name: expected one without NUL, found {path!r}", what="file name", expected="one without NUL", found=repr(path),
                    code="argument")
    return name


def load(path: Path, *, columns: str = "", quantity: Optional[_options.Quantity] = None, floor: float = 0) -> Union[Model, Measurement]:
    """Reads a measurement in one of `formats()`, or a model, recognised by the file's content. Raises Error."""
    return _brdf(_srbf.load(_file_name(path), *_options.read(columns, quantity, floor)))


def load_measurement(path: Path, *, columns: str = "", quantity: Optional[_options.Quantity] = None, floor: float = 0) -> Measurement:
    """Reads a measurement like `load`. Raises Error also if the file is a model."""
    brdf = load(path, columns=columns, quantity=quantity, floor=floor)
    if not isinstance(brdf, Measurement):
        raise _wrong_kind(path, "a measurement", "a model")
    return brdf


def load_model(path: Path) -> Model:
    """Reads a model like `load`. Raises Error also if the file is a measurement."""
    brdf = load(path)
    if not isinstance(brdf, Model):
        raise _wrong_kind(path, "a model", "a measurement")
    return brdf


def _wrong_kind(path: Path, expected: str, found: str) -> Error:
    name = os.fsencode(path).decode("utf-8", "backslashreplace")
    return Error(f"{name}: input: expected {expected}, found {found}", os.fsdecode(path), None, "input", expected, found, "wrong kind")


def from_arrays(wl: npt.ArrayLike, wv: npt.ArrayLike, f: npt.ArrayLike, isotropic: bool = True) -> Measurement:
    """Makes a measurement of samples at pairs of directions [..., 3]. Their values `f` have the shape [..., 3] or, if grey, [...], [..., 1]
    or (). Samples that are not finite, masked or below the horizon, or hold a number such as -999 (`notes`), are dropped. Raises
    ValueError for other shapes of `f`. Warns if `isotropic` is True, so that only the difference of the azimuths counts, but the samples
    are anisotropic."""
    shape, (lights, views) = _pairs(wl, wv)
    values = _numbers(f, "f", None)
    if values.ndim == 0:
        values = np.broadcast_to(values, shape)
    if values.shape == shape:
        values = values[..., None]
    if values.shape not in ((*shape, 1), (*shape, 3)):
        raise ValueError(f"f: expected shape {[*shape, 3]} or, if grey, {[*shape]}, like wl and wv, found {list(np.shape(f))}")
    rows = np.ascontiguousarray(np.broadcast_to(values, (*shape, 3))).reshape(-1, 3)
    native = _srbf.from_arrays(lights, views, rows, _options.flag("isotropic", isotropic))
    _warn_of_change(native.change_by_azimuth())
    return Measurement(native)


def _edited(native: Any) -> Model:
    if "limited" in native.provenance():
        warnings.warn(f"limited: {native.provenance()['limited']}", stacklevel=3)
    return Model(native)


def _warn_of_change(by_azimuth: float) -> None:
    if by_azimuth > 0:
        warnings.warn(f"isotropic: samples at the same angles but other azimuths differ by {100 * by_azimuth:.0f} % (root mean square), "
                      "which isotropic=True averages; isotropic=False keeps them", stacklevel=3)


class _ProgressDisplay:
    """Progress for the caller: a callback, or a bar of tqdm if it is installed."""

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

    The options are those of `srbf fit --help`, with "_" for "-" in their names: `model` the name of a kind or of a surface ("openpbr",
    "gltf", "principled"); `lobes` a number or "auto", or instead the visible error as `target_delta_e`; `form` one of `forms()`;
    `objective` one of `objectives()`; `max_theta` [degrees]; `channels` "rgb" or "spectral"; flags such as `axial` True or False;
    `threads` a number, or 0 for all. None is the default of each. The result depends on `seed` only, not on `threads`.

    A table is fitted by a reciprocal model, to the mean of f(wl, wv) and f(wv, wl) weighted by the cosines, with a limit on its albedo
    (`albedo_limit`). `as_measured=True` fits it as it is. Samples, light that passes through a surface and patches are fitted as they are.

    `progress`: True for a bar of tqdm, or a function of (stage, fraction) that returns False to cancel. Ctrl-C cancels too.
    """
    request = _options.request(options)
    with _ProgressDisplay(progress) as callback:
        measured = load_measurement(brdf) if isinstance(brdf, (str, os.PathLike)) else brdf
        if isinstance(measured, Brdf):
            return _fit_of(_srbf.fit(measured._native, request, callback))
        if not callable(measured):
            raise TypeError(f"brdf: expected a measurement, a path or a function, found {type(brdf).__name__}")
        return _fit_of(_srbf.fit_function(measured, request, callback))


_options.show_options(fit)


def errors(reference: Brdf, other: Union[Brdf, Callable[[Array, Array], npt.ArrayLike]], *, max_theta: float = 80,
           threads: int = 0) -> dict[str, Any]:
    """The measures of docs/accuracy.md for `other` against `reference`, with the names of `srbf compare --json`. Both directions are within
    `max_theta` [degrees] of the normal. `other` may be a function f(wl, wv) like that of `fit`, such as a model of your own."""
    theta, count = _options.number("max_theta", max_theta, 1, 90), _options.threads(threads)
    if isinstance(other, Brdf):
        return _srbf.errors(reference._native, other._native, theta, count)
    if not callable(other):
        raise TypeError(f"other: expected a BRDF or a function, found {type(other).__name__}")
    return _srbf.errors_of_function(reference._native, other, theta, count)


def forms() -> list[str]:
    """The names of the forms of multivariate models."""
    return _srbf.fit_options()["form"]


def objectives() -> list[str]:
    """The names of the objectives of `fit`."""
    return _srbf.fit_options()["objective"]


def code_languages() -> list[str]:
    """The names of the languages of `code`, except those of whole materials, such as "three"."""
    return _srbf.code_languages()


def lightings() -> list[str]:
    """The names of the lightings of `render`."""
    return _srbf.lightings()


def formats() -> dict[str, str]:
    """The measured formats, each with the extension of the files that `convert` writes; "" if it writes none."""
    return _srbf.formats()


def render(brdf: Brdf, lighting: Lighting = "studio", size: int = 256) -> Array:
    """Linear radiance [size, size, 3] of a sphere in direct light, seen from infinity; 0 outside the sphere. The picture has no noise."""
    return _srbf.render(brdf._native, _options.one_of("lighting", lighting, lightings()), _options.integer("size", size, 1, 4096), False)


def convert(brdf: Brdf, path: Path, *, spectra: bool = True, threads: int = 0) -> None:
    """Writes the BRDF as a table in one of `formats()`, which the extension of `path` selects. RGL files contain spectra of the same
    material besides the colours unless `spectra` is False, as Mitsuba's RGB variants require. `threads` is not for samples."""
    _srbf.convert(brdf._native, _file_name(path), _options.flag("spectra", spectra), _options.threads(threads))


def code(models: Union[Model, Mapping[str, Model]], to: Union[Language, HostMaterial], *, name: str = "material",
         sampling: bool = False, albedo: bool = False) -> str:
    """Source code that stands alone, in a language `to` of `code_languages()`, or a whole material, "radiance", "three", "three-webgpu" or
    "unity", as `srbf export` writes it. The functions of a single model are `name`_brdf and so on, or `name`_bsdf and `name`_beam for a
    BSDF. Several models have functions named by their keys, and `name` begins the names that they share."""
    named = {name: models} if isinstance(models, Model) else models
    language = _options.one_of("to", to, [*_srbf.host_materials(), *code_languages()])
    return _srbf.code([model._native for model in named.values()], list(named), language, _srbf.identifier(name),
                      _options.flag("sampling", sampling), _options.flag("albedo", albedo))


def png(picture: npt.ArrayLike) -> bytes:
    """Linear values [height, width, 3], clipped to [0, 1], as a PNG file in sRGB. Pictures of `render` need an exposure first."""
    linear = _numbers(picture, "picture")
    if linear.ndim != 3 or linear.size == 0:
        raise ValueError(f"picture: expected shape [height, width, 3], found {list(linear.shape)}")
    clipped = np.clip(np.nan_to_num(linear), 0, 1)
    encoded = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
    pixels = (255 * encoded + 0.5).astype(np.uint8)
    height, width = pixels.shape[:2]
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
