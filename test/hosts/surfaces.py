"""Checks files of surfaces in MaterialX and USD.

The test fits a surface to a measurement and writes it for each program. Its validator must accept the file.
Usage: surfaces.py PROGRAM DATA, where DATA contains rgl/.
"""
# needs: MaterialX usd-core
import tempfile

import MaterialX as mx
from support.checks import arguments, expect, finish, srbf
from pxr import Usd, UsdShade, UsdValidation

_, data, _ = arguments()


def check_materialx(path, kind="open_pbr_surface", name="OpenPBR"):
    library, document = mx.createDocument(), mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    mx.readFromXmlFile(document, path)
    document.setDataLibrary(library)
    is_valid, message = document.validate()
    expect(is_valid, f"MaterialX {mx.getVersionString()}: valid {message}")
    known = {port.getName(): port.getType() for port in library.getNodeDef(f"ND_{kind}_surfaceshader").getActiveInputs()}
    node, = document.getNodes(kind)
    unknown = [port.getName() for port in node.getInputs() if known.get(port.getName()) != port.getType()]
    expect(not unknown, f"MaterialX: {name} has all parameters {unknown}")


def check_usd(path):
    stage = Usd.Stage.Open(path)
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    errors = [(error.GetName(), error.GetMessage()) for error in UsdValidation.ValidationContext(validators).Validate(stage)]
    # Packages of USD without MaterialX do not know its nodes.
    errors = [error for error in errors if error[0] != "MissingShaderIdInRegistry" or "ND_open_pbr_surface" not in error[1]]
    expect(not errors, f"USD {Usd.GetVersion()}: valid {errors}")
    material = UsdShade.MaterialBindingAPI(stage.GetPrimAtPath("/World/Sphere")).ComputeBoundMaterial()[0]
    expect(bool(material) and bool(material.ComputeSurfaceSource()[0]), "USD: the sphere has a surface")


with tempfile.TemporaryDirectory() as folder:
    model = f"{folder}/surface.srbf"
    srbf("fit", data / "rgl/cg_sunflower_rgb.bsdf", "--model", "openpbr", "-o", model)
    for kind, name in (("mtlx", "s.mtlx"), ("standard-surface", "a.mtlx"), ("usd", "s.usda")):
        print(srbf("export", model, "--to", kind, "-o", f"{folder}/{name}").strip())
    check_materialx(folder + "/s.mtlx")
    check_materialx(folder + "/a.mtlx", "standard_surface", "Standard Surface")
    check_usd(folder + "/s.usda")

finish()
