"""Fits the microfacet model ABC and small networks to pairs of directions: python3 paper/classic_brdfs.py FILE...

Prints the visible error of ABC by each loss and weight below. Needs the package `srbf` (PYTHONPATH=build/release/python)
and NumPy. The fits are our own: Levenberg-Marquardt from several starts, without random numbers. ABC is the model of
Löw, Kronander, Ynnerman and Unger, BRDF Models for Accurate and Efficient Rendering of Glossy Surfaces, 2012,
https://doi.org/10.1145/2077341.2077350; brdf_families.py has the networks.
"""
import sys
from typing import NamedTuple

import numpy as np
import brdf_families

MAX_THETA = 80  # [degrees], for the pairs of a fit and for errors
# [degrees], for the pairs of networks, which are undefined beyond. The limit with the smaller visible error counts.
MAX_THETAS_OF_NETWORKS = (80, 88)
PAIRS = 12_000  # before those beyond MAX_THETA are removed


class Angles(NamedTuple):
    """Cosines of n pairs of directions, arrays [n]."""
    cos_l: np.ndarray
    cos_v: np.ndarray
    cos_h: np.ndarray  # cosθh of the half vector
    cos_d: np.ndarray  # cosθd of the light in the half vector's frame


def angles(wl, wv):
    wl, wv = np.asarray(wl, float), np.asarray(wv, float)
    length = np.maximum(np.linalg.norm(wl + wv, axis=-1), 1e-12)
    return Angles(wl[..., 2], wv[..., 2], np.minimum((wl + wv)[..., 2] / length, 1), np.minimum(length / 2, 1))


class Parameter(NamedTuple):
    name: str
    low: float
    high: float
    logarithmic: bool  # true if the fit varies its logarithm


class Abc:
    """f = (kd + A F(η, θd) G / (cosθl cosθv (1 + (1 - cosθh) / w²)^C)) / π, with kd and A for each channel, w, C and η.

    w = B^(-1/2) for the authors' B, which exceeds 16-bit floats. F is the Fresnel term of a dielectric for unpolarized
    light, G the shadowing of V-shaped grooves.
    """
    parameters = [Parameter("kd", 0, 4, False)] * 3 + [Parameter("A", 1e-6, 6e4, True)] * 3 + [
        Parameter("w", 1e-4, 3, True), Parameter("C", 0.02, 60, True), Parameter("eta", 1.01, 100, True)]

    @staticmethod
    def fresnel(eta, cos_d):
        g = np.sqrt(eta * eta - 1 + cos_d ** 2)
        return 0.5 * ((g - cos_d) / (g + cos_d)) ** 2 * (1 + ((cos_d * (g + cos_d) - 1) / (cos_d * (g - cos_d) + 1)) ** 2)

    @staticmethod
    def value(x, angle, derivatives=False):
        """f [n, 3], and if `derivatives` its derivatives by the coordinates of the fit, [9, n, 3]."""
        kd, scale, (w, exponent, eta) = x[:3], x[3:6], x[6:9]
        shadowing = np.minimum(1, 2 * angle.cos_h * np.minimum(angle.cos_l, angle.cos_v) / angle.cos_d)
        ratio = (1 - angle.cos_h) / (w * w)
        rest = shadowing / (np.pi * angle.cos_l * angle.cos_v) * (1 + ratio) ** -exponent
        fresnel = Abc.fresnel(eta, angle.cos_d)
        lobes = (rest * fresnel)[:, None] * scale
        f = kd / np.pi + lobes
        if not derivatives:
            return f
        by = np.zeros((9,) + f.shape)
        for c in range(3):
            by[c, :, c], by[3 + c, :, c] = 1 / np.pi, lobes[:, c]
        by[6] = lobes * (2 * exponent * ratio / (1 + ratio))[:, None]
        by[7] = lobes * (-exponent * np.log1p(ratio))[:, None]
        by[8] = (rest * (Abc.fresnel(eta * 1.000001, angle.cos_d) - fresnel) / 1e-6)[:, None] * scale
        return f, by

    @staticmethod
    def starts(f, angle):
        for w in (1, 0.2, 0.05, 0.015, 0.004, 0.0012):
            for exponent in (0.7, 1.6):
                for eta in (1.5, 8):
                    x = np.concatenate([np.zeros(3), np.ones(3), [w, exponent, eta]])
                    yield with_scales(Abc, x, f, angle, slice(0, 3), slice(3, 6))


MODELS = {"abc": Abc, **{f"network-{width}": brdf_families.Network(Parameter, width) for width in (4, 6)}}
LOSSES = {  # the function of f that a fit compares, and its derivative
    "log": (lambda f, cos_l: np.log1p(f * cos_l), lambda f, cos_l: cos_l / (1 + f * cos_l)),  # the loss of Löw et al.
    "cube-root": (lambda f, cos_l: np.cbrt(f + 1e-4), lambda f, cos_l: np.cbrt(f + 1e-4) ** -2 / 3),
}
# The power of the solid angle of a node in MERL's layout.
WEIGHTS = {"solid-angle": 1, "between": 0.5, "table": 0}
# The loss and weight with the smallest mean visible error of five measurements, for all of these models.
CHOSEN = ("cube-root", "between")


def with_scales(model, x, f, angle, diffuse, specular):
    """x with a diffuse term from values far from the highlight, and a scale that reproduces the sum of cube roots of the rest."""
    x = x.copy()
    x[diffuse] = np.clip(np.pi * np.quantile(f[angle.cos_h < 0.8], 0.3, axis=0), 0, 4)
    lobe = np.cbrt(model.value(np.where(np.arange(len(x)) < diffuse.stop, 0, x), angle)).sum(axis=0)
    rest = np.cbrt(np.maximum(f - x[diffuse] / np.pi, 0)).sum(axis=0)
    x[specular] = np.clip((rest / np.maximum(lobe, 1e-9)) ** 3, 1e-5, 5e4)
    return x


def pairs(max_theta):
    """Light and viewer [n, 3], and the solid angle of each pair. Pairs are uniform in √θh, θd and φd, as MERL's nodes."""
    n = np.arange(PAIRS)[:, None]
    u = (0.5 + n * 1.2207440846057596 ** -np.arange(1.0, 4)) % 1  # Roberts' sequence of three dimensions
    theta_h, theta_d, phi = np.pi / 2 * u[:, 0] ** 2, np.pi / 2 * u[:, 1], np.pi * u[:, 2]
    d = np.stack([np.sin(theta_d) * np.cos(phi), np.sin(theta_d) * np.sin(phi), np.cos(theta_d)], axis=1)
    c, s = np.cos(theta_h), np.sin(theta_h)
    wl = np.stack([c * d[:, 0] + s * d[:, 2], d[:, 1], c * d[:, 2] - s * d[:, 0]], axis=1)
    wv = np.stack([-c * d[:, 0] + s * d[:, 2], -d[:, 1], c * d[:, 2] + s * d[:, 0]], axis=1)
    solid_angle = np.cos(theta_d) * np.sin(theta_d) * np.sin(theta_h) * u[:, 0]
    inside = np.minimum(wl[:, 2], wv[:, 2]) > np.cos(np.radians(max_theta))
    return wl[inside], wv[inside], solid_angle[inside]


def levenberg_marquardt(residuals, x, low, high, iterations):
    """Returns x within [low, high] at a local minimum of the sum of squares, and that sum.

    residuals(x, derivatives) returns the residuals, and if `derivatives` their Jacobian.
    """
    cost, damping = np.sum(residuals(x, False) ** 2), 1e-2
    for _ in range(iterations):
        r, jacobian = residuals(x, True)
        gradient, normal = jacobian @ r, jacobian @ jacobian.T
        free = np.flatnonzero(~((x <= low) & (gradient > 0) | (x >= high) & (gradient < 0)))
        diagonal = np.diag(normal)[free] + 1e-9 * np.diag(normal).max() + 1e-300
        before = cost
        for _ in range(10):
            next_x = x.copy()
            next_x[free] -= np.linalg.solve(normal[np.ix_(free, free)] + damping * np.diag(diagonal), gradient[free])
            next_x = np.clip(next_x, low, high)
            next_cost = np.sum(residuals(next_x, False) ** 2)
            if next_cost < cost:
                x, cost, damping = next_x, next_cost, max(damping / 5, 1e-9)
                break
            damping *= 4
        if cost > before * (1 - 1e-6):
            break
    return x, cost


class Coordinates:
    """The variables of a fit, with bounds: the parameters of a model, or their logarithms."""

    def __init__(self, model):
        self.logarithmic = np.array([p.logarithmic for p in model.parameters])
        bounds = ([getattr(p, end) for p in model.parameters] for end in ("low", "high"))
        self.low, self.high = (self.from_parameters(np.array(bound)) for bound in bounds)

    def from_parameters(self, x):
        return np.where(self.logarithmic, np.log(np.maximum(x, 1e-12)), x)

    def to_parameters(self, y):
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, y, 0)), y)

    def starts(self, model, f, angle):
        return (np.clip(self.from_parameters(x), self.low, self.high) for x in model.starts(f, angle))


def search_of_values(model, f, angle, weight, loss):
    """search(y, every, iterations) returns improved coordinates y by every n-th of the values f [n, channels], and the loss."""
    coordinates = Coordinates(model)
    transform, derivative = LOSSES[loss]

    def search(y, every, iterations):
        near = Angles(*(a[::every] for a in angle))
        cos_l, root = near.cos_l[:, None], np.sqrt(weight[::every])[:, None]
        target = transform(f[::every], cos_l)

        def residuals(y, derivatives):
            if not derivatives:
                return ((transform(model.value(coordinates.to_parameters(y), near), cos_l) - target) * root).ravel()
            value, by = model.value(coordinates.to_parameters(y), near, True)
            jacobian = (by * (derivative(value, cos_l) * root)).reshape(len(y), -1)
            return ((transform(value, cos_l) - target) * root).ravel(), jacobian

        return levenberg_marquardt(residuals, y, coordinates.low, coordinates.high, iterations)

    return search


def fit_values(model, f, angle, weight, loss):
    """The parameters of a model that is fitted to values f [n, channels]."""
    coordinates, search = Coordinates(model), search_of_values(model, f, angle, weight, loss)
    found = [search(y, 5, 12) for y in coordinates.starts(model, f, angle)]
    found = [search(y, 1, 15) for y, _ in sorted(found, key=lambda pair: pair[1])[:4]]
    found = [search(y, 1, 80) for y, _ in sorted(found, key=lambda pair: pair[1])[:2]]
    return coordinates.to_parameters(min(found, key=lambda pair: pair[1])[0])


def fit(measured, name, loss=CHOSEN[0], weights=CHOSEN[1]):
    """Fits a model to a BRDF with `eval`. Returns f(wl, wv), and the size of its parameters as 16-bit floats in bytes."""
    import srbf
    limits = MAX_THETAS_OF_NETWORKS if name.startswith("network") else [MAX_THETA]
    fits = [fit_within(measured, MODELS[name], limit, loss, weights) for limit in limits]
    return fits[0] if len(fits) == 1 else min(fits, key=lambda fitted: srbf.errors(measured, fitted[0], max_theta=MAX_THETA)["delta_e_itp"])


def fit_within(measured, model, max_theta, loss, weights):
    """Fits a model to pairs within `max_theta` [degrees]; returns what `fit` does."""
    wl, wv, solid_angle = pairs(max_theta)
    f = measured.eval(wl.astype(np.float32), wv.astype(np.float32)).astype(float)
    known = np.isfinite(f).all(axis=1)
    f, angle = np.maximum(f[known], 0), angles(wl[known], wv[known])
    weight = solid_angle[known] ** WEIGHTS[weights]
    return function_of(model, fit_values(model, f, angle, weight / weight.mean(), loss))


def function_of(model, parameters):
    """f(wl, wv) of a model with parameters rounded to 16-bit floats, and their size in bytes."""
    fitted = parameters.astype(np.float16)

    def value(wl, wv):
        above = ((np.asarray(wl)[..., 2] > 0) & (np.asarray(wv)[..., 2] > 0))[..., None]
        angle = Angles(*map(np.ravel, angles(np.where(above, wl, [0, 0, 1]), np.where(above, wv, [0, 0, 1]))))
        f = model.value(fitted.astype(float), angle)
        return np.where(above, f.reshape(above.shape[:-1] + (3,)), 0).astype(np.float32)

    return value, fitted.nbytes


def main():
    import srbf
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for path in sys.argv[1:]:
        measured = srbf.load_measurement(path)
        for loss in LOSSES:
            for weights in WEIGHTS:
                value, size = fit(measured, "abc", loss, weights)
                errors = srbf.errors(measured, value, max_theta=MAX_THETA)
                print(path, loss, weights, f"{size} bytes: {errors['delta_e_itp']:.3f}", flush=True)


if __name__ == "__main__":
    main()
