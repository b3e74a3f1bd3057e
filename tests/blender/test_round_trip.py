"""All-passed, every format keeps every kind of content that the table says; the rest is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import empty, exportable, load, meshes, run
from test_shown import distance

formats = import_module("bl_ext.user_default.spectral_tv.command_line.formats")
contents = import_module("bl_ext.user_default.spectral_tv.command_line.contents")
FORMATS = [suffix for suffix in exportable() if suffix not in (".blend", ".usd", ".usda")]
ALL_PASS = ["--gain", "all=1", "--bands", "1", "--steps", "2"]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def grid(name: str = "Grid", place: tuple = (0, 0, 0)) -> bpy.types.Object:
    """A bent grid of nine quads."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=3, y_subdivisions=3, location=place)
    obj = bpy.context.object
    obj.name = obj.data.name = name
    for vertex in obj.data.vertices:
        vertex.co.z = 0.3 * np.sin(3 * vertex.co.x + vertex.co.y)
    return obj


def numbers(count: int, columns: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((count, columns))


def world(obj: bpy.types.Object) -> np.ndarray:
    """Where the vertices of an object are seen, (V, 3)."""
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.array([vertex.co for vertex in shape.data.vertices]).reshape(-1, 3)
    matrix = np.array(obj.matrix_world)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def corners(obj: bpy.types.Object) -> list[int]:
    return [loop.vertex_index for loop in obj.data.loops]


def cloud(values: np.ndarray, domain: str = "POINT") -> np.ndarray:
    """Values of the only mesh with the places that they are at, (N, 3 + C)."""
    (obj,) = meshes()
    points = world(obj)
    values = np.asarray(values, dtype=float).reshape(len(values), -1)
    if domain == "FACE":
        points = np.array([np.mean(points[list(f.vertices)], axis=0) for f in obj.data.polygons])
    return np.hstack([points[corners(obj)] if domain == "CORNER" else points, values])


def attribute_values(name: str, width: int = 1) -> np.ndarray:
    (obj,) = meshes()
    attribute = obj.data.attributes[name]
    key = {"FLOAT_VECTOR": "vector", "FLOAT_COLOR": "color", "BYTE_COLOR": "color",
           "FLOAT2": "vector"}.get(attribute.data_type, "value")  # fmt: skip
    return np.array([getattr(item, key) for item in attribute.data], dtype=float)


def add_colors():
    mesh = grid().data
    for name, kind, domain in (
        ("Paint", "FLOAT_COLOR", "POINT"),
        ("Dirt", "BYTE_COLOR", "CORNER"),
    ):
        layer = mesh.color_attributes.new(name, kind, domain)
        values = numbers(len(layer.data), 4, len(name))
        values[:, 3] = 1
        layer.data.foreach_set("color", values.astype(np.float32).ravel())


def colors():
    (obj,) = meshes()
    return [
        cloud(attribute_values(layer.name), layer.domain)
        for layer in contents.color_layers(obj.data)
    ]


def add_uvs():
    mesh = grid().data
    for name in ("Second", "Third"):
        layer = mesh.uv_layers.new(name=name)
        layer.data.foreach_set("uv", numbers(len(mesh.loops), 2, len(name)).astype("f").ravel())


def uvs():
    (obj,) = meshes()
    return [
        cloud([tuple(item.uv) for item in layer.data], "CORNER")
        for layer in contents.uv_layers(obj.data)
    ]


def material(name: str, color: tuple) -> bpy.types.Material:
    made = bpy.data.materials.new(name)
    if made.node_tree is None:  # before Blender 5
        made.use_nodes = True
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = color
    return made


def add_materials():
    mesh = grid().data
    for number, name in enumerate(("Gold", "Tin")):
        mesh.materials.append(material(name, (0.2 + 0.5 * number, 0.5, 0.1, 1)))
    mesh.polygons[4].material_index = 1


def materials():
    (obj,) = meshes()
    used = {face.material_index for face in obj.data.polygons}
    return [sorted(obj.data.materials[index].name for index in used)]


def add_textures():
    made = material("Wood", (1, 1, 1, 1))
    image = bpy.data.images.new("Grain", 8, 8)
    image.pixels.foreach_set(np.round(255 * numbers(64, 4)).astype(np.float32).ravel() / 255)
    image.pixels.foreach_set(np.round(np.ones((64, 4)) * numbers(64, 4), 1).astype("f").ravel())
    image.pack()
    node = made.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    shader = made.node_tree.nodes["Principled BSDF"]
    made.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    grid().data.materials.append(made)


def textures():
    (obj,) = meshes()
    (image,) = contents.images(obj.data.materials[0].node_tree)
    pixels = np.array(image.pixels).reshape(-1, 4)
    return [np.round(255 * pixels[:, :3])]


def add_normals():
    mesh = grid().data
    normals = numbers(len(mesh.vertices), 3) + np.array([0, 0, 1])
    mesh.normals_split_custom_set_from_vertices(normals.tolist())


def normals():
    (obj,) = meshes()
    vectors = np.array([item.vector for item in obj.data.corner_normals])
    return [cloud(vectors @ np.array(obj.matrix_world)[:3, :3].T, "CORNER")]


def add_attributes():
    mesh = grid().data
    for name, kind, domain, key in (
        ("quality", "FLOAT", "POINT", "value"),
        ("label", "INT", "POINT", "value"),
        ("part", "INT", "FACE", "value"),
        ("width", "FLOAT", "EDGE", "value"),
    ):
        attribute = mesh.attributes.new(name, kind, domain)
        attribute.data.foreach_set(key, np.arange(len(attribute.data)) % 5)


def attributes():
    (obj,) = meshes()
    names = {item.name.lower().strip("_"): item.name for item in obj.data.attributes}
    return [cloud(attribute_values(names[name])) for name in ("quality", "label") if name in names]


def add_groups():
    obj = grid()
    for vertex in obj.data.vertices:
        group = obj.vertex_groups.get("Half") or obj.vertex_groups.new(name="Half")
        group.add([vertex.index], vertex.index / 16, "REPLACE")


def groups():
    (obj,) = meshes()
    if "Half" in obj.vertex_groups:
        return [cloud([v.groups[0].weight for v in obj.data.vertices])]
    return [cloud(attribute_values("Half"))]


def add_keys():
    obj = grid()
    obj.shape_key_add(name="Basis", from_mix=False)
    for name, axis, value in (("Up", 2, 0.5), ("Side", 1, 0.25)):
        key = obj.shape_key_add(name=name, from_mix=False)
        key.value = value
        for point in key.data:
            point.co[axis] += 0.5 + point.co.x
    obj.data.shape_keys.animation_data_clear()


def keys():
    (obj,) = meshes()
    found = [world(obj)]
    for key in obj.data.shape_keys.key_blocks[1:]:
        if "Band" in key.name:
            continue
        moves = np.array(
            [a.co - b.co for a, b in zip(key.data, key.relative_key.data, strict=True)]
        )
        turned = moves @ np.array(obj.matrix_world)[:3, :3].T
        found += [cloud(turned), key.name]
    return found


def add_armatures():
    obj = grid()
    bpy.ops.object.armature_add()
    rig = bpy.context.object
    obj.parent = rig
    obj.modifiers.new("Rig", "ARMATURE").object = rig
    obj.vertex_groups.new(name="Bone").add(range(16), 1.0, "REPLACE")


def armatures():
    (obj,) = meshes()
    (modifier,) = contents.armatures(obj)
    weights = [sum(item.weight for item in vertex.groups) for vertex in obj.data.vertices]
    return [[bone.name for bone in modifier.object.data.bones], cloud(weights)]


def add_animation():
    obj = grid()
    for frame in (1, 10):
        obj.location.x = frame / 2
        obj.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_end = 10
    bpy.context.scene.frame_set(1)


def animation():
    (obj,) = meshes()
    found = []
    for frame in (1, 4, 10):
        bpy.context.scene.frame_set(frame)
        found.append(world(obj))
    return found


def add_objects():
    for number, name in enumerate(("One", "Two", "Three")):
        grid(name, (3 * number, 0, 0))


def objects():
    return [len(meshes())]


def names():
    return [sorted(obj.name for obj in meshes())]


def add_parents():
    child, parent = grid("Child"), grid("Parent", (1, 2, 3))
    child.parent = parent


def parents():
    (child,) = (obj for obj in meshes() if obj.name == "Child")
    above = child.parent
    while above.parent is not None:
        above = above.parent
    return [world(child), above.name[:6]]


def add_collections():
    collection = bpy.data.collections.new("Shelf")
    bpy.context.scene.collection.children.link(collection)
    obj = grid()
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)


def collections():
    (obj,) = meshes()
    return [[collection.name for collection in obj.users_collection]]


def polygons():
    (obj,) = meshes()
    return [sorted(len(face.vertices) for face in obj.data.polygons)]


def add_loose():
    mesh = bpy.data.meshes.new("Loose")
    places = [(0, 0, 0), (1, 0, 0), (0, 1, 1), (3, 3, 3), (4, 4, 4), (5, 5, 5)]
    mesh.from_pydata(places, [(3, 4)], [(0, 1, 2)])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Loose", mesh))


def loose():
    (obj,) = meshes()
    return [contents.loose(obj.data)]


def add_camera():
    grid()
    bpy.ops.object.camera_add(location=(0, -5, 1), rotation=(1.4, 0, 0))


def add_light():
    grid()
    bpy.ops.object.light_add(type="SUN", location=(0, 0, 5))


def add_curve():
    grid()
    bpy.ops.curve.primitive_bezier_circle_add(location=(5, 0, 0))


def add_other():
    grid()
    bpy.ops.object.add(type="LATTICE", location=(0, 0, 5))


def others():
    return [len([obj for obj in bpy.context.scene.objects if obj.type != "MESH"])]


def of_type(kind: str) -> Callable[[], list]:
    return lambda: [
        [
            tuple(np.round(obj.matrix_world.translation, 4))
            for obj in bpy.data.objects
            if obj.type == kind
        ]
    ]


def add_modifier():
    grid().modifiers.new("Bevel", "BEVEL").width = 0.05


def add_properties():
    grid()["note"] = 7


def properties():
    (obj,) = meshes()
    return [obj["note"]]


@dataclass(frozen=True)
class Content:
    """How a kind of content is made, how it is read back, and how exactly."""

    add: Callable[[], object]
    read: Callable[[], list]
    exact: float = 1e-5


CONTENT = {
    "vertex colors": Content(add_colors, colors, 0.01),
    "UV maps": Content(add_uvs, uvs),
    "materials": Content(add_materials, materials),
    "textures": Content(add_textures, textures),
    "custom normals": Content(add_normals, normals, 2e-3),
    "custom attributes": Content(add_attributes, attributes),
    "vertex groups": Content(add_groups, groups),
    "shape keys": Content(add_keys, keys),
    "armatures": Content(add_armatures, armatures),
    "animation": Content(add_animation, animation),
    "objects apart": Content(add_objects, objects),
    "object names": Content(add_objects, names),
    "parents": Content(add_parents, parents),
    "collections": Content(add_collections, collections),
    "quads, n-gons": Content(grid, polygons),
    "loose edges, points": Content(add_loose, loose),
    "cameras": Content(add_camera, of_type("CAMERA")),
    "lights": Content(add_light, of_type("LIGHT")),
    "curves, texts": Content(add_curve, others),
    "other objects": Content(add_other, others),
    "modifiers": Content(add_modifier, lambda: []),
    "custom properties": Content(add_properties, properties),
}
# What is said where a part is kept, and what of it is: the first so many, or all but so exact.
PARTS = {
    ("vertex colors", "8 bits"): ("8 bits: Paint lost digits", None),
    ("materials", "names"): ("the names of materials alone", None),
    ("custom normals", "per vertex"): ("one normal per vertex", None),
    ("custom attributes", "not of edges"): ("no custom attributes of edges; left out: width", None),
    ("custom attributes", "of vertices"): ("of vertices alone; left out: ", None),
    ("vertex groups", "as attributes"): (None, None),
    ("shape keys", "the file's own"): (None, None),
    ("animation", "keyframes"): (None, None),
    ("loose edges, points", "points"): ("no loose edges: 1", 0),
    ("loose edges, points", "edges"): ("loose points as vertices of nothing: 1", 0),
    ("curves, texts", "meshes"): ("curves and texts as meshes", 0),
    ("curves, texts", "curves"): (None, None),
}
LOSS = ("left out", " holds ", "applied, as")


def same(one: object, other: object, exact: float) -> bool:
    """Whether two readings are the same, the order of vertices and of layers aside."""
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        shapes = [np.shape(item)[1:] for item in (one, other)]
        return shapes[0] == shapes[1] and distance(one, other) < exact
    if isinstance(one, list):
        alike = (any(same(item, each, exact) for each in other) for item in one)
        return len(one) == len(other) and all(alike)
    return one == other


def through(source: Path, target: Path, capfd) -> str:
    """All-pass a file, read what comes out, and return what was said."""
    capfd.readouterr()
    assert run(["decompose", str(source), "-o", str(target), *ALL_PASS]) == 0
    told = capfd.readouterr().err
    load(target)
    return "\n".join(line for line in told.splitlines() if any(text in line for text in LOSS))


@pytest.mark.parametrize("kind", formats.HOLDS[".blend"])
def test_what_a_format_holds_comes_out_and_the_rest_is_told(tmp_path: Path, capfd, kind):
    content = CONTENT[kind]
    empty()
    content.add()
    source = tmp_path / "in.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    told = through(source, tmp_path / "out.blend", capfd)
    expected = content.read()
    assert told == ""
    for suffix in FORMATS:
        word = formats.HOLDS[suffix][kind]
        target = tmp_path / f"out{suffix}"
        told = through(source, target, capfd)
        if word == formats.YES:
            assert same(expected, content.read(), content.exact), (suffix, content.read())
            assert kind not in told, suffix
            before = content.read()
            told = through(target, tmp_path / f"again{suffix}", capfd)
            assert same(before, content.read(), content.exact), suffix
            assert told == "", suffix
        elif word == formats.ONE:
            assert same(expected[:1], content.read(), content.exact), suffix
            assert f"holds one of its {kind}" in told
        elif (kind, word) in PARTS:
            text, count = PARTS[kind, word]
            if kind == "custom normals" and bpy.app.version < (
                5,
                0,
            ):  # which writes those of the shape
                count = 0
            assert text is None or text in told, suffix
            assert same(expected[:count], content.read()[:count], content.exact), suffix
        elif word == formats.APPLIED:
            assert "applied, as" in told and kind in told
        elif kind == "quads, n-gons":
            assert "holds triangles alone: 9 larger polygons were split" in told
        elif kind == "object names":
            assert "holds no object names: One, Two, Three" in told
        elif kind == "objects apart":
            assert "holds one object: 3 were joined" in told
        else:
            assert word == formats.NO
            assert "left out, as" in told and kind in told, suffix


def test_the_manual_has_the_table():
    page = Path(__file__).resolve().parents[2] / "docs" / "formats.md"
    assert formats.TABLE in page.read_text(encoding="utf-8")
