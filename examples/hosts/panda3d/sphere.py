#!/usr/bin/env python3
"""A sphere of a measured material under a lamp of Panda3D: sphere.py material.glsl PICTURE.npy

Needs panda3d and numpy of PyPI. The GLSL is written by `srbf export material.srbf --to glsl -o material.glsl`.
"""
import sys
from pathlib import Path

import numpy as np
from direct.showbase.ShowBase import ShowBase
from panda3d.core import (Camera, DirectionalLight, FrameBufferProperties, Geom, GeomNode, GeomTriangles, GeomVertexData, GeomVertexFormat,
                          GraphicsOutput, GraphicsPipe, NodePath, PerspectiveLens, Shader, Texture, Vec3, Vec4, WindowProperties,
                          loadPrcFileData)

SIZE = 256
VERTEX = """#version 330
uniform mat4 p3d_ModelViewProjectionMatrix, p3d_ModelViewMatrix;
uniform mat3 p3d_NormalMatrix;
in vec4 p3d_Vertex;
in vec3 p3d_Normal;
out vec3 position, normal;
void main() {
    position = (p3d_ModelViewMatrix * p3d_Vertex).xyz;
    normal = p3d_NormalMatrix * p3d_Normal;
    gl_Position = p3d_ModelViewProjectionMatrix * p3d_Vertex;
}"""
FRAGMENT = """#version 330
CODE
uniform struct { vec4 color; vec4 position; } p3d_LightSource[1];  // in the frame of the camera
in vec3 position, normal;
out vec4 color;
mat3 frame_about(vec3 n) {  // v * frame_about(n) are the local coordinates of v
    vec3 t = normalize(abs(n.y) < 0.9 ? cross(vec3(0.0, 1.0, 0.0), n) : cross(vec3(1.0, 0.0, 0.0), n));
    return mat3(t, cross(n, t), n);
}
void main() {
    mat3 frame = frame_about(normalize(normal));
    vec3 wl = normalize(p3d_LightSource[0].position.xyz) * frame, wv = normalize(-position) * frame;
    color = vec4(material_brdf(wl, wv) * max(wl.z, 0.0) * p3d_LightSource[0].color.rgb, 1.0);
}"""


def sphere(rows=128, columns=256):
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, columns + 1), indexing="ij")
    normal = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1).reshape(-1, 3)
    data = GeomVertexData("sphere", GeomVertexFormat.getV3n3(), Geom.UHStatic)
    data.uncleanSetNumRows(len(normal))
    memoryview(data.modifyArray(0)).cast("B").cast("f")[:] = np.hstack([normal, normal]).astype(np.float32).ravel()
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    triangles = GeomTriangles(Geom.UHStatic)
    triangles.setIndexType(Geom.NTUint32)
    for a in corner.tolist():
        triangles.addVertices(a, a + columns + 1, a + 1)
        triangles.addVertices(a + 1, a + columns + 1, a + columns + 2)
    geometry = Geom(data)
    geometry.addPrimitive(triangles)
    node = GeomNode("sphere")
    node.addGeom(geometry)
    return NodePath(node)


loadPrcFileData("", "window-type offscreen\nload-display p3headlessgl\ngl-version 3 3\naudio-library-name null")
base = ShowBase()
kind = FrameBufferProperties()
kind.setFloatColor(True)
kind.setRgbaBits(32, 32, 32, 32)
kind.setDepthBits(24)
buffer = base.graphicsEngine.makeOutput(base.pipe, "picture", 0, kind, WindowProperties.size(SIZE, SIZE), GraphicsPipe.BFRefuseWindow,
                                        base.win.getGsg(), base.win)
picture = Texture()
buffer.addRenderTexture(picture, GraphicsOutput.RTMCopyRam)
buffer.setClearColor(Vec4(0))

scene = NodePath("scene")
ball = sphere()
ball.reparentTo(scene)
ball.setShader(Shader.make(Shader.SL_GLSL, VERTEX, FRAGMENT.replace("CODE", Path(sys.argv[1]).read_text(encoding="utf-8"))))
lens = PerspectiveLens(26, 26)
camera = scene.attachNewNode(Camera("camera", lens))
camera.setPos(0, -5, 0)  # y of Panda3D points into the picture, z up
buffer.makeDisplayRegion().setCamera(camera)
lamp = DirectionalLight("lamp")
lamp.setColor((3, 3, 3, 1))
lamp.setDirection(Vec3(2, 3, -2))
ball.setLight(scene.attachNewNode(lamp))
base.graphicsEngine.renderFrame()
pixels = np.frombuffer(picture.getRamImageAs("RGBA").getData(), np.float32).reshape(SIZE, SIZE, 4)
np.save(sys.argv[2], pixels[::-1, :, :3])
