# Written by srbf 0.1.0: materials for Cycles, Blender 4.5 or later. Run it in Blender: the selected objects get
# the materials. With the name of a .blend file after "--" it writes that file, where they are assets with
# previews. A script that imports it calls measured_materials().
# Name, angles of the viewer from 0 to 90 degrees, terms, and the tables over these angles: for each term a row of
# slope, roughness and anisotropy, and one of weights in linear Rec.709; then the diffuse colour.
_MEASURED = [
    ("film", 24, 4, [
        0.0023898, 0.57842, 0.0044562, 0.015755, 0.58528, 0.0068306, 0.022897, 0.59654, -0.0067426, 0.040666, 0.60571, 0.015212, 0.057673, 0.5974, 0.050374, -0.06766, 0.53688, -0.023108, -0.11938, 0.53037, 0.028782, -0.12352, 0.52559, 0.035125, -0.09597, 0.53427, 0.024478, 0.0069257, 0.67762, 0.19434, 0.057775, 0.79206, 0.21235, 0.082019, 0.84524, 0.2503, 0.10438, 0.84906, 0.26007, 0.11304, 0.85579, 0.26733, 0.10501, 0.84762, 0.28153, 0.072454, 0.83199, 0.30779, 0.016618, 0.82822, 0.31405, -0.019962, 0.8147, 0.33626, -0.023126, 0.7809, 0.32678, -0.026164, 0.76979, 0.27624, -0.073621, 0.80252, 0.34306, -0.10435, 0.80961, 0.34453, -0.11122, 0.82752, 0.31521, -0.12904, 0.85965, 0.261,
        0.025825, 0.010608, 0.008868, 0.025456, 0.010609, 0.0078489, 0.025539, 0.010899, 0.0066472, 0.024816, 0.010416, 0.0045935, 0.021333, 0.008721, 0.0035114, 0.0066658, 0.0039956, 0.01196, 0.006213, 0.0034383, 0.008781, 0.0064963, 0.0035418, 0.009318, 0.0086634, 0.0044816, 0.010759, 0.021014, 0.0096905, 0.0014985, 0.017181, 0.0079017, 0.00057989, 0.019628, 0.0088298, 0.00021917, 0.022046, 0.0097226, 7.2081e-05, 0.023882, 0.010409, 2.2165e-05, 0.02982, 0.01274, 6.6715e-06, 0.030648, 0.012737, 1.994e-06, 0.028088, 0.011069, 5.9442e-07, 0.0315, 0.011605, 1.769e-07, 0.043783, 0.015998, 5.2568e-08, 0.042856, 0.015254, 1.5603e-08, 0.034446, 0.012516, 4.6275e-09, 0.028662, 0.010273, 1.3717e-09, 0.030786, 0.011028, 4.0655e-10, 0.088464, 0.030946, 1.2049e-10,
        -0.0068877, 0.54249, -0.0022537, -0.047957, 0.54759, 0.0088154, -0.078234, 0.5519, 0.018487, -0.092121, 0.55746, 0.017044, -0.066984, 0.58354, -0.0093569, 0.037322, 0.67704, 0.034878, 0.063781, 0.70564, 0.04771, 0.05373, 0.70864, 0.10346, -0.00016069, 0.63735, 0.16605, -0.099444, 0.50855, 0.029192, -0.12043, 0.49495, 0.076431, -0.1424, 0.48858, 0.14091, -0.161, 0.48001, 0.14392, -0.14848, 0.50302, 0.18219, -0.15461, 0.50194, 0.1809, -0.16074, 0.51649, 0.19585, -0.15746, 0.53427, 0.1967, -0.12697, 0.53025, 0.23455, -0.10703, 0.5006, 0.32325, -0.098516, 0.49889, 0.34804, -0.071919, 0.52584, 0.35163, -0.047187, 0.54286, 0.33574, -0.022392, 0.54898, 0.29654, -0.041404, 0.564, 0.20338,
        0.00030414, 0.00084254, 0.0050792, 0.00065747, 0.0011747, 0.0059375, 0.001421, 0.0016265, 0.0068694, 0.0029804, 0.0024032, 0.0082225, 0.0062643, 0.0041659, 0.0086404, 0.01735, 0.008142, 0.0025871, 0.015171, 0.0073597, 0.002013, 0.015638, 0.007502, 0.0018363, 0.020923, 0.0093814, 0.002525, 0.013982, 0.0060844, 0.014862, 0.017114, 0.0074596, 0.01597, 0.02934, 0.01112, 0.016182, 0.047968, 0.018687, 0.018055, 0.047364, 0.018518, 0.01387, 0.047963, 0.018235, 0.013487, 0.04662, 0.017229, 0.010062, 0.051166, 0.017205, 0.0068588, 0.059704, 0.02094, 0.0059344, 0.086771, 0.03795, 0.0060991, 0.098251, 0.053505, 0.0060485, 0.09052, 0.044632, 0.0037448, 0.07133, 0.040135, 0.003378, 0.043515, 0.027351, 0.0044148, 0.033724, 0.024031, 0.0058705,
        1.4612e-05, 0.41108, 0.0017659, -0.00024639, 0.41204, -0.0044248, 0.0022523, 0.41212, -0.0082186, 0.0024402, 0.41531, -0.0063658, 0.0021922, 0.4293, -0.0025552, 0.030638, 0.46571, 0.02876, 0.032088, 0.48536, 0.034707, 0.025975, 0.47792, 0.037197, 0.029844, 0.46686, 0.037733, 0.024297, 0.4707, 0.053791, 0.011461, 0.48912, 0.057859, 0.02926, 0.50681, 0.1337, 0.039329, 0.478, 0.16823, 0.039209, 0.45061, 0.23774, 0.010448, 0.43979, 0.22515, -0.0086387, 0.45146, 0.24625, -0.015086, 0.47788, 0.27554, 0.0029132, 0.49967, 0.32913, 0.07673, 0.51613, 0.34506, 0.10107, 0.50787, 0.35101, 0.052273, 0.48266, 0.42291, 0.006213, 0.43469, 0.44856, -0.0015538, 0.37947, 0.39724, -0.01, 0.32775, 0.30922,
        0.060441, 0.020458, 0.031125, 0.062614, 0.02064, 0.031609, 0.064723, 0.020347, 0.031674, 0.063395, 0.02047, 0.031186, 0.053681, 0.017267, 0.028101, 0.051554, 0.015723, 0.010897, 0.053425, 0.0179, 0.010649, 0.064493, 0.021231, 0.010573, 0.066567, 0.021856, 0.0060405, 0.073315, 0.026053, 0.0048453, 0.084103, 0.034371, 0.0064307, 0.067668, 0.030508, 0.0057838, 0.075144, 0.035823, 0.0065083, 0.10056, 0.050999, 0.0075887, 0.12284, 0.066393, 0.010078, 0.11808, 0.072486, 0.01522, 0.10101, 0.067011, 0.016571, 0.082091, 0.06695, 0.023769, 0.06156, 0.07092, 0.043451, 0.063979, 0.075703, 0.069999, 0.044526, 0.059751, 0.062397, 0.034595, 0.045169, 0.053458, 0.038594, 0.044057, 0.050944, 0.056915, 0.056204, 0.050694,
        0.00046894, 0.29077, 0.0055878, -0.0051944, 0.28852, -0.0062471, -0.0091031, 0.28637, 0.0033097, -0.0076104, 0.29131, 0.029404, -0.015263, 0.30417, 0.058797, -0.024123, 0.32472, 0.042457, -0.029633, 0.33158, 0.048836, -0.035011, 0.33656, 0.037582, -0.02172, 0.32826, 0.091435, -0.022831, 0.32969, 0.11063, -0.039203, 0.34482, 0.13524, 0.004206, 0.31641, 0.22349, -0.025888, 0.33064, 0.23245, -0.027689, 0.33658, 0.26577, -0.02615, 0.316, 0.2746, -0.005358, 0.29649, 0.30711, -0.001827, 0.30403, 0.34633, -0.018121, 0.31233, 0.3589, -0.0017936, 0.29079, 0.36672, 0.0010084, 0.29038, 0.37089, -0.0005734, 0.28672, 0.42698, -0.0056176, 0.26675, 0.41814, 0.011905, 0.23759, 0.31688, -0.01, 0.215, 0.19172,
        0.11926, 0.042986, 0.08866, 0.11143, 0.042007, 0.085681, 0.11907, 0.047585, 0.090143, 0.13614, 0.053818, 0.096449, 0.16284, 0.063462, 0.10251, 0.19148, 0.07427, 0.11948, 0.20753, 0.076947, 0.11829, 0.2134, 0.079295, 0.11361, 0.21891, 0.082262, 0.10818, 0.22247, 0.085332, 0.098013, 0.2289, 0.090157, 0.087056, 0.24028, 0.10109, 0.077978, 0.2176, 0.10149, 0.07058, 0.19015, 0.099031, 0.071289, 0.15591, 0.094021, 0.071354, 0.15797, 0.10437, 0.079896, 0.16907, 0.12857, 0.10193, 0.17746, 0.14363, 0.12056, 0.18683, 0.16571, 0.15733, 0.21203, 0.20145, 0.19839, 0.30278, 0.29512, 0.28608, 0.32197, 0.31726, 0.313, 0.21645, 0.21636, 0.21495, 0.15318, 0.14716, 0.14565,
        0.017287, 0.0071202, 0.0013439, 0.016049, 0.0065163, 0.00095247, 0.014978, 0.0058468, 0.0006371, 0.014119, 0.005349, 0.00037342, 0.013908, 0.0050797, 0.00018086, 0.010884, 0.0036954, 7.6489e-05, 0.010114, 0.003265, 2.8834e-05, 0.010325, 0.0033018, 1.016e-05, 0.010577, 0.0034506, 3.4756e-06, 0.0095478, 0.0029436, 1.1876e-06, 0.0079357, 0.0021886, 4.1082e-07, 0.0066726, 0.0017288, 1.4431e-07, 0.0063245, 0.0014932, 5.1427e-08, 0.0053304, 0.0011375, 1.856e-08, 0.00514, 0.0010494, 6.7711e-09, 0.0045717, 0.00091936, 2.4928e-09, 0.0037261, 0.0007421, 9.2468e-10, 0.0028064, 0.00053515, 3.4511e-10, 0.002153, 0.00041153, 1.2943e-10, 0.0019652, 0.00037428, 4.8731e-11, 0.0018471, 0.0003554, 1.84e-11, 0.0017766, 0.00036289, 6.9621e-12, 0.0023268, 0.00047866, 2.6377e-12, 0.0040795, 0.0007547, 1e-12
    ]),
]


class _Nodes:
    """Makes the nodes of a tree; `column` is where they stand."""

    def __init__(self, tree, frame):
        self.tree, self.frame, self.column, self.row = tree, frame, 0, 0

    def new(self, kind, inputs=(), **settings):
        """A node; `inputs` are pairs of a socket and an output or a value."""
        node = self.tree.nodes.new(kind if kind.startswith("Node") else "ShaderNode" + kind)
        node.location = (220 * self.column, -280 * self.row)
        if self.frame:
            node.parent = self.frame
        for name, value in settings.items():
            setattr(node, name, value)
        for socket, value in inputs:
            if hasattr(value, "links"):
                self.tree.links.new(value, node.inputs[socket])
            else:
                node.inputs[socket].default_value = value
        self.column += 1
        return node

    def math(self, operation, *values, **settings):
        return self.new("Math", enumerate(values), operation=operation, **settings).outputs[0]

    def vector(self, operation, *values, output="Vector"):
        sockets = [(3 if operation == "SCALE" and i == 1 else i, value) for i, value in enumerate(values)]
        return self.new("VectorMath", sockets, operation=operation).outputs[output]

    def next_row(self, column):
        self.row, self.column = self.row + 1, column


def _tables(bpy, name, columns, rows, numbers):
    """The image of the tables, a texel for each view and row, stored in the .blend file."""
    image = bpy.data.images.new(name, columns, rows, alpha=False, float_buffer=True, is_data=True)
    image.pixels.foreach_set([x for i in range(columns * rows) for x in (*numbers[3 * i:3 * i + 3], 1.0)])
    image.update()
    image.pack()
    return image


def _node_group(bpy, name, columns, terms, numbers):
    """The sum of closures as a group of nodes, with inputs for its colour, its roughness and the normal."""
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for kind, socket, value in (("Color", "Tint", (1, 1, 1, 1)), ("Float", "Roughness Scale", 1), ("Vector", "Normal", (0, 0, 0))):
        socket = tree.interface.new_socket(socket, in_out="INPUT", socket_type="NodeSocket" + kind)
        socket.default_value = value
        if kind == "Float":
            socket.min_value, socket.max_value = 0, 10
        if kind == "Vector":
            socket.hide_value = True
    tree.interface.new_socket("BSDF", in_out="OUTPUT", socket_type="NodeSocketShader")
    frame = tree.nodes.new("NodeFrame")
    frame.label = f"{name}: {terms} terms over the angle of the viewer"
    nodes = _Nodes(tree, frame)
    inputs = nodes.new("NodeGroupInput").outputs
    # Without a link the normal is that of the surface.
    geometry = nodes.new("NewGeometry").outputs
    unlinked = nodes.math("LESS_THAN", nodes.vector("LENGTH", inputs["Normal"], output="Value"), 0.5)
    normal = nodes.vector("NORMALIZE", nodes.vector("MULTIPLY_ADD", geometry["Normal"], unlinked, inputs["Normal"]))
    nodes.next_row(2)
    cosine = nodes.vector("DOT_PRODUCT", normal, geometry["Incoming"], output="Value")
    # Away from the viewer, in the plane of the surface.
    tangent = nodes.vector("NORMALIZE", nodes.vector("SUBTRACT", nodes.vector("SCALE", normal, cosine), geometry["Incoming"]))
    # The centre of a column is at (column + 0.5) / columns.
    place = nodes.math("MULTIPLY_ADD", nodes.math("ARCCOSINE", cosine), (columns - 1) / columns / 1.5707963, 0.5 / columns)
    image, rows, first = _tables(bpy, name + " tables", columns, 2 * terms + 1, numbers), 2 * terms + 1, nodes.column

    def table(row):
        at = nodes.new("CombineXYZ", ((0, place), (1, (row + 0.5) / rows)))
        return nodes.new("TexImage", ((0, at.outputs[0]),), image=image, interpolation="Linear", extension="EXTEND").outputs["Color"]

    def tinted(row):
        return nodes.vector("MULTIPLY", table(row), inputs["Tint"])

    nodes.next_row(first + 4)
    total = nodes.new("BsdfDiffuse", (("Color", tinted(rows - 1)), ("Roughness", 0.0), ("Normal", normal))).outputs[0]
    for term in range(terms):
        nodes.next_row(first)
        shape = nodes.new("SeparateXYZ", ((0, table(2 * term)),)).outputs
        tilted = nodes.vector("NORMALIZE", nodes.vector("MULTIPLY_ADD", tangent, shape[0], normal))
        roughness = nodes.math("MULTIPLY", shape[1], inputs["Roughness Scale"], use_clamp=True)
        closure = nodes.new("BsdfAnisotropic", (("Color", tinted(2 * term + 1)), ("Roughness", roughness), ("Anisotropy", shape[2]),
                                                ("Normal", tilted), ("Tangent", tangent)), distribution="BECKMANN")
        total = nodes.new("AddShader", ((0, total), (1, closure.outputs[0]))).outputs[0]
    nodes.new("NodeGroupOutput", (("BSDF", total),))
    return tree


def _material(bpy, name, columns, terms, numbers):
    material = bpy.data.materials.new(name)
    if material.node_tree is None:  # before Blender 5
        material.use_nodes = True
    material.use_fake_user = True  # so that it is stored though no object has it
    material.cycles.use_bump_map_correction = False  # which would bend the tilted normals back
    tree = material.node_tree
    tree.nodes.clear()
    nodes = _Nodes(tree, None)
    group = nodes.new("Group", node_tree=_node_group(bpy, name, columns, terms, numbers))
    group.width = 200
    nodes.column += 1
    nodes.new("OutputMaterial", (("Surface", group.outputs[0]),))
    return material


def measured_materials():
    """Makes the materials."""
    import bpy

    return [_material(bpy, *material) for material in _MEASURED]


def _studio(bpy):
    """A scene with a ball in a grey room under a lamp, and all that it is made of."""
    import bmesh

    scene, world, mesh = bpy.data.scenes.new("ball"), bpy.data.worlds.new("ball"), bpy.data.meshes.new("ball")
    camera, lamp = bpy.data.cameras.new("ball"), bpy.data.lights.new("ball", "AREA")
    form = bmesh.new()
    bmesh.ops.create_uvsphere(form, u_segments=96, v_segments=48, radius=1)
    form.to_mesh(mesh)
    form.free()
    mesh.shade_smooth()
    lamp.energy, lamp.size, camera.lens = 220, 2, 95
    things = [bpy.data.objects.new("ball", data) for data in (mesh, camera, lamp)]
    for thing, place, turn in zip(things, ((0, 0, 0), (0, -6.4, 0), (-3, -4, 4)), ((0, 0, 0), (1.5708, 0, 0), (0.9, 0, -0.6))):
        thing.location, thing.rotation_euler = place, turn
        scene.collection.objects.link(thing)
    if world.node_tree is None:
        world.use_nodes = True
    next(node for node in world.node_tree.nodes if node.type == "BACKGROUND").inputs["Color"].default_value = 0.2, 0.2, 0.2, 1
    scene.camera, scene.world, scene.render.engine, scene.cycles.samples = things[1], world, "CYCLES", 64
    scene.view_settings.view_transform = "Standard"
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = 128
    return scene, mesh, (scene, world, mesh, camera, lamp, *things)


def _mark_as_assets(bpy, materials):
    """Marks materials as assets, with pictures of a ball."""
    import os
    import tempfile

    scene, ball, made = _studio(bpy)
    with tempfile.TemporaryDirectory() as folder:
        for material in materials:
            ball.materials.clear()
            ball.materials.append(material)
            scene.render.filepath = os.path.join(folder, "ball.png")
            bpy.ops.render.render(write_still=True, scene=scene.name)
            picture = bpy.data.images.load(scene.render.filepath)
            material.asset_mark()
            preview = material.preview_ensure()
            preview.image_size = picture.size
            preview.image_pixels_float = picture.pixels[:]
            bpy.data.images.remove(picture)
    bpy.data.batch_remove(made)


def _measured_script():
    import sys

    import bpy

    materials = measured_materials()
    for thing in bpy.context.selected_objects:
        if hasattr(thing.data, "materials"):
            thing.data.materials.clear()
            for material in materials:
                thing.data.materials.append(material)
    if "--" in sys.argv:
        _mark_as_assets(bpy, materials)
        bpy.ops.wm.save_as_mainfile(filepath=sys.argv[sys.argv.index("--") + 1])


if __name__ == "__main__":
    _measured_script()
