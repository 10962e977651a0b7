"""Models as BSDFs of Mitsuba 3: `import srbf.mitsuba`, and with an RGB variant

    mitsuba.load_dict({"type": "srbf", "filename": "film.srbf"})

or {"type": "srbf", "model": "name"} for a model given to `register(name, model)`. Multivariate models and Lambert and GGX, by the
library's own formulas printed for Dr.Jit; sampling and its density too. Mitsuba's `wi` points to the camera and `wo` to the light in
paths from the camera: they are the viewer and the light here.
"""
from __future__ import annotations

import types
from typing import Any

import drjit as dr
import mitsuba as mi

import srbf
from srbf import _srbf

_LOBES = 16
_models: dict[str, srbf.Model] = {}


def register(name: str, model: srbf.Model) -> None:
    """Names a model, for {"type": "srbf", "model": name}."""
    _models[name] = model


def _functions(model: srbf.Model) -> types.SimpleNamespace:
    """The model's functions over numbers or arrays of the current variant."""
    is_scalar = mi.variant().startswith("scalar")

    def select(condition: Any, a: Any, b: Any) -> Any:
        if isinstance(condition, bool):
            return a if condition else b
        return dr.select(condition, a, b)

    def at(table: Any, i: Any) -> Any:
        return table[0][i] if isinstance(i, int) else dr.gather(mi.Float, table[1], i)

    def minimum(a: Any, b: Any) -> Any:
        return select(a < b, a, b)  # old versions of LLVM have no instruction for it

    def maximum(a: Any, b: Any) -> Any:
        return select(a > b, a, b)

    names: dict[str, Any] = {
        "exp": dr.exp, "exp2": dr.exp2, "log": dr.log, "sqrt": dr.sqrt, "inversesqrt": dr.rsqrt, "cos": dr.cos, "sin": dr.sin,
        "abs": abs, "minimum": minimum, "maximum": maximum, "dot": dr.dot, "Vec3": mi.Vector3f, "Real": mi.Float,
        "whole": int if is_scalar else mi.Int32, "select": select, "at": at, "Structure": types.SimpleNamespace,
        "table": lambda numbers: (numbers, None if is_scalar else mi.Float(numbers)),
    }
    exec(_srbf.python_code(model._held), names)
    return types.SimpleNamespace(**{name: names[name] for name in ("brdf", "chosen_lobe", "sample_of_lobe", "light_pdf")})


def _register_plugin() -> None:
    """For the current variant, which mi.BSDF and all types of numbers depend on."""

    class ModelBSDF(mi.BSDF):
        def __init__(self, props: mi.Properties):
            mi.BSDF.__init__(self, props)
            if not mi.is_rgb:
                raise RuntimeError(f"srbf: expected an RGB variant of Mitsuba, found {mi.variant()}")
            if "filename" in props:
                resolver = mi.file_resolver()
                self.model = srbf.load(str(resolver.resolve(props["filename"])))
            else:
                self.model = _models[props["model"]]
            if not isinstance(self.model, srbf.Model):
                raise RuntimeError(f"srbf: expected a model, found {self.model!r} (see srbf.fit)")
            self.f = _functions(self.model)
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            if not self.model.isotropic:
                flags |= mi.BSDFFlags.Anisotropic
            self.m_flags = flags
            self.m_components = [flags]

        def _value(self, si: Any, wo: Any) -> Any:
            f = self.f.brdf(mi.Vector3f(wo), mi.Vector3f(si.wi))
            cosine = dr.select(wo.z > 0, wo.z, 0)
            return mi.Color3f(f.x * cosine, f.y * cosine, f.z * cosine)

        def _asked(self, ctx: Any) -> bool:
            return ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0)

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            wv = mi.Vector3f(si.wi)
            chosen = self.f.chosen_lobe(wv, sample1)
            if isinstance(chosen, int):
                wo = self.f.sample_of_lobe(chosen, wv, sample2.x, sample2.y)
            else:
                wo = mi.Vector3f(0)
                for k in range(_LOBES):
                    wo = dr.select(chosen == k, self.f.sample_of_lobe(k, wv, sample2.x, sample2.y), wo)
            sample = mi.BSDFSample3f()
            sample.wo = wo
            sample.eta = 1
            sample.sampled_type = +mi.BSDFFlags.GlossyReflection
            sample.sampled_component = 0
            sample.pdf = self.f.light_pdf(wo, wv)
            valid = (sample.pdf > 0) & active & self._asked(ctx)
            if not valid if isinstance(valid, bool) else False:
                sample.pdf = 0
                return sample, mi.Color3f(0)
            value = self._value(si, wo) / dr.select(sample.pdf > 1e-20, sample.pdf, 1e-20)
            sample.pdf = dr.select(valid, sample.pdf, 0)
            return sample, dr.select(valid, value, mi.Color3f(0))

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return dr.select(active & self._asked(ctx), self._value(si, wo), mi.Color3f(0))

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return dr.select(active & self._asked(ctx), self.f.light_pdf(mi.Vector3f(wo), mi.Vector3f(si.wi)), 0.0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def traverse(self, callback: Any) -> None:
            pass

        def to_string(self) -> str:
            return f"ModelBSDF[{self.model!r}]"

    mi.register_bsdf("srbf", ModelBSDF)


def _on_variant(_old: Any = None, _new: Any = None) -> None:
    _register_plugin()


if mi.variant() is not None:
    _register_plugin()
mi.detail.add_variant_callback(_on_variant)
