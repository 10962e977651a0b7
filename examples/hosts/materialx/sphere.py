"""A sphere of a measured material under a lamp, by the shader that MaterialX generates: sphere.py material.glsl PICTURE.npy

Needs materialx, moderngl and numpy of PyPI, and OpenGL. The GLSL is written by
`srbf export material.srbf --to glsl -o material.glsl`.
"""
# needs: MaterialX moderngl
import shutil
import sys
import tempfile
from pathlib import Path

import MaterialX as mx
import moderngl
import numpy as np
from MaterialX import PyMaterialXGenGlsl as glsl
from MaterialX import PyMaterialXGenShader as shaders

SIZE = 256
TYPES = '#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"\n'
BSDF = """
void measured_bsdf(ClosureData closure, vec3 normal, inout BSDF bsdf) {
    bsdf.throughput = vec3(0.0);
    if (closure.closureType != CLOSURE_TYPE_REFLECTION) return;
    vec3 n = dot(normal, closure.V) < 0.0 ? -normal : normal;
    vec3 t = normalize(abs(n.y) < 0.9 ? cross(vec3(0.0, 1.0, 0.0), n) : cross(vec3(1.0, 0.0, 0.0), n));
    mat3 frame = mat3(t, cross(n, t), n);  // v * frame are the local coordinates of v
    vec3 wl = closure.L * frame, wv = closure.V * frame;
    bsdf.response = material_brdf(wl, wv) * max(wl.z, 0.0) * closure.occlusion;
}
"""


def generated(folder):
    """The vertex and the pixel shader of the document, for one directional light."""
    library, document, search = mx.createDocument(), mx.createDocument(), mx.getDefaultDataSearchPath()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), search, library)
    mx.readFromXmlFile(document, str(folder / "measured.mtlx"))
    document.setDataLibrary(library)
    search.append(mx.FilePath(str(folder)))
    generator = glsl.GlslShaderGenerator.create()
    context = shaders.GenContext(generator)
    context.registerSourceCodeSearchPath(search)
    context.getOptions().hwMaxActiveLightSources = 1
    context.getOptions().hwSpecularEnvironmentMethod = shaders.HwSpecularEnvironmentMethod.SPECULAR_ENVIRONMENT_NONE
    generator.registerTypeDefs(library)
    shaders.HwShaderGenerator.bindLightShader(library.getNodeDef("ND_directional_light"), 1, context)
    shader = generator.generate("surface", document.getMaterialNodes()[0], context)
    return [shader.getSourceCode(stage) for stage in (shaders.VERTEX_STAGE, shaders.PIXEL_STAGE)]


def sphere(rows=128, columns=256):
    """Positions, which are the normals, [n, 3], and triangles."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, columns + 1), indexing="ij")
    normal = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=-1).reshape(-1, 3)
    a = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).reshape(-1, 1)
    return normal, (a + [[0, 1, columns + 1, 1, columns + 2, columns + 1]])


with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    shutil.copy(Path(__file__).with_name("measured.mtlx"), folder)
    (folder / "measured_bsdf.glsl").write_text(TYPES + Path(sys.argv[1]).read_text(encoding="utf-8") + BSDF)
    vertex, pixel = generated(folder)
# MaterialX 1.39.5 does not declare this one where there is no environment.
pixel = pixel.replace("#version 400\n", "#version 400\nconst bool u_refractionTwoSided = false;\n", 1)
gl = moderngl.create_context(standalone=True, backend="egl")
program = gl.program(vertex_shader=vertex, fragment_shader=pixel)
near, far, focal = 0.1, 100, 1 / np.tan(np.radians(13))
projection = np.diag([focal, focal, (far + near) / (near - far), 0])
projection[2, 3], projection[3, 2] = 2 * far * near / (near - far), -1
view = np.eye(4)
view[2, 3] = -5
values = {"u_worldMatrix": np.eye(4), "u_worldInverseTransposeMatrix": np.eye(4), "u_viewProjectionMatrix": (projection @ view).T,
          "u_viewPosition": (0, 0, 5), "u_numActiveLightSources": 1, "u_lightData[0].type": 1, "u_lightData[0].color": (1, 1, 1),
          "u_lightData[0].intensity": 3, "u_lightData[0].direction": np.array([2, -2, -3]) / np.sqrt(17)}
for key, value in values.items():
    if key in program:
        program[key] = tuple(np.ravel(value).tolist()) if np.ndim(value) else value
normal, triangles = sphere()
target = gl.framebuffer([gl.texture((SIZE, SIZE), 4, dtype="f4")], gl.depth_renderbuffer((SIZE, SIZE)))
target.use()
gl.enable(moderngl.DEPTH_TEST)
gl.clear()
inputs = [attribute for attribute in ("i_position", "i_normal", "i_tangent") if attribute in program]
gl.vertex_array(program, [(gl.buffer(normal.astype("f4").tobytes()), "3f", attribute) for attribute in inputs],
                gl.buffer(triangles.astype("i4").tobytes())).render()
np.save(sys.argv[2], np.frombuffer(target.read(components=3, dtype="f4"), np.float32).reshape(SIZE, SIZE, 3)[::-1])
