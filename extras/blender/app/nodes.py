

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


def _describe(materials, folder, table):
    """Gives assets what the rows of a CSV file have for them. The catalogues stand in a file of Blender's beside them."""
    import csv
    import os
    import uuid

    catalogues = {}
    with open(table, encoding="utf-8") as file:
        rows = {row["material"]: row for row in csv.DictReader(file)}
    for material in materials:
        row, asset = rows[material.name], material.asset_data
        material.name, asset.author, asset.license, asset.description = (row[key] for key in ("name", "author", "licence", "description"))
        asset.catalog_id = str(uuid.uuid5(uuid.NAMESPACE_URL, row["catalogue"]))
        catalogues[asset.catalog_id] = row["catalogue"]
        for tag in row["tags"].split():
            asset.tags.new(tag)
    with open(os.path.join(folder, "blender_assets.cats.txt"), "w", encoding="utf-8") as file:
        file.write("VERSION 1\n" + "".join(f"{key}:{path}:{path.replace('/', '-')}\n" for key, path in catalogues.items()))


def _measured_script():
    import os
    import sys

    import bpy

    materials = measured_materials()
    for thing in bpy.context.selected_objects:
        if hasattr(thing.data, "materials"):
            thing.data.materials.clear()
            for material in materials:
                thing.data.materials.append(material)
    if "--" in sys.argv:
        path, *table = map(os.path.abspath, sys.argv[sys.argv.index("--") + 1:])
        _mark_as_assets(bpy, materials)
        if table:
            _describe(materials, os.path.dirname(path), table[0])
        bpy.ops.wm.save_as_mainfile(filepath=path, compress=True)


if __name__ == "__main__":
    _measured_script()
