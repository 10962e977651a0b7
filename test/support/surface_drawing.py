"""Common parts of scripts that draw surfaces in other programs: materials, the camera of `srbf render`, and reports."""
import math
from pathlib import Path

import numpy as np

from support.checks import ROOT, expect, srbf
from support.visible_error import delta_e

MATERIALS = ["cc_ibiza_sunset_rgb", "cg_sunflower_rgb", "colodur_napoli_4f_rgb", "paper_white_rgb", "vch_golden_yellow_rgb"]
HOST_WITHIN = 0.3  # the host's error against the measurement, relative to that of the surface
BRUSHED = ROOT / "test/models/1/pbr_brushed.srbf"  # a surface with anisotropy: a host draws it as `srbf render` does
BRUSHED_WITHIN = 20  # ΔE_ITP; turned by 18° more it is 37
SIZE, SAMPLES, COARSE = 64, 512, 4
# The camera of `srbf render`: 15° above the horizon, 30° wide, the sphere within a margin of 4 %.
ELEVATION, FIELD, MARGIN = math.radians(15), math.radians(30), 0.04
DISTANCE = math.hypot(1, 1 / (math.tan(FIELD / 2) * (1 - MARGIN)))
studio = ROOT / "data/studio.hdr"


def pixels_of(path):
    """Reads an EXR file, [SIZE, SIZE, 3]."""
    import OpenEXR
    channels = OpenEXR.File(str(path)).channels()
    if "RGBA" in channels or "RGB" in channels:
        return np.asarray((channels.get("RGBA") or channels["RGB"]).pixels, dtype=float)[..., :3]
    pixels = {name.split(".")[-1]: channel.pixels for name, channel in channels.items()}
    return np.stack([np.asarray(pixels[c], dtype=float) for c in "RGB"], axis=-1)


def drawn_by_cycles(script, out, lamp=None, environment=studio):
    """The material of a script on a sphere in Cycles, under the environment, under a distant lamp of irradiance 1 in that
    direction, or with "furnace" under white light from all around."""
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    exec(compile(Path(script).read_text(encoding="utf-8"), str(script), "exec"), {"__name__": "__main__"})
    material = bpy.data.materials[0]
    bpy.ops.mesh.primitive_uv_sphere_add(segments=192, ring_count=96, radius=1)
    sphere = bpy.context.object
    bpy.ops.object.shade_smooth()
    sphere.data.materials.append(material)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = (0, -DISTANCE * math.cos(ELEVATION), DISTANCE * math.sin(ELEVATION))
    camera.rotation_euler = (math.pi / 2 - ELEVATION, 0, 0)
    camera.data.angle = FIELD
    scene = bpy.context.scene
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    background = next(n for n in nodes if n.type == "BACKGROUND")
    if lamp is None:
        texture = nodes.new("ShaderNodeTexEnvironment")
        texture.image = bpy.data.images.load(str(environment))
        texture.image.colorspace_settings.name = "Linear Rec.709"
        coordinates, turn = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping")
        turn.inputs["Rotation"].default_value[2] = -math.pi / 2  # the middle of the picture lies behind the sphere
        links.new(coordinates.outputs["Generated"], turn.inputs["Vector"])
        links.new(turn.outputs["Vector"], texture.inputs["Vector"])
        links.new(texture.outputs["Color"], background.inputs["Color"])
    elif lamp == "furnace":
        background.inputs["Color"].default_value = (1, 1, 1, 1)
    else:
        from mathutils import Vector
        background.inputs["Color"].default_value = (0, 0, 0, 1)
        sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
        sun.data.energy, sun.data.angle = 1, 0
        sun.rotation_euler = Vector(lamp).to_track_quat("Z", "Y").to_euler()
        scene.collection.objects.link(sun)
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.seed = SAMPLES, False, 1
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 1
    scene.cycles.sample_clamp_indirect = 0
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.film_transparent = True
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = str(out)
    bpy.ops.render.render(write_still=True)
    return pixels_of(out)


def drawn(subject, out, environment=studio, light=()):
    """Draws by `srbf render`, under the environment or by other options of light."""
    srbf("render", subject, "-o", out, "--mesh", "sphere", *(light or ("--env", environment)), "--no-ground", "--no-occlusion",
         "--size", f"{SIZE}x{SIZE}", "--spp", SAMPLES)
    return pixels_of(out)


def on_sphere():
    """A mask of the pixels that are completely on the sphere."""
    at = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    return math.tan(FIELD / 2) * np.hypot(*np.meshgrid(at, at)) < 0.97 / math.sqrt(DISTANCE**2 - 1)


def coarse(picture):
    """Averages blocks of COARSE x COARSE pixels."""
    return picture.reshape(SIZE // COARSE, COARSE, SIZE // COARSE, COARSE, -1).mean(axis=(1, 3))


def errors_of(reference, surface, host):
    """ΔE_ITP of surface and host against the reference, and of the host against the surface, of pixels [n, 3]."""
    return delta_e(surface, reference), delta_e(host, reference), delta_e(host, surface)


def expect_brushed(host, difference):
    """Expects that a host's picture of the brushed surface is near that of `srbf render`, by ΔE_ITP."""
    expect(difference <= BRUSHED_WITHIN, f"brushed metal: {host} against srbf {difference:.2f}")


def expect_errors(name, host, errors, largest_ratios):
    """Expects that the host's error against the measurement is within 30 % of the surface's, or at most the ratio that `largest_ratios`
    has for the material."""
    surface_error, host_error, difference = errors
    ratio, largest = host_error / surface_error, largest_ratios.get(name, 1 + HOST_WITHIN)
    expect(1 - HOST_WITHIN <= ratio <= largest, f"{name}: against the measurement srbf {surface_error:.2f}, {host} {host_error:.2f}, "
           f"{ratio:.2f} times that, at most {largest}; {host} against srbf {difference:.2f}")
