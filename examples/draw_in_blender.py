"""Draws a ball of the material that film.py makes, without a window, and saves the scene: ball.png, film.blend. Needs the package bpy."""
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
exec(open("film.py", encoding="utf-8").read())
bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=1)
bpy.ops.object.shade_smooth()
bpy.context.object.data.materials.append(bpy.data.materials[0])
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location, camera.rotation_euler = (0, -6.4, 0), (1.5708, 0, 0)
bpy.context.collection.objects.link(camera)
# Location, rotation and size of lamps: one in front, two behind.
for location, rotation, size in (((-3, -4, 4), (0.9, 0, -0.6), 2), ((4, 1, 0), (0, 1.57, 0.2), 3), ((-4, 3, 1), (0, -1.3, -0.6), 3)):
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "AREA"))
    lamp.location, lamp.rotation_euler, lamp.data.energy, lamp.data.size = location, rotation, 220, size
    bpy.context.collection.objects.link(lamp)
scene = bpy.context.scene
scene.world = bpy.data.worlds.new("room")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.2, 0.2, 1)
scene.camera, scene.render.engine, scene.cycles.samples = camera, "CYCLES", 64
camera.data.lens = 85
scene.view_settings.view_transform = "Standard"
scene.render.resolution_x = scene.render.resolution_y = 512
scene.render.filepath = os.path.abspath("ball.png")
bpy.ops.render.render(write_still=True)
print("drew ball.png with", bpy.data.materials[0].name)

scene.render.filepath = "//ball.png"
for area in bpy.data.screens["Layout"].areas:
    if area.type == "VIEW_3D":  # which shows the picture as soon as the file is opened
        area.spaces.active.shading.type, area.spaces.active.region_3d.view_perspective = "RENDERED", "CAMERA"
bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath("film.blend"), compress=True)
