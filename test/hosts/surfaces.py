#!/usr/bin/env python3
"""Files of surfaces in MaterialX and USD: packages materialx and usd-core of PyPI, in this Python.

Fits a surface to a measurement, writes it for each program, and asks MaterialX's and USD's validators. The glTF is read here: its
numbers, and that the sphere's triangles look outwards.
Arguments: the program, a folder with rgl/.
"""
import array
import base64
import json
import subprocess
import sys
import tempfile

import MaterialX as mx
from pxr import Usd, UsdShade, UsdValidation

program, data = sys.argv[1], sys.argv[2]
failures = []


def expect(holds, what):
    print("ok  " if holds else "BAD ", what, flush=True)
    if not holds:
        failures.append(what)


def run(*words):
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout


def check_materialx(path, of_node="open_pbr_surface", words="OpenPBR"):
    library, document = mx.createDocument(), mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    mx.readFromXmlFile(document, path)
    document.setDataLibrary(library)
    is_valid, message = document.validate()
    expect(is_valid, f"MaterialX {mx.getVersionString()}: valid {message}")
    known = {of.getName(): of.getType() for of in library.getNodeDef(f"ND_{of_node}_surfaceshader").getActiveInputs()}
    node, = document.getNodes(of_node)
    unknown = [of.getName() for of in node.getInputs() if known.get(of.getName()) != of.getType()]
    expect(not unknown, f"MaterialX: {words} has all parameters {unknown}")


def check_usd(path):
    stage = Usd.Stage.Open(path)
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    errors = [(of.GetName(), of.GetMessage()) for of in UsdValidation.ValidationContext(validators).Validate(stage)]
    # Packages of USD without MaterialX do not know its nodes.
    errors = [of for of in errors if of[0] != "MissingShaderIdInRegistry" or "ND_open_pbr_surface" not in of[1]]
    expect(not errors, f"USD {Usd.GetVersion()}: valid {errors}")
    material = UsdShade.MaterialBindingAPI(stage.GetPrimAtPath("/World/Sphere")).ComputeBoundMaterial()[0]
    expect(bool(material) and bool(material.ComputeSurfaceSource()[0]), "USD: the sphere has a surface")


def check_gltf(path):
    gltf = json.load(open(path, encoding="utf-8"))
    content = base64.b64decode(gltf["buffers"][0]["uri"].split(",")[1])
    expect(len(content) == gltf["buffers"][0]["byteLength"], "glTF: the buffer has its length")

    def view(accessor, kind):
        of = gltf["bufferViews"][gltf["accessors"][accessor]["bufferView"]]
        return array.array(kind, content[of["byteOffset"]:of["byteOffset"] + of["byteLength"]])

    p, indices = view(0, "f"), view(1, "H")
    inwards = 0
    for i in range(0, len(indices), 3):
        a, b, c = (p[3 * k:3 * k + 3] for k in indices[i:i + 3])
        u, v = ([q[k] - a[k] for k in range(3)] for q in (b, c))
        normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        inwards += sum(n * (x + y + z) for n, x, y, z in zip(normal, a, b, c)) <= 0
    expect(len(indices) % 3 == 0 and inwards == 0, f"glTF: {len(indices) // 3} triangles, {inwards} of them inwards")
    used = set(gltf["extensionsUsed"])
    expect(used == set(gltf["materials"][0]["extensions"]), f"glTF: {sorted(used)}")


with tempfile.TemporaryDirectory() as folder:
    for surface, kind, name in (("openpbr", "mtlx", "s.mtlx"), ("openpbr", "standard-surface", "a.mtlx"), ("openpbr", "usd", "s.usda"), ("gltf", "gltf", "s.gltf"),
                                ("principled", "principled", "s.py")):
        model = f"{folder}/{surface}.srbf"
        run("fit", data + "/rgl/cg_sunflower_rgb.bsdf", "--model", "openpbr", "--surface", surface, "-o", model)
        print(run("export", model, "--to", kind, "-o", f"{folder}/{name}").strip())
    check_materialx(folder + "/s.mtlx")
    check_materialx(folder + "/a.mtlx", "standard_surface", "Standard Surface")
    check_usd(folder + "/s.usda")
    check_gltf(folder + "/s.gltf")
    compile(open(folder + "/s.py", encoding="utf-8").read(), "s.py", "exec")  # Blender's own module is not asked

sys.exit(bool(failures))
