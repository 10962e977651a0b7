"""A sphere of a measured material under a lamp of Radiance: sphere.py material.cal PICTURE.npy

Needs pyradiance, which has Radiance's programs, and numpy of PyPI. The functions are written by
`srbf export material.srbf --to radiance -o material.cal`.
"""
# needs: pyradiance
import subprocess
import sys
import tempfile
from math import cos, pi, radians, tan
from pathlib import Path

import numpy as np
import pyradiance

SIZE, ANGLE = 256, 0.5  # of the lamp, degrees
# The directions to the light, (lx, ly, lz), and to the viewer, -D, in a frame whose z axis is the normal.
FRAME = """
s = sqrt(NxP*NxP + NzP*NzP) + 1e-12;
tx = NzP/s; tz = -NxP/s;
bx = NyP*tz; by = NzP*tx - NxP*tz; bz = -NyP*tx;
x(a,b,c) = a*tx + c*tz; y(a,b,c) = a*bx + b*by + c*bz; z(a,b,c) = a*NxP + b*NyP + c*NzP;
vx = x(-Dx,-Dy,-Dz); vy = y(-Dx,-Dy,-Dz); vz = z(-Dx,-Dy,-Dz);
red(a,b,c,o) = material_R(x(a,b,c),y(a,b,c),z(a,b,c),vx,vy,vz);
green(a,b,c,o) = material_G(x(a,b,c),y(a,b,c),z(a,b,c),vx,vy,vz);
blue(a,b,c,o) = material_B(x(a,b,c),y(a,b,c),z(a,b,c),vx,vy,vz);
"""
RADIANCE = 3 / (2 * pi * (1 - cos(radians(ANGLE / 2))))  # of the lamp, whose irradiance is 3
SCENE = f"""
void light bright 0 0 3 {RADIANCE} {RADIANCE} {RADIANCE}
bright source lamp 0 0 4 -2 2 3 {ANGLE}
void BRTDfunc measured
10 0 0 0 0 0 0 red green blue sphere.cal
0
9 0 0 0 0 0 0 0 0 0
measured sphere ball 0 0 4 0 0 0 1
"""
programs = Path(pyradiance.__file__).parent / "bin"
at = tan(radians(13)) * ((np.arange(SIZE) + 0.5) / SIZE * 2 - 1)
x, y = np.meshgrid(at, -at)
rays = np.stack([0 * x, 0 * x, 0 * x + 5, x, y, 0 * x - 1], axis=-1).astype(np.float32)
with tempfile.TemporaryDirectory() as folder:
    Path(folder, "sphere.cal").write_text(Path(sys.argv[1]).read_text(encoding="utf-8") + FRAME)
    Path(folder, "scene.rad").write_text(SCENE)
    with open(Path(folder, "scene.oct"), "wb") as octree:
        subprocess.run([programs / "oconv", "scene.rad"], cwd=folder, stdout=octree, check=True)
    values = subprocess.run([programs / "rtrace", "-h", "-ff", "-ab", "0", "-dt", "0", "scene.oct"], cwd=folder, input=rays.tobytes(),
                            stdout=subprocess.PIPE, check=True).stdout
np.save(sys.argv[2], np.frombuffer(values, np.float32).reshape(SIZE, SIZE, 3))
