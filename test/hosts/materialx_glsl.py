"""Checks surfaces in the shader that MaterialX generates.

The test fits a surface to measurements, writes it as MaterialX, and draws a sphere by the generated GLSL (ES 3.00) under
three distant lights, one at a time. The error of this picture against the measurement is at most 30 % larger than that of
the picture by `srbf eval`. For a material in LARGEST_RATIOS it is at most that many times as large.
Usage: materialx_glsl.py PROGRAM DATA, where DATA contains rgl/. Chromium runs the shader.
"""
# needs: numpy MaterialX
import base64
import json
import tempfile
from pathlib import Path

import MaterialX as mx
import numpy as np
from support.checks import arguments, finish, skip, srbf
from support.chromium import WEBGL, Chromium, program as chromium
from MaterialX import PyMaterialXGenGlsl as glsl
from MaterialX import PyMaterialXGenShader as shaders
from support.visible_error import delta_e
from support.surface_drawing import BRUSHED, MATERIALS, expect_brushed, expect_errors

_, data, _ = arguments()
LIGHTS = np.array([[-6 / 11, 6 / 11, 7 / 11], [7 / 9, 4 / 9, 4 / 9], [-2 / 11, 9 / 11, -6 / 11]])
SIZE = 64
LARGEST_RATIOS = {"vch_golden_yellow_rgb": 1.65}  # by MaterialX's formula of films, which docs/surface.md names: its figure, and 15 % more
UNDECLARED = "const bool u_refractionTwoSided = false;\n"  # MaterialX 1.39.5 forgets it where there is no environment
VARYINGS = "in vec3 normalWorld;\nin vec3 tangentWorld;\nin vec3 positionWorld;\n"


def generated(path):
    """Returns the pixel shader of a document's material and its uniforms."""
    library, document, search = mx.createDocument(), mx.createDocument(), mx.getDefaultDataSearchPath()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), search, library)
    mx.readFromXmlFile(document, path)
    document.setDataLibrary(library)
    generator = glsl.EsslShaderGenerator.create()
    context = shaders.GenContext(generator)
    context.registerSourceCodeSearchPath(search)
    colours = shaders.DefaultColorManagementSystem.create(generator.getTarget())
    colours.loadLibrary(library)
    generator.setColorManagementSystem(colours)
    options = context.getOptions()
    options.targetColorSpaceOverride = "lin_rec709"
    options.hwMaxActiveLightSources = 1
    options.hwSpecularEnvironmentMethod = shaders.HwSpecularEnvironmentMethod.SPECULAR_ENVIRONMENT_NONE
    generator.registerTypeDefs(library)
    shaders.HwShaderGenerator.bindLightShader(library.getNodeDef("ND_directional_light"), 1, context)
    shader = generator.generate("surface", document.getMaterialNodes()[0], context)
    block = shader.getStage(shaders.PIXEL_STAGE).getUniformBlock(shaders.HW_PUBLIC_UNIFORMS)
    uniforms = {}
    for i in range(block.size()):
        port = block[i]
        kind = port.getType().getName()
        if port.getValue() is not None and kind in ("float", "color3", "boolean", "integer"):
            value = port.getValue().getData()
            uniforms[port.getVariable()] = [kind, list(value.asTuple()) if kind == "color3" else float(value)]
    return shader.getSourceCode(shaders.PIXEL_STAGE), uniforms


def drawn(page, source, uniforms):
    """Returns the reflected radiance [lights, SIZE, SIZE, 3] of a sphere seen from far away, for lights of irradiance 1."""
    assert VARYINGS in source
    surface = source.replace(VARYINGS, "vec3 normalWorld, tangentWorld, positionWorld;\n" + UNDECLARED)
    values = surface.replace("void main()", "void surface_main()"), uniforms, LIGHTS.tolist(), SIZE
    pictures = page.run(f"draw_sphere({', '.join(map(json.dumps, values))})")
    numbers = np.frombuffer(b"".join(map(base64.b64decode, pictures)), np.float32)
    return numbers.reshape(-1, SIZE, SIZE, 4)[..., :3].astype(float)


def evaluated(subject, folder):
    """Returns the radiance by `srbf eval`, for lights above the horizon of a point."""
    at = 2 * (np.arange(SIZE) + 0.5) / SIZE - 1
    x, y = np.meshgrid(at, at)
    n = np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 1e-6))], axis=-1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    t = np.stack([n[..., 2], 0 * x, -n[..., 0]], axis=-1)
    t /= np.linalg.norm(t, axis=-1, keepdims=True)

    def local(w):
        return np.stack([t @ w, np.cross(n, t) @ w, n @ w], axis=-1)
    pairs, view = [], local(np.array([0.0, 0, 1]))
    for light in LIGHTS:
        pairs.append(np.concatenate([local(light), view], axis=-1).reshape(-1, 6))
    pairs = np.concatenate(pairs)
    rows = "\n".join(",".join(f"{v:.9g}" for v in row) for row in pairs)
    Path(folder, "pairs.csv").write_text("wl_x,wl_y,wl_z,wv_x,wv_y,wv_z\n" + rows + "\n", encoding="utf-8")
    lines = srbf("eval", subject, "--pairs", f"{folder}/pairs.csv").splitlines()[1:]
    f = np.array([[float(v) for v in line.split(",")[-3:]] for line in lines])
    return (np.nan_to_num(f) * np.maximum(pairs[:, 2:3], 0)).reshape(len(LIGHTS), SIZE, SIZE, 3)


def mean_error(a, b):
    """Returns the ΔE_ITP of pixels on the sphere, as a mean over the lights."""
    at = 2 * (np.arange(SIZE) + 0.5) / SIZE - 1
    inside = np.hypot(*np.meshgrid(at, at)) < 0.98
    return np.mean([delta_e(p[inside], q[inside]) for p, q in zip(a, b)])


if chromium() is None:
    skip("no Chromium")
page = Chromium(WEBGL)
try:
    page.run(Path(__file__).with_suffix(".js").read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        for name in MATERIALS:
            measured, model = data / f"rgl/{name}.bsdf", f"{folder}/{name}.srbf"
            srbf("fit", measured, "--model", "openpbr", "-o", model)
            srbf("export", model, "--to", "mtlx", "-o", f"{folder}/{name}.mtlx")
            by_shader = drawn(page, *generated(f"{folder}/{name}.mtlx"))
            reference, ours = evaluated(measured, folder), evaluated(model, folder)
            errors = mean_error(ours, reference), mean_error(by_shader, reference), mean_error(by_shader, ours)
            expect_errors(name, "MaterialX", errors, LARGEST_RATIOS)
        for kind in ("mtlx", "standard-surface"):
            srbf("export", BRUSHED, "--to", kind, "-o", f"{folder}/brushed.mtlx")
            ours, by_shader = evaluated(BRUSHED, folder), drawn(page, *generated(f"{folder}/brushed.mtlx"))
            expect_brushed(f"MaterialX ({kind})", mean_error(by_shader, ours))
finally:
    page.close()
finish()
