"""Models as BSDFs of Mitsuba 3. After `import srbf.mitsuba`, with an RGB variant:

    mitsuba.load_dict({"type": "srbf", "filename": "film.srbf"})

or {"type": "srbf", "model": "name"} for a model that was passed to `register(name, model)`. All models are supported except view-by-view
models and BSDFs. Their numbers are parameters of `mitsuba.traverse`, with the names of `Model.parameters`. Vectorised variants use the
library's own formulas, printed for Dr.Jit and differentiable; scalar variants call the library. In paths from the camera, Mitsuba's `wi`
points to the camera and `wo` to the light: they are the viewer `wv` and the light `wl`.
"""
from __future__ import annotations

import types
import warnings
from typing import Any, Sequence

import drjit as dr
import mitsuba as mi
import numpy as np

import srbf
from srbf import _srbf

_OLDEST_LLVM = 16
_models: dict[str, srbf.Model] = {}
_warned = False


def register(name: str, model: srbf.Model) -> None:
    """Gives a model a name, for {"type": "srbf", "model": name}."""
    _models[name] = model


def _warn_of_direction(model: srbf.Model) -> None:
    """Warns once if a model looks different from its measurement in Mitsuba's `measured`, which uses light and viewer exchanged."""
    global _warned
    source = model.provenance.get("source", "")
    if _warned or model.is_exchanged or not source.endswith(".bsdf"):
        return
    angles = np.linspace(0.1, 1.3, 12)
    wl = np.stack([np.sin(angles), 0 * angles, np.cos(angles)], -1)[:, None]
    wv = wl.swapaxes(0, 1) * [-1, 1, 1]
    value, reverse = model.eval(wl, wv), model.eval(wv, wl)
    if np.abs(value - reverse).max() < 0.01 * value.max():
        return
    _warned = True
    warnings.warn(f"srbf: {model!r} is fitted to {source} as it is, but Mitsuba's own \"measured\" exchanges light and viewer. For the "
                  "same picture, fit srbf.load_measurement(path).exchanged(), or use srbf fit --exchange (docs/python.md)", stacklevel=4)


def _llvm_version() -> tuple[int, ...]:
    return tuple(dr.detail.llvm_version())


def _require_variant() -> None:
    variant = mi.variant() or ""
    if not mi.is_rgb:
        raise RuntimeError(f"srbf: expected an RGB variant of Mitsuba, found {variant}")
    if variant.startswith("llvm") and _llvm_version()[0] < _OLDEST_LLVM:
        raise RuntimeError(f"srbf: expected LLVM {_OLDEST_LLVM} or later, found {'.'.join(map(str, _llvm_version()))}; DRJIT_LIBLLVM_PATH "
                           "names the library that Dr.Jit loads")


def _functions(model: srbf.Model, parameters: dict[str, Any]) -> types.SimpleNamespace:
    """The model's functions over arrays of the current variant. They read `parameters` when they are called. The numbers that can
    change are added to `parameters`, as tensors."""

    def table(numbers: list[float], sources: Sequence[tuple[str, int]] = ()) -> Any:
        for name in dict.fromkeys(name.lstrip("-") for name, _ in sources if name):
            parameters[name] = mi.TensorXf(model.parameters[name])
        if sources:
            return list(zip(numbers, sources))
        return mi.Float(numbers) if dr.is_array_v(mi.Float) else None

    def at(table: Any, i: Any) -> Any:
        if not isinstance(table, list):
            return dr.gather(mi.Float, table, mi.UInt32(i))
        value, (name, index) = table[i]
        if not name:
            return mi.Float(value)
        number = dr.gather(mi.Float, parameters[name.lstrip("-")].array, mi.UInt32(index))
        return -number if name[0] == "-" else number

    def select(condition: Any, a: Any, b: Any) -> Any:
        if isinstance(condition, bool):
            return a if condition else b
        return dr.select(condition, a, b)

    names: dict[str, Any] = {
        "exp": dr.exp, "exp2": dr.exp2, "log": dr.log, "sqrt": dr.sqrt, "inversesqrt": dr.rsqrt, "cos": dr.cos, "sin": dr.sin,
        "abs": abs, "minimum": lambda a, b: select(a < b, a, b), "maximum": lambda a, b: select(a > b, a, b), "dot": dr.dot,
        "Vec3": mi.Vector3f, "Real": mi.Float, "whole": mi.Int32, "select": select, "at": at, "Structure": types.SimpleNamespace,
        "table": table,
    }
    exec(_srbf.python_code(model._native), names)
    return types.SimpleNamespace(**{name: names[name] for name in ("components", "brdf", "chosen_lobe", "sample_of_lobe", "light_pdf")})


def _model_of(props: Any) -> srbf.Model:
    if "filename" in props:
        model = srbf.load(str(mi.file_resolver().resolve(props["filename"])))
    elif props["model"] in _models:
        return _models[props["model"]]
    else:
        raise RuntimeError(f"srbf: expected a model named by srbf.mitsuba.register, found \"{props['model']}\"")
    if not isinstance(model, srbf.Model):
        raise RuntimeError(f"srbf: expected a model, found {model!r} (see srbf.fit)")
    return model


def _model_bsdf() -> Any:
    """What the BSDFs of all variants have in common. mi.BSDF and all numeric types depend on the current variant."""

    class ModelBSDF(mi.BSDF):
        def __init__(self, props: Any):
            mi.BSDF.__init__(self, props)
            _require_variant()
            self._model = _model_of(props)
            _warn_of_direction(self._model)
            self.parameters: dict[str, Any] = {}
            self.f = _functions(self._model, self.parameters)
            self._changed = False
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            if not self._model.isotropic:
                flags |= mi.BSDFFlags.Anisotropic
            self.m_flags = flags
            self.m_components = [flags]

        @property
        def model(self) -> srbf.Model:
            """The model with the current parameters, rounded to 16-bit floats."""
            if self._changed:
                numbers = {name: np.array(tensor) for name, tensor in self.parameters.items()}
                if "centre" in numbers:
                    numbers["centre"] /= np.linalg.norm(numbers["centre"], axis=-1, keepdims=True)
                self._model, self._changed = self._model.replace(**numbers), False
            return self._model

        def traverse(self, callback: Any) -> None:
            for name, tensor in self.parameters.items():
                callback.put(name, tensor, mi.ParamFlags.Differentiable)

        def parameters_changed(self, keys: Any) -> None:
            self._changed = True

        def _is_enabled(self, ctx: Any) -> bool:
            return bool(ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0))

        def _sample(self, wo: Any, pdf: Any) -> Any:
            sample = mi.BSDFSample3f()
            sample.wo, sample.pdf = wo, pdf
            sample.eta = 1.0
            sample.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            sample.sampled_component = mi.UInt32(0)
            return sample

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def to_string(self) -> str:
            return f"ModelBSDF[{self._model!r}]"

    return ModelBSDF


def _compiled_bsdf(base: Any) -> Any:
    class CompiledBSDF(base):
        """Calls the library, with one pair of directions at a time."""

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            if not (active and self._is_enabled(ctx)):
                return self._sample(mi.Vector3f(0, 0, -1), 0.0), mi.Color3f(0)
            x, y, z, r, g, b, pdf = self.model._native.sample_at(si.wi[0], si.wi[1], si.wi[2], sample2[0], sample2[1], sample1)
            return self._sample(mi.Vector3f(x, y, z), pdf), mi.Color3f(r, g, b)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            if not (active and self._is_enabled(ctx)):
                return mi.Color3f(0), 0.0
            r, g, b, pdf = self.model._native.value_at(wo[0], wo[1], wo[2], si.wi[0], si.wi[1], si.wi[2])
            return max(wo[2], 0.0) * mi.Color3f(r, g, b), pdf

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(ctx, si, wo, active)[1]

    return CompiledBSDF


def _array_bsdf(base: Any) -> Any:
    class ArrayBSDF(base):
        """Uses the printed formulas, on arrays. Samples keep the density of the loaded model if parameters change."""

        def _value(self, si: Any, wo: Any) -> Any:
            f = self.f.brdf(mi.Vector3f(wo), mi.Vector3f(si.wi))
            return dr.select(wo.z > 0, wo.z, 0) * mi.Color3f(f.x, f.y, f.z)

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            wv = mi.Vector3f(si.wi)
            chosen = self.f.chosen_lobe(wv, sample1)
            wo = mi.Vector3f(0)
            for k in range(self.f.components):
                wo = dr.select(chosen == k, self.f.sample_of_lobe(k, wv, sample2.x, sample2.y), wo)
            pdf = self.f.light_pdf(wo, wv)
            valid = (pdf > 0) & active & self._is_enabled(ctx)
            weight = self._value(si, wo) / dr.select(pdf > 1e-20, pdf, 1e-20)
            return self._sample(wo, dr.select(valid, pdf, 0)), dr.select(valid, weight, mi.Color3f(0))

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return dr.select(active & self._is_enabled(ctx), self._value(si, wo), mi.Color3f(0))

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return dr.select(active & self._is_enabled(ctx), self.f.light_pdf(mi.Vector3f(wo), mi.Vector3f(si.wi)), 0.0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    return ArrayBSDF


def _on_variant(_old: Any = None, _new: Any = None) -> None:
    make = _compiled_bsdf if (mi.variant() or "").startswith("scalar") else _array_bsdf
    mi.register_bsdf("srbf", make(_model_bsdf()))


if mi.variant() is not None:
    _on_variant()
mi.detail.add_variant_callback(_on_variant)
