"""What the scripts that draw surfaces in other programs share: materials, the camera of `srbf render`, and what is said of a picture."""
import math
import subprocess
import sys
from pathlib import Path

import numpy as np

from seen import delta_e

MATERIALS = ["cc_ibiza_sunset_rgb", "cg_sunflower_rgb", "colodur_napoli_4f_rgb", "paper_white_rgb", "vch_golden_yellow_rgb"]
HOST_WITHIN = 0.3  # of what the surface loses against the measurement
BRUSHED = Path(__file__).resolve().parent / "models/1/pbr_brushed.srbf"  # a surface with anisotropy: a host draws it as `srbf render` does
BRUSHED_WITHIN = 10  # ΔE_ITP; turned by 18° more it is 37
SIZE, SAMPLES = 128, 128
# The camera of `srbf render`: 15° above the horizon, 30° wide, the sphere within a margin of 4 %.
ELEVATION, FIELD, MARGIN = math.radians(15), math.radians(30), 0.04
DISTANCE = math.hypot(1, 1 / (math.tan(FIELD / 2) * (1 - MARGIN)))
program = sys.argv[1]
environment = Path(__file__).resolve().parent.parent / "data/studio.hdr"


def run(*words):
    return subprocess.run([program, *map(str, words)], check=True, stdout=subprocess.PIPE, text=True).stdout


def pixels_of(path):
    """[SIZE, SIZE, 3] of an EXR."""
    import OpenEXR
    channels = OpenEXR.File(str(path)).channels()
    if "RGBA" in channels or "RGB" in channels:
        return np.asarray((channels.get("RGBA") or channels["RGB"]).pixels, dtype=float)[..., :3]
    of = {name.split(".")[-1]: channel.pixels for name, channel in channels.items()}
    return np.stack([np.asarray(of[c], dtype=float) for c in "RGB"], axis=-1)


def on_sphere():
    """The pixels that lie on the sphere whole."""
    at = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    return math.tan(FIELD / 2) * np.hypot(*np.meshgrid(at, at)) < 0.97 / math.sqrt(DISTANCE**2 - 1)


def lost(reference, surface, host):
    """ΔE_ITP of surface and host against the reference, and of the host against the surface, of pixels [n, 3]."""
    return delta_e(surface, reference), delta_e(host, reference), delta_e(host, surface)


def draws_brushed(host, apart):
    """Says how far a host's picture of the brushed surface is from ours, ΔE_ITP, and whether that is as near as expected."""
    print(f"{'ok  ' if apart <= BRUSHED_WITHIN else 'BAD '} brushed metal: {host} against ours {apart:.2f}", flush=True)
    return apart <= BRUSHED_WITHIN


def holds(name, host, losses, own_formulas):
    """Says what the surface and the host lose, and whether that is as near as expected, or has a reason that is known."""
    ours, of_host, apart = losses
    near = name in own_formulas or abs(of_host / ours - 1) <= HOST_WITHIN
    print(f"{'ok  ' if near else 'BAD '} {name}: against the measurement ours {ours:.2f}, {host} {of_host:.2f}; {host} against ours {apart:.2f}", flush=True)
    return near
