"""Runs the shaders for Unity and Godot 4 in OpenGL, with stand-ins for the engines' names. The engines themselves are not run.

Checks:
  - Under a directional light, the picture of a sphere of the film differs from that of the model by a mean ΔE_ITP of at most 1.
  - Under light from everywhere, the sphere reflects its albedo.

Usage: drawn_engine_shaders.py PROGRAM.
"""
# needs: numpy moderngl
import importlib.util
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from support.checks import ROOT, arguments, expect, finish, skip
import engine_shaders as shaders
from support import lit_sphere

program, data = arguments()[0], ROOT / "data"
glslang, spirv_cross = shutil.which("glslangValidator"), shutil.which("spirv-cross")
if not (glslang and spirv_cross and importlib.util.find_spec("moderngl")):
    skip("glslangValidator, spirv-cross or moderngl is not installed")
import moderngl

VERTEX = """#version 450
in vec2 at;
in vec3 position, normal;
NAMES
void main() {
    gl_Position = vec4(at, 0.0, 1.0);
    SET
}
"""
# The third and fourth interpolated values of Unity's shader are for fog and shadows. In Godot's shader all values have names.
UNITY = ("layout(location = 0) out vec3 a; layout(location = 1) out vec3 b; "
         "layout(location = 2) out float c; layout(location = 3) out vec4 d;",
         "a = position; b = normal; c = 1.0; d = vec4(1.0);")
GODOT = ("out vec3 NORMAL, VIEW, LIGHT, LIGHT_COLOR;",
         f"NORMAL = normal; VIEW = normalize(vec3(0.0, 0.0, {lit_sphere.DISTANCE}) - position); "
         f"LIGHT = vec3({', '.join(map(str, lit_sphere.TO_LIGHT))}); LIGHT_COLOR = vec3({lit_sphere.IRRADIANCE});")


class Sphere:
    """Draws a pixel for each point of the unit sphere by a fragment shader."""

    def __init__(self):
        self.inside, normal, _ = lit_sphere.points()
        rows, columns = np.nonzero(self.inside)
        at = np.stack([columns + 0.5, rows + 0.5], axis=1) / lit_sphere.SIZE * 2 - 1
        self.gl = moderngl.create_standalone_context(backend="egl")
        self.vertices = self.gl.buffer(np.hstack([at, normal, normal]).astype("f4").tobytes())

    def drawn(self, outputs, fragment, prepare=lambda gl, shader: None):
        """Returns the outputs of the shader at the pixels, two arrays [n, 3]."""
        vertex = VERTEX.replace("NAMES", outputs[0]).replace("SET", outputs[1])
        shader = self.gl.program(vertex_shader=vertex, fragment_shader=fragment)
        targets = [self.gl.texture((lit_sphere.SIZE, lit_sphere.SIZE), 4, dtype="f4") for _ in range(2)]
        self.gl.framebuffer(targets).use()
        kept = prepare(self.gl, shader)
        self.gl.vertex_array(shader, [(self.vertices, "2f 3f 3f", "at", "position", "normal")]).render(moderngl.POINTS)
        del kept
        return [np.frombuffer(target.read(), "f4").reshape(lit_sphere.SIZE, lit_sphere.SIZE, 4)[self.inside][:, :3].astype(float)
                for target in targets]


def under(light, around):
    """Sets Unity's names: a light in the direction of lit_sphere.py, and the same radiance from everywhere."""
    def prepare(gl, shader):
        ones = np.ones(4)
        block = np.concatenate([np.zeros(48), ones, ones, around * ones, lit_sphere.TO_LIGHT, [0], light / np.pi * ones,
                                [0, 0, lit_sphere.DISTANCE, 0]])
        numbers, tint = gl.buffer(block.astype("f4").tobytes()), gl.buffer(ones.astype("f4").tobytes())
        cube = gl.texture_cube((1, 1), 4, np.full(24, around, "f4").tobytes(), dtype="f4")
        for name, buffer, binding in (("Unity", numbers, 0), ("UnityPerMaterial", tint, 1)):
            if name in shader:
                shader[name].binding = binding
                buffer.bind_to_uniform_block(binding)
        cube.use(0)
        return numbers, tint, cube
    return prepare


with tempfile.TemporaryDirectory() as folder:
    model = Path(folder, "film.srbf")
    subprocess.run([program, "fit", data / "cc_ibiza_sunset_rgb.bsdf", "-o", model], check=True, stdout=subprocess.DEVNULL)
    exact = lit_sphere.reference(program, model, folder)
    shaders.compile_unity(glslang, folder)
    subprocess.run([spirv_cross, f"{folder}/pass0.frag.spv", "--version", "450", "--no-es", "--output", f"{folder}/unity.glsl"], check=True)
    unity = Path(folder, "unity.glsl").read_text(encoding="utf-8")
sphere = Sphere()
in_godot, albedo = sphere.drawn(GODOT, shaders.godot_text())
for name, drawn in {"Godot 4": in_godot, "Unity": sphere.drawn(UNITY, unity, under(lit_sphere.IRRADIANCE, 0))[0]}.items():
    picture = np.zeros_like(exact)
    picture[sphere.inside] = drawn
    error = lit_sphere.picture_error(picture, exact)
    expect(error <= lit_sphere.WITHIN, f"shader for {name}, with mocks: film {error:.2f}")
around = np.abs(sphere.drawn(UNITY, unity, under(0, 1))[0] - np.minimum(albedo, 1)).max()
expect(around < 0.01, f"shader for Unity in white surroundings: differs from the albedo by {around:.4f} at most")
finish()
