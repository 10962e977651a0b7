"""Fits models of brdf_families.py by the default objective of `srbf`, so that a comparison is one of forms and not of losses.

The loss is that of docs/fitting.md with its weights: pairs, albedos, and pixels of the same pictures. It has no overshoots, and nothing
beyond 89°. As by default, values are those of the reciprocal mean, and pixels of the fit choose among the starts: sixteen are
improved by a quarter of the data, four of them by all, then two and one.
"""
import pathlib
import sys
from typing import NamedTuple

import classic_brdfs
import numpy as np
import brdf_families

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "test"))
from support.visible_error import C1, C2, C3, M1, M2, TO_2020, TO_ITP, TO_LMS  # noqa: E402

MAX_THETA = 89  # [degrees]
VIEWS, POINTS, ALBEDO_POINTS = 100, 112, 455
GOLDEN_ANGLE = 2.4
PHASES = np.radians([3, 11, 24, 38, 52, 70, 88, 105, 122, 140, 156])  # between viewer and directional lights
LIGHTINGS = [  # zenith, horizon and ground, and lamps: direction, radius [degrees] and radiance
    ((1, 0.8, 0.3), []),
    ((0.08, 0.06, 0.05), [((0.6, 0.6, 0.5), 25, 8)]),
    ((0.3, 0.5, 0.1), [((-0.6, 0.3, 0.6), 8, 30)]),
    ((0.05, 0.05, 0.05), [((-0.7, 0.5, -0.4), 15, 20), ((0.3, 0.6, 0.8), 12, 5)])]
ALBEDOS = np.append(np.cos(np.radians([0, 15, 30, 45, 60, 70, 75, 80, 85])), [0.03, 0.01])  # cosθv; two are near the horizon


def spherical(z, phi):
    sine = np.sqrt(np.maximum(1 - z * z, 0))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), z + 0 * phi], axis=-1)


def axes(z):
    """The rows are orthonormal, and the last one is z."""
    x = np.cross([1, 0, 0] if abs(z[0]) < 0.5 else [0, 1, 0], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


def quadrature(wv, count, cos_max):
    """Directions of the mirror mixture of a fit for a view, and the solid angle of each."""
    parts = [(0.4, 0, axes(np.array([0, 0, 1.0]))), (0.05, 60, axes(wv))]  # fraction, bandwidth (0: uniform) and centre
    parts += [(0.11, bandwidth, axes(wv * [-1, -1, 1])) for bandwidth in (6, 40, 300, 3000, 30000)]
    points, weight, pdf = [], [], 0
    for fraction, bandwidth, frame in parts:
        i = np.arange(int(fraction * count))
        u = (i + 0.5) / len(i)
        z = 1 + np.log1p(u * np.expm1(-2 * bandwidth)) / bandwidth if bandwidth else 1 - u * (1 - cos_max)
        points.append(spherical(z, np.pi * (np.sqrt(5) - 1) * i) @ frame)
        weight.append(np.full(len(i), fraction / len(i)))
    wl = np.concatenate(points)
    for fraction, bandwidth, frame in parts:
        norm = bandwidth / -np.expm1(-2 * bandwidth) if bandwidth else 1 / (1 - cos_max)
        pdf = pdf + fraction * norm / (2 * np.pi) * np.exp(bandwidth * (wl @ frame[2] - 1))
    inside = wl[:, 2] >= cos_max
    return wl[inside], (np.concatenate(weight) / pdf)[inside]


def radiance(lighting, w):
    def step(a, b, x):
        x = np.clip((x - a) / (b - a), 0, 1)
        return x * x * (3 - 2 * x)

    (zenith, horizon, ground), lamps = lighting
    light = ground + (horizon + (zenith - horizon) * step(0, 1, w[:, 1]) - ground) * step(-0.1, 0.1, w[:, 1])
    for direction, radius, power in lamps:
        edge = np.cos(np.radians(radius))
        light = light + power * step(edge, edge + 0.1 * (1 - edge), w @ direction / np.linalg.norm(direction))
    return light


def view(i):
    """Point i of a sphere's disc: lights [n, 3], the viewer, and the weight of each light in each picture, not exposed, [15, n]."""
    cos_max, azimuth = np.cos(np.radians(MAX_THETA)), GOLDEN_ANGLE * i
    frame = axes(spherical(np.sqrt(1 - (i + 0.5) / VIEWS * (1 - cos_max ** 2)), np.array(azimuth)))
    frame[0] = np.cos(azimuth) * frame[0] + np.sin(azimuth) * frame[1]
    frame[1] = np.cross(frame[2], frame[0])
    points, solid_angle = quadrature(frame[:, 2], POINTS, cos_max)
    lamps = spherical(np.cos(PHASES), GOLDEN_ANGLE * (4 + np.arange(len(PHASES)))) @ frame.T
    lit = lamps[:, 2] >= cos_max
    weight = np.zeros((len(LIGHTINGS) + len(PHASES), len(points) + len(lamps)))
    weight[:len(LIGHTINGS), :len(points)] = [solid_angle * points[:, 2] * radiance(lighting, points @ frame) for lighting in LIGHTINGS]
    weight[len(LIGHTINGS):, len(points):] = np.diag(np.where(lit, np.pi * lamps[:, 2], 0))
    return np.concatenate([points, np.where(lit[:, None], lamps, [0, 0, 1])]), frame[:, 2], weight


def albedo(k):
    """Lights, viewer and weights [1, n] of an albedo."""
    wv = spherical(ALBEDOS[k], np.array(GOLDEN_ANGLE * k))
    wl, solid_angle = quadrature(wv, ALBEDO_POINTS, np.cos(np.radians(MAX_THETA if ALBEDOS[k] > 0.05 else 89.9)))
    return wl, wv, (solid_angle * wl[:, 2])[None]


def itp(colour):
    """The values of `visible_error.itp` for linear sRGB [n, 3], and their derivatives [n, 3, 3]."""
    to_lms = TO_LMS @ TO_2020
    luminance = np.maximum(colour @ to_lms.T, 1e-9) / 100
    y = luminance ** M1
    encoded = ((C1 + C2 * y) / (1 + C3 * y)) ** M2
    slope = M2 * (C2 - C1 * C3) * M1 / 100 * encoded * y / ((C1 + C2 * y) * (1 + C3 * y) * luminance)
    return encoded @ TO_ITP.T, (TO_ITP * slope[:, None]) @ to_lms


class Block(NamedTuple):
    """Values f [n, 3] of a BRDF, and weights [sums, n] of sums over them: pairs, pixels of a view, or an albedo."""
    wl: np.ndarray
    wv: np.ndarray
    f: np.ndarray
    weight: np.ndarray


def observed(brdf, wl, wv, weight):
    """Values of the reciprocal mean. Missing values have the weight 0."""
    wl, wv = (np.broadcast_to(w, wl.shape).astype(np.float32) for w in (wl, wv))
    there, back = (np.asarray(brdf.eval(*order), float) for order in ((wl, wv), (wv, wl)))
    mean = (wv[:, 2:] * there + wl[:, 2:] * back) / (wv[:, 2:] + wl[:, 2:])
    f = np.where(np.isfinite(mean), mean, np.where(np.isfinite(there), there, back))
    known = np.isfinite(f).all(axis=1)
    return Block(wl, wv, np.where(known[:, None], np.maximum(f, 0), 0), np.where(known, weight, 0))


def weighed(pairs):
    """Replaces the solid angles [1, n] of pairs by weights [1, n] of squared errors."""
    solid_angle, cos_l, cos_v = pairs.weight[0], pairs.wl[:, 2].astype(float), pairs.wv[:, 2].astype(float)
    r, square = pairs.f.mean(axis=1) * cos_l, (pairs.f ** 2).sum(axis=1)
    order = np.argsort(r)
    total = np.cumsum((solid_angle * cos_v * (r > 0))[order])
    q, weight = r[order][np.searchsorted(total, 0.75 * total[-1])], 0
    for importance, slope in ((1, (r + 0.07 * q) ** (-5 / 3) * cos_v), (1, (1 + r / q) ** (-4 / 3) * np.sqrt(cos_v)), (0.3, cos_v)):
        term = solid_angle * cos_l ** 2 * slope
        weight = weight + importance / 2.3 * term / (term @ square)
    return pairs._replace(weight=weight[None])


def observe(brdf):
    """Blocks of pairs, of views and of albedos."""
    wl, wv, solid_angle = classic_brdfs.pairs(MAX_THETA)
    pairs = weighed(observed(brdf, wl, wv, 8 * np.pi ** 4 / classic_brdfs.PAIRS * solid_angle[None]))
    views = [observed(brdf, *view(i)) for i in range(VIEWS)]
    largest = np.stack([(view_block.weight @ view_block.f).max(axis=1) for view_block in views], axis=1)
    exposure = [0.75 / np.quantile(values[values > 0], 0.9, method="inverted_cdf") for values in largest]
    views = [view_block._replace(weight=view_block.weight * np.array(exposure)[:, None]) for view_block in views]
    return pairs, views, [observed(brdf, *albedo(k)) for k in range(len(ALBEDOS))]


class Loss:
    """The loss of a fit and its residuals at every n-th pair and view. `weigh` sets the weights of its terms."""

    def __init__(self, observations, every, model, coordinates, as_ggx=False):
        self.as_ggx = as_ggx
        pairs, views, albedos = observations
        self.pairs = Block(pairs.wl[::every], pairs.wv[::every], pairs.f[::every], pairs.weight[:, ::every] * every)
        self.views, albedos = len(views[::every]), albedos[::min(every, 2)]
        self.blocks = [self.pairs, *views[::every], *albedos]
        self.ends = np.cumsum([len(block.wl) for block in self.blocks])[:-1]
        wl, wv, f = (np.concatenate([block[i] for block in self.blocks]) for i in range(3))
        angle = classic_brdfs.angles(wl, wv)
        self.value = lambda x, derivatives=False: model.value(coordinates.to_parameters(x), angle, derivatives)
        colours, self.albedos = self.sums(f)
        self.limit = np.where(colours < 1, np.inf, 1)
        self.target = itp(np.minimum(colours, 1))[0]
        luminance, horizon = self.albedos @ [0.2126, 0.7152, 0.0722], np.array([block.wv[0, 2] < 0.05 for block in albedos])
        self.unit = np.where(horizon, np.maximum(luminance, 1), luminance)[:, None]

    def sums(self, f):
        """Colours [pixels, ...] and albedos of values f [n, ...] at all directions."""
        sums = [np.tensordot(block.weight, values, 1) for block, values in zip(self.blocks[1:], np.split(f, self.ends)[1:])]
        return np.concatenate(sums[:self.views]), np.concatenate(sums[self.views:])

    def weigh(self, x, least=None):
        """Sets weights that suit the model x, and returns its loss of pairs. `least` is L0; without it the sum has pairs alone."""
        square = ((self.value(x)[:len(self.pairs.f)] - self.pairs.f) ** 2).sum(axis=1)
        weight = self.pairs.weight[0]
        loss = weight @ square
        self.root, self.albedo_weight, self.pixel_weight = np.sqrt(weight)[:, None], 0, 0
        if least is None:
            return loss
        if self.as_ggx:
            self.pixel_weight, pairs = np.sqrt(1 / len(self.target)), self.root.size
            self.root *= np.sqrt(0.3 * np.sum(self.residuals(x, False)[3 * pairs:] ** 2) / loss)
            return loss
        self.albedo_weight = np.sqrt(8 * min(least, 0.004) / (3 * 0.02 ** 2) / len(self.albedos))
        self.pixel_weight = np.sqrt(3.5 * least / self.delta_e(x) / len(self.target))
        return loss

    def delta_e(self, x):
        return np.linalg.norm(itp(np.minimum(self.sums(self.value(x))[0], self.limit))[0] - self.target, axis=1).mean()

    def residuals(self, x, derivatives):
        """Residuals, and if `derivatives` their derivatives, [coordinates, residuals]."""
        f, by = self.value(x, True) if derivatives else (self.value(x), None)
        colours, albedos = self.sums(f)
        shown, slope = itp(np.minimum(colours, self.limit))
        error, pairs = shown - self.target, len(self.root)
        s = np.sqrt((error ** 2).sum(axis=1, keepdims=True) + 1)
        # The pseudo-Huber loss 2 (s - 1) is 2 / (s + 1) times the squared error.
        pixel_weight = self.pixel_weight * np.sqrt(2 / (s + 1))
        rows = [(f[:pairs] - self.pairs.f) * self.root, error * pixel_weight, (albedos - self.albedos) / self.unit * self.albedo_weight]
        r = np.concatenate(rows).ravel()
        if not derivatives:
            return r
        by = by.transpose(1, 2, 0)  # [n, 3, coordinates]
        by_colours, by_albedos = self.sums(by)
        by_error = (slope * (colours < self.limit)[:, None]) @ by_colours
        by_error -= error[..., None] * (error[:, None] @ by_error) / (2 * s * (s + 1))[..., None]
        rows = [by[:pairs] * self.root[..., None], by_error * pixel_weight[..., None],
                by_albedos * (self.albedo_weight / self.unit)[..., None]]
        return r, np.concatenate(rows).reshape(len(r), -1).T


def rounded(loss, x, coordinates):
    """Rounds x to 16-bit floats, one number after the other, while the rest move to the least sum (docs/fitting.md#rounding)."""
    def nearest(x):
        return coordinates.from_parameters(coordinates.to_parameters(x).astype(np.float16).astype(float))

    jacobian, results = loss.residuals(x, True)[1], [nearest(x)]
    normal = jacobian @ jacobian.T
    for damping in (1e-6, 1e-4, 1e-2):
        inverse, y = np.linalg.inv(normal + np.diag(damping * np.diag(normal) + 1e-12 * np.diag(normal).max())), x.copy()
        for i in range(len(x)):
            moved = inverse[:, i] / inverse[i, i] * (nearest(y)[i] - y[i])
            y[i:] = np.clip(y + moved, coordinates.low, coordinates.high)[i:]
            y[i] = nearest(y)[i]
            inverse = inverse - np.outer(inverse[:, i], inverse[i]) / inverse[i, i]
        results.append(y)
    return min(results, key=lambda y: np.sum(loss.residuals(y, False) ** 2))


MODELS = {**{f"gtr-{count}-pictures": brdf_families.Lobes(classic_brdfs.Parameter, count) for count in (1, 2, 3, 6)},
          **{f"lafortune-{count}-pictures": brdf_families.Cosines(classic_brdfs.Parameter, count) for count in (1, 3, 8)},
          **{f"network-{width}-pictures": brdf_families.Network(classic_brdfs.Parameter, width) for width in (2, 4, 6, 9)}}


def fit(brdf, name):
    """Returns what `classic_brdfs.fit` does. The loss of networks has all terms, that of others the pixels and pairs of GGX."""
    model, as_ggx = MODELS[name], not name.startswith("network")
    observations, coordinates = observe(brdf), classic_brdfs.Coordinates(model)
    few, all_ = (Loss(observations, every, model, coordinates, as_ggx) for every in (4, 1))
    angle, weight = classic_brdfs.angles(few.pairs.wl, few.pairs.wv), np.sqrt(classic_brdfs.pairs(MAX_THETA)[2])[::4]
    by_cube_roots = classic_brdfs.search_of_values(model, few.pairs.f, angle, weight / weight.mean(), "cube-root")

    def improve(loss, x, least, iterations):
        loss.weigh(x, least)
        return classic_brdfs.levenberg_marquardt(loss.residuals, x, coordinates.low, coordinates.high, iterations)[0]

    found = [improve(few, by_cube_roots(x, 1, 12)[0], None, 12) for x in coordinates.starts(model, few.pairs.f, angle)]
    least = min(map(few.weigh, found))
    for loss, kept, iterations in ((few, 16, 10), (all_, 4, 20), (all_, 2, 60), (all_, 1, 200)):
        found = sorted((improve(loss, x, least, iterations) for x in found[:kept]), key=loss.delta_e)
    return classic_brdfs.function_of(model, coordinates.to_parameters(rounded(all_, found[0], coordinates)))
