"""Principal components of materials in tables of MERL's layout: a measurement as a few weights of what other materials have in common.

Nielsen, Jensen and Ramamoorthi, On Optimal, Minimal BRDF Sampling for Reflectance Acquisition, 2015,
https://doi.org/10.1145/2816795.2818085. The components are of

    x = log((f c + ε) / (g c + ε))

in all channels at all nodes with both directions above the horizon, about the mean of the materials. c is the product of both
cosines, and g the median of the materials.
"""
import os

import numpy as np
import stand_ins

EPSILON = 1e-3
NODES = (stand_ins.HALF, stand_ins.DIFFERENCE, stand_ins.AZIMUTH)


def directions():
    """Light and viewer of the nodes, arrays [n, 3]."""
    theta_h, theta_d, phi = np.meshgrid((np.arange(NODES[0]) / NODES[0]) ** 2 * np.pi / 2, np.arange(NODES[1]) / NODES[1] * np.pi / 2,
                                        np.arange(NODES[2]) / NODES[2] * np.pi, indexing="ij")
    x, y, z = np.sin(theta_d) * np.cos(phi), np.sin(theta_d) * np.sin(phi), np.cos(theta_d)
    c, s = np.cos(theta_h), np.sin(theta_h)
    return [np.stack([a * c * x + s * z, a * y, c * z - a * s * x], axis=-1).reshape(-1, 3).astype(np.float32) for a in (1, -1)]


class PrincipalComponents:
    def __init__(self, folder):
        """Computes the components of all tables in a folder."""
        wl, wv = directions()
        self.above = np.minimum(wl[:, 2], wv[:, 2]) > 0
        self.wl, self.wv = wl[self.above], wv[self.above]
        self.cosines = self.wl[:, 2:] * self.wv[:, 2:]
        x = np.stack([self.table(os.path.join(folder, name)) for name in sorted(os.listdir(folder)) if name.endswith(".binary")])
        self.median = np.median(x, axis=0)
        for values in x:
            values[:] = self.logarithm(values)
        self.mean = x.mean(axis=0)
        x = (x - self.mean).reshape(len(x), -1)
        variances, vectors = np.linalg.eigh((x @ x.T).astype(float))
        strongest = np.argsort(variances)[:0:-1]  # without the last, which is 0
        self.components = (vectors[:, strongest] / np.sqrt(variances[strongest])).T.astype(np.float32) @ x

    def table(self, path):
        numbers = np.fromfile(path, offset=12).reshape(3, -1)[:, self.above]
        return (np.maximum(numbers, 0).T * stand_ins.SCALE).astype(np.float32)

    def logarithm(self, f):
        return np.log((f * self.cosines + EPSILON) / (self.median * self.cosines + EPSILON))

    def fit(self, measured, count, path):
        """Writes a measurement's table by `count` weights. Returns the bytes of these and of shared numbers as 16-bit floats."""
        f = np.maximum(np.nan_to_num(measured.eval(self.wl, self.wv)), 0)
        components = self.components[:count]
        weights = (components @ (self.logarithm(f) - self.mean).ravel()).astype(np.float16).astype(np.float32)
        x = (weights @ components).reshape(f.shape) + self.mean
        f = np.maximum((np.exp(x) * (self.median * self.cosines + EPSILON) - EPSILON) / self.cosines, 0)
        numbers = np.full((3, len(self.above)), -1.0)
        numbers[:, self.above] = (f / stand_ins.SCALE).T
        with open(path, "wb") as file:
            np.array(NODES, np.int32).tofile(file)
            numbers.tofile(file)
        return 2 * count, 2 * (count + 2) * f.size
