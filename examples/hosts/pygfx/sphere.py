#!/usr/bin/env python3
"""A sphere of a measured material under a lamp of pygfx: sphere.py material.wgsl PICTURE.npy

Needs pygfx and numpy of PyPI, and Vulkan, of which Debian's mesa-vulkan-drivers is enough. The WGSL is written by
`srbf export material.srbf --to wgsl -o material.wgsl`.
"""
import sys
from pathlib import Path

import numpy as np
import pygfx as gfx
from pygfx.renderers.wgpu import load_wgsl, register_wgpu_render_function
from pygfx.renderers.wgpu.engine.blender import default_targets
from pygfx.renderers.wgpu.shaders.meshshader import MeshPhongShader
from rendercanvas.offscreen import OffscreenRenderCanvas

# Takes the place of the function by which pygfx reflects each of its lights.
REFLECT = """
fn RE_Direct(light: IncidentLight, geometry: GeometricContext, material: BlinnPhongMaterial, reflected: ptr<function, ReflectedLight>) {
    let n = geometry.normal;
    let t = normalize(select(cross(vec3f(1.0, 0.0, 0.0), n), cross(vec3f(0.0, 1.0, 0.0), n), abs(n.y) < 0.9));
    let frame = mat3x3f(t, cross(n, t), n);  // v * frame are the local coordinates of v
    let wl = light.direction * frame;
    (*reflected).direct_diffuse += material_brdf(wl, geometry.view_dir * frame) * max(wl.z, 0.0) * light.color;
}
"""


class MeasuredMaterial(gfx.MeshPhongMaterial):
    pass


@register_wgpu_render_function(gfx.Mesh, MeasuredMaterial)
class MeasuredShader(MeshPhongShader):
    def get_code(self):
        phong = load_wgsl("light_phong.wgsl").replace("fn RE_Direct(", "fn RE_Direct_Phong(")
        return super().get_code().replace("{$ include 'pygfx.light_phong.wgsl' $}", phong + REFLECT + code)


code = Path(sys.argv[1]).read_text(encoding="utf-8")
default_targets["color"] = "rgba16float", default_targets["color"][1]  # radiance instead of 8 bits of sRGB
renderer = gfx.renderers.WgpuRenderer(OffscreenRenderCanvas(size=(256, 256), pixel_ratio=1), pixel_ratio=1, ppaa="none")
scene, camera = gfx.Scene(), gfx.PerspectiveCamera(26, 1)
camera.local.position = 0, 0, 5
lamp = gfx.DirectionalLight("#fff", 3)
lamp.local.position = -2, 2, 3
scene.add(gfx.Mesh(gfx.sphere_geometry(1, 256, 128), MeasuredMaterial()), lamp)
renderer.render(scene, camera)
np.save(sys.argv[2], np.asarray(renderer.snapshot())[..., :3])
