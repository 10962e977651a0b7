"""The visible difference of two pictures, ΔE_ITP (ITU-R BT.2124) on a display of 100 cd/m², as `srbf compare` computes it."""
import base64

import numpy as np

EXPOSED_AT, EXPOSED_TO = 0.9, 0.75  # this share of the reference's pixels lies below this share of the display's white
M1, M2, C1, C2, C3 = 2610 / 16384, 128 * 2523 / 4096, 3424 / 4096, 32 * 2413 / 4096, 32 * 2392 / 4096
TO_2020 = np.array([[0.627403896, 0.329283038, 0.043313066], [0.069097289, 0.919540395, 0.011362316], [0.016391439, 0.088013308, 0.895595253]])
TO_LMS = np.array([[1688, 2146, 262], [683, 2951, 462], [99, 309, 3688]]) / 4096
TO_ITP = np.diag([720, 360, 720]) @ np.array([[2048, 2048, 0], [6610, -13613, 7003], [17933, -17390, -543]]) / 4096


def itp(colour):
    """The coordinates I, T and P of linear sRGB, where 1 is the display's white."""
    lms = np.maximum(colour @ (TO_LMS @ TO_2020).T, 1e-9) / 100
    y = lms**M1
    return ((C1 + C2 * y) / (1 + C3 * y))**M2 @ TO_ITP.T


def exposure(reference):
    """The exposure of pixels [n, 3], as in the pictures of `srbf compare`."""
    return EXPOSED_TO / np.quantile(reference.max(axis=1), EXPOSED_AT)


def delta_e(picture, reference):
    """Mean ΔE_ITP of pixels [n, 3], linear, exposed for the reference and clipped at white."""
    factor = exposure(reference)
    a, b = (itp(np.clip(factor * image, 0, 1)) for image in (picture, reference))
    return float(np.sqrt(((a - b)**2).sum(axis=1)).mean())


def displayed(picture, exposed):
    """Converts linear values to 8-bit sRGB."""
    x = np.clip(exposed * picture, 0, 1)
    return (255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x**(1 / 2.4) - 0.055) + 0.5).astype(np.uint8)


def hdr_of(path):
    """Reads a Radiance picture without compressed rows, [height, width, 3]."""
    with open(path, "rb") as file:
        content = file.read()
    head = content.index(b"\n\n") + 2
    end = content.index(b"\n", head)
    words = content[head:end].split()
    height, width = int(words[1]), int(words[3])
    texels = np.frombuffer(content, np.uint8, offset=end + 1).reshape(height, width, 4)
    return texels[..., :3] * np.exp2(texels[..., 3].astype(float) - 136)[..., None]


def equirectangular(path):
    """A Radiance picture for a page of three.js: its rows as base64 of float32 RGBA, the lowest first, width and height."""
    texels = hdr_of(path)
    height, width = texels.shape[:2]
    rows = np.concatenate([texels[::-1], np.ones((height, width, 1))], axis=-1).astype(np.float32)
    return base64.b64encode(rows.tobytes()).decode(), width, height
