"""Three families of BRDFs of any size, for classic_brdfs.py and fitted_to_pictures.py.

gtr-K      a diffuse term and K microfacet lobes of generalised Trowbridge-Reitz (Burley, Physically-Based Shading at Disney,
           2012): 3 + 8 K numbers
lafortune-K  a diffuse term and K generalised cosine lobes (Lafortune, Foo, Torrance and Greenberg, Non-Linear Approximation of
           Reflectance Functions, 1997): 3 + 6 K numbers
network-N  a network of layers 4, N, N, 3: N² + 9 N + 3 numbers
"""
import numpy as np

TINY = 1e-6  # relative step of differences


def diffuse_of(f, angle):
    """An initial diffuse albedo, from dark values f [n, 3] beside the highlight."""
    return np.clip(np.pi * np.quantile(f[angle.cos_h < 0.8], 0.3, axis=0), 0, 4)


def scale_of(f, diffuse, shape):
    """The initial factor of a lobe, which gives it the sum of cube roots of f [n, 3] without the diffuse term."""
    return (np.cbrt(np.maximum(f - diffuse / np.pi, 0)).sum(axis=0) / np.cbrt(shape).sum()) ** 3


class Lobes:
    """f = kd / π + Σ_k (A_k + B_k (1 - cosθd)⁵) G D / (cosθl cosθv), with kd, A_k and B_k for each channel.

    D = (α² / (α² cos²θh + sin²θh))^γ, and G = G1(θl) G1(θv) with Smith's G1 = 2 cosθ / (cosθ + √(α² + (1 - α²) cos²θ)).
    """
    def __init__(self, parameter, count):
        self.count = count
        self.parameters = [parameter("kd", 0, 4, False)] * 3 + count * (
            [parameter("A", 1e-6, 6e4, True)] * 3 + [parameter("B", 1e-6, 6e4, True)] * 3
            + [parameter("alpha", 2e-3, 1.5, True), parameter("gamma", 0.3, 12, True)])

    @staticmethod
    def shape(alpha, gamma, angle):
        a2 = alpha * alpha
        masking = 1.0
        for cosine in (angle.cos_l, angle.cos_v):
            masking = masking * 2 / (cosine + np.sqrt(a2 + (1 - a2) * cosine ** 2))
        return masking * (a2 / (1 + (a2 - 1) * angle.cos_h ** 2)) ** gamma

    def value(self, x, angle, derivatives=False):
        """f [n, 3], and if `derivatives` its derivatives by the coordinates of the fit, [3 + 8 K, n, 3]."""
        f = np.tile(x[:3] / np.pi, (len(angle.cos_l), 1))
        by = np.zeros((len(x),) + f.shape) if derivatives else None
        fresnel = ((1 - angle.cos_d) ** 5)[:, None]
        for k in range(self.count):
            first = 3 + 8 * k
            a, b, (alpha, gamma) = np.split(x[first:first + 8], [3, 6])
            shape, colour = self.shape(alpha, gamma, angle)[:, None], a + b * fresnel
            f += shape * colour
            if not derivatives:
                continue
            for c in range(3):
                by[first + c, :, c], by[first + 3 + c, :, c] = shape[:, 0] * a[c], shape[:, 0] * (b * fresnel)[:, c]
            for i, moved in enumerate(((alpha * (1 + TINY), gamma), (alpha, gamma * (1 + TINY)))):
                by[first + 6 + i] = (self.shape(*moved, angle)[:, None] - shape) / TINY * colour
        if not derivatives:
            return f
        by[:3] = np.eye(3)[:, None] / np.pi
        return f, by

    def starts(self, f, angle):
        """Lobes from wide to narrow, each with an equal fraction of the values near the mirror direction."""
        diffuse = diffuse_of(f, angle)
        for widest in (0.7, 0.35):
            for narrowest in (0.2, 0.06, 0.02, 0.006):
                for gamma in (1.2, 2.5):
                    alphas = np.geomspace(widest, narrowest, self.count) if self.count > 1 else [np.sqrt(widest * narrowest)]
                    x = [diffuse]
                    for alpha in alphas:
                        shape = self.shape(alpha, gamma, angle)[:, None]
                        scale = scale_of(f, diffuse, shape) / self.count
                        x += [np.clip(scale, 1e-5, 5e4), np.clip(scale, 1e-5, 5e4), [alpha, gamma]]
                    yield np.concatenate(x)


class Cosines:
    """f = kd / π + Σ_k A_k s_k^n_k, s = max(0, Cx (l·v - cosθl cosθv) + Cz cosθl cosθv), with kd and A_k for each channel; Cx = Cy."""
    def __init__(self, parameter, count):
        self.count = count
        self.parameters = [parameter("kd", 0, 4, False)] * 3 + count * (
            [parameter("A", 1e-6, 6e4, True)] * 3 + [parameter("Cx", -4, 4, False), parameter("Cz", -4, 4, False),
                                                     parameter("n", 0.1, 1e4, True)])

    @staticmethod
    def shape(cx, cz, n, angle):
        """s^n, and its derivatives by Cx, Cz and log n."""
        z = angle.cos_l * angle.cos_v
        across = 2 * angle.cos_d ** 2 - 1 - z
        s = np.maximum(cx * across + cz * z, 1e-9)
        power = np.exp(np.minimum(n * np.log(s), 50))
        inside = power * n / s * (s > 1e-9)
        return power, (inside * across, inside * z, power * n * np.log(s))

    def value(self, x, angle, derivatives=False):
        """f [n, 3], and if `derivatives` its derivatives by the coordinates of the fit, [3 + 6 K, n, 3]."""
        f = np.tile(x[:3] / np.pi, (len(angle.cos_l), 1))
        by = np.zeros((len(x),) + f.shape) if derivatives else None
        for k in range(self.count):
            first = 3 + 6 * k
            colour, (power, slopes) = x[first:first + 3], self.shape(*x[first + 3:first + 6], angle)
            f += power[:, None] * colour
            if derivatives:
                for c in range(3):
                    by[first + c, :, c], by[first + 3 + c] = power * colour[c], slopes[c][:, None] * colour
        if not derivatives:
            return f
        by[:3] = np.eye(3)[:, None] / np.pi
        return f, by

    def starts(self, f, angle):
        """Lobes about the mirror direction or beyond it, from wide to narrow, each with an equal fraction of the values."""
        diffuse = diffuse_of(f, angle)
        for least in (1, 5):
            for most in (20, 100, 500, 3000):
                for cx in (-1, -0.9):
                    x = [diffuse]
                    for n in np.geomspace(least, most, self.count) if self.count > 1 else [np.sqrt(least * most)]:
                        scale = scale_of(f, diffuse, self.shape(cx, 1, n, angle)[0]) / self.count
                        x += [np.clip(scale, 1e-5, 5e4), [cx, 1, n]]
                    yield np.concatenate(x)


class Network:
    """f = exp(W3 t(W2 t(W1 i + b1) + b2) + b3) with t = tanh, of the symmetric inputs i below."""
    def __init__(self, parameter, width):
        self.layers = [(4, width), (width, width), (width, 3)]
        count = sum((inputs + 1) * outputs for inputs, outputs in self.layers)
        self.parameters = [parameter("weight", -60, 60, False)] * count

    @staticmethod
    def inputs(angle):
        return np.stack([np.log(1 - angle.cos_h + 1e-4) / 4 + 1, 2 * angle.cos_d - 1, angle.cos_l + angle.cos_v - 1,
                         2 * np.sqrt(angle.cos_l * angle.cos_v) - 1], axis=1)

    def value(self, x, angle, derivatives=False):
        """f [n, 3], and if `derivatives` its derivatives by the numbers of the network, [numbers, n, 3]."""
        matrices, activations, first = [], [self.inputs(angle)], 0
        for inputs, outputs in self.layers:
            matrices.append(x[first:first + (inputs + 1) * outputs].reshape(inputs + 1, outputs))
            first += (inputs + 1) * outputs
            y = activations[-1] @ matrices[-1][:-1] + matrices[-1][-1]
            activations.append(np.tanh(y) if len(matrices) < len(self.layers) else np.exp(np.clip(y, -30, 12)))
        f = activations[-1]
        if not derivatives:
            return f
        by, slopes = [], f[:, :, None] * np.eye(3)  # of f by the sums of the layer, [n, 3, outputs]
        for matrix, before in zip(matrices[::-1], activations[-2::-1]):
            ones = np.concatenate([before, np.ones((len(before), 1))], axis=1)
            by.append((ones[:, None, :, None] * slopes[:, :, None]).reshape(len(f), 3, -1))
            slopes = (1 - before ** 2)[:, None] * (slopes @ matrix[:-1].T)
        return f, np.concatenate(by[::-1], axis=2).transpose(2, 0, 1)

    def starts(self, f, angle):
        random = np.random.default_rng(1)
        for _ in range(16):
            x = [np.concatenate([random.standard_normal((inputs, outputs)) * np.sqrt(2 / inputs),
                                 np.zeros((1, outputs))]).ravel() for inputs, outputs in self.layers]
            x[-1][-3:] = np.log(np.maximum(np.median(f, axis=0), 1e-3))
            yield np.concatenate(x)
