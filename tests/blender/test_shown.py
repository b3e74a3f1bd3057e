"""The file looks like the screen, in every format."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import QUICK, decompose, empty, exportable, load, meshes, run

save = import_module("bl_ext.user_default.spectral_tv.command_line.save").save
curves_in = import_module("bl_ext.user_default.spectral_tv.scene.animation").curves_of
FORMATS = [suffix for suffix in exportable() if suffix not in (".usd", ".usda", ".usdz")]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def seen() -> np.ndarray:
    """Where the vertices of all meshes are seen in the world, (N, 3)."""
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    parts = []
    for obj in meshes():
        if obj.visible_get():
            shape = obj.evaluated_get(graph)
            local = np.array([vertex.co for vertex in shape.data.vertices]).reshape(-1, 3)
            matrix = np.array(shape.matrix_world)
            parts.append(local @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(parts)


def distance(one: np.ndarray, other: np.ndarray) -> float:
    """How far a point of either is from the nearest of the other, relative to the size."""
    apart = np.linalg.norm(one[:, np.newaxis] - other, axis=2)
    size = np.linalg.norm(np.ptp(one, axis=0))
    return float(max(apart.min(axis=0).max(), apart.min(axis=1).max()) / size)


def relief() -> bpy.types.Object:
    """A grid with bumps, keys and a vertex group on half of it."""
    empty()
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=7, y_subdivisions=6, location=(1, 2, 3))
    obj = bpy.context.object
    obj.rotation_euler = (0.3, 0.2, 0.1)
    for vertex in obj.data.vertices:
        vertex.co.z = 0.2 * np.sin(5 * vertex.co.x) * np.cos(4 * vertex.co.y)
    half = [vertex.index for vertex in obj.data.vertices if vertex.co.x > 0]
    obj.vertex_groups.new(name="Half").add(half, 0.7, "REPLACE")
    obj.shape_key_add(name="Basis", from_mix=False)
    for name, axis in (("Up", 2), ("Side", 0)):
        key = obj.shape_key_add(name=name, from_mix=False)
        key.slider_min = -2
        for point in key.data:
            point.co[axis] += 0.5 * np.cos(3 * point.co[1])
    return obj


def keys(obj: bpy.types.Object) -> bpy.types.bpy_prop_collection:
    return obj.data.shape_keys.key_blocks


def masked(obj):
    keys(obj)["Up"].value, keys(obj)["Up"].vertex_group = 0.8, "Half"
    keys(obj)["Side"].value = -1.5


def muted(obj):
    keys(obj)["Up"].value, keys(obj)["Up"].mute = 0.8, True
    keys(obj)["Side"].value = 0.5


def pinned(obj):
    keys(obj)["Side"].value = 0.5
    obj.active_shape_key_index, obj.show_only_shape_key = 1, True


def chained(obj):
    keys(obj)["Side"].relative_key = keys(obj)["Up"]
    keys(obj)["Side"].value = 0.5


def driven(obj):
    keys(obj)["Up"].driver_add("value").driver.expression = "0.25 + 0.5"


def keyed(obj):
    for frame, value in ((1, 0), (11, 1)):
        keys(obj)["Up"].value = value
        keys(obj)["Up"].keyframe_insert("value", frame=frame)
    keys(obj)["Side"].value = 0.3
    bpy.context.scene.frame_end = 11
    bpy.context.scene.frame_set(1)


def keyed_and_muted(obj):
    keyed(obj)
    keys(obj)["Up"].mute = True


def simplified(obj):
    """The scene limits what is seen otherwise than what is rendered."""
    subdivided(obj)
    render = bpy.context.scene.render
    render.use_simplify, render.simplify_subdivision, render.simplify_subdivision_render = (
        True,
        1,
        0,
    )


def subdivided(obj):
    masked(obj)
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 2


def mirrored(obj):
    masked(obj)
    obj.modifiers.new("Mirror", "MIRROR").use_axis = (False, True, False)


def thick(obj):
    """Not linear in the keys."""
    masked(obj)
    solidify = obj.modifiers.new("Solidify", "SOLIDIFY")
    solidify.thickness, solidify.use_even_offset = 0.2, True


def off(obj):
    masked(obj)
    obj.modifiers.new("Solidify", "SOLIDIFY").show_viewport = False


def posed(obj):
    masked(obj)
    bpy.ops.object.armature_add(location=(1, 2, 3))
    rig = bpy.context.object
    obj.vertex_groups["Half"].name = "Bone"
    keys(obj)["Up"].vertex_group = "Bone"
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    rig.pose.bones["Bone"].rotation_mode = "XYZ"
    rig.pose.bones["Bone"].rotation_euler = (0.5, 0.2, 0)


def posed_as_a_child(obj):
    posed(obj)
    obj.parent = bpy.context.object
    obj.matrix_parent_inverse = obj.parent.matrix_world.inverted()
    obj.parent.rotation_euler = (0, 0.4, 0)


def posed_by_a_hidden_rig(obj):
    posed(obj)
    bpy.context.object.hide_set(True)


def posed_and_subdivided(obj):
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 1
    posed(obj)


def hidden(obj):
    masked(obj)
    for name, place in (("hide_set", 5), ("hide_viewport", 8)):
        bpy.ops.mesh.primitive_cube_add(location=(place, 0, 0))
        bpy.context.object.name = f"By {name}"
        if name == "hide_set":
            bpy.context.object.hide_set(True)
        else:
            bpy.context.object.hide_viewport = True


def not_rendered(obj):
    """Each is seen all the same."""
    masked(obj)
    obj.hide_render = True
    bpy.ops.mesh.primitive_cube_add(location=(5, 0, 0))
    cube, collection = bpy.context.object, bpy.data.collections.new("Draft")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(cube)
    bpy.context.scene.collection.objects.unlink(cube)
    collection.hide_render = True


def animated_to_be_not_rendered(obj):
    masked(obj)
    obj.hide_render = True
    obj.keyframe_insert("hide_render", frame=1)
    bpy.ops.mesh.primitive_cube_add(location=(5, 0, 0))
    bpy.context.object.driver_add("hide_render").driver.expression = "1"


def rendered_with_more(obj):
    """By a modifier that is off in the viewport, beside one that is off in renders."""
    masked(obj)
    obj.modifiers.new("Solidify", "SOLIDIFY").show_viewport = False
    modifier = obj.modifiers.new("Mirror", "MIRROR")
    modifier.use_axis, modifier.show_render = (False, True, False), False


POSES = [posed, posed_as_a_child, posed_by_a_hidden_rig, posed_and_subdivided]
SCENES = [
    masked, muted, pinned, chained, driven, keyed, keyed_and_muted, subdivided, simplified,
    mirrored, thick, off, *POSES, hidden, not_rendered,
    animated_to_be_not_rendered, rendered_with_more,
]  # fmt: skip


def write(path: Path, change: Callable[[bpy.types.Object], None]) -> np.ndarray:
    """Write a scene as a .blend and return what is seen of it."""
    change(relief())
    points = seen()
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return points


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_every_file_looks_like_the_screen(tmp_path: Path, capfd, scene):
    source = tmp_path / "scene.blend"
    expected = write(source, scene)
    for suffix in FORMATS:
        target = tmp_path / f"out{suffix}"
        quick = [*QUICK, "--gain", "all=1"]
        assert run(["decompose", str(source), "-o", str(target), *quick]) == 0
        told = capfd.readouterr().err
        frame = bpy.context.scene.frame_current
        load(target)
        bpy.context.scene.frame_set(frame)
        # Blender 4.2 does not read poses of USD that it has written.
        if suffix != ".usdc" or scene not in POSES or bpy.app.version >= (4, 3):
            assert distance(expected, seen()) < 2e-6, suffix
        has_keys = suffix in (".glb", ".gltf", ".fbx", ".usdc")
        for text, scenes in (
            ("muted shape keys are 0", [muted, keyed_and_muted]),
            ("shown alone", [pinned]),
        ):
            assert (text in told) == (scene in scenes and has_keys)
        assert ("hidden, and so not in the file" in told) == (
            scene is hidden and suffix != ".blend"
        )


@pytest.mark.parametrize("suffix", [".ply", ".stl", ".obj"])
def test_curves_are_as_fine_as_on_the_screen(tmp_path: Path, suffix):
    """Not as fine as they are rendered."""
    relief()
    bpy.ops.curve.primitive_bezier_circle_add(location=(5, 0, 0))
    curve = bpy.context.object
    curve.data.dimensions, curve.data.fill_mode = "3D", "FULL"
    curve.data.bevel_depth = 0.1
    curve.data.resolution_u, curve.data.render_resolution_u = 3, 7
    curve.hide_render = True
    graph = bpy.context.evaluated_depsgraph_get()
    shape = curve.evaluated_get(graph)
    points = np.array([shape.matrix_world @ vertex.co for vertex in shape.to_mesh().vertices])
    expected = np.concatenate([seen(), points])
    source, target = tmp_path / "scene.blend", tmp_path / f"out{suffix}"
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    assert run(["decompose", str(source), "-o", str(target), *QUICK, "--gain", "all=1"]) == 0
    load(target)
    assert distance(expected, seen()) < 2e-6


@pytest.mark.parametrize("suffix", [".ply", ".stl", ".obj"])
def test_instances_are_as_the_screen_shows_them(tmp_path: Path, suffix):
    """Of a collection that is not rendered, with a modifier that is finer in renders."""
    relief()
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    modifier = cube.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 2
    cube.hide_render = True
    collection = bpy.data.collections.new("Draft")
    collection.objects.link(cube)
    bpy.context.scene.collection.objects.unlink(cube)
    collection.hide_render = True
    bpy.ops.object.collection_instance_add(collection="Draft", location=(5, 0, 0))
    expected = points_shown()
    source, target = tmp_path / "scene.blend", tmp_path / f"out{suffix}"
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    assert run(["decompose", str(source), "-o", str(target), *QUICK, "--gain", "all=1"]) == 0
    load(target)
    assert distance(expected, seen()) < 2e-6


@pytest.mark.skipif(".usda" not in exportable(), reason="this Blender is built without .usda")
def test_a_still_pose_is_in_usd(tmp_path: Path):
    source, target = tmp_path / "scene.blend", tmp_path / "out.usda"
    write(source, posed)
    assert run(["decompose", str(source), "-o", str(target), *QUICK, "--gain", "all=1"]) == 0
    assert "SkelAnimation" in target.read_text(encoding="utf-8")


def test_a_limit_to_a_vertex_group_is_kept_in_every_format(tmp_path: Path):
    source = tmp_path / "in.blend"
    relief()
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    options = ["--vertex-group", "Half", "--method", "m2", "--gain", "all=0", *QUICK]
    shapes = {}
    for suffix in FORMATS:
        target = tmp_path / f"out{suffix}"
        assert run(["decompose", str(source), "-o", str(target), *options]) == 0
        load(target)
        shapes[suffix] = seen()
    load(source)
    untouched = seen()
    assert distance(untouched, shapes[".blend"]) > 0.02
    for suffix, shape in shapes.items():
        assert distance(shapes[".blend"], shape) < 2e-6, suffix


def curves_of(obj: bpy.types.Object) -> list[bpy.types.FCurve]:
    """What animates an object, and what drives it."""
    animation = obj.animation_data
    if animation is None:
        return []
    action = animation.action
    return [*animation.drivers, *(() if action is None else curves_in(obj) or ())]


def described() -> list[str]:
    """All that there is: names, who holds what, settings of keys and modifiers, coordinates."""
    found = [f"{item.bl_rna.name} {item.name} {item.users}" for item in bpy.data.user_map()]
    for obj in bpy.context.scene.objects:
        found += [f"{obj.name} {obj.data and obj.data.name} {obj.hide_get()} {obj.hide_viewport}"]
        found += [f"{obj.hide_render} {[curve.mute for curve in curves_of(obj)]}"]
        found += [f"{obj.select_get()} {obj.show_only_shape_key} {obj.matrix_world}"]
        found += [f"{each.name} {each.show_viewport} {each.show_render}" for each in obj.modifiers]
        if obj.type == "MESH" and obj.data.shape_keys is not None:
            animation = obj.data.shape_keys.animation_data
            found += [str(animation and (animation.action, len(animation.drivers)))]
            for key in keys(obj):
                found += [f"{key.name} {key.value} {key.mute} {key.vertex_group} {key.slider_min}"]
                found += [str([tuple(point.co) for point in key.data])]
    return sorted(found)


def test_writing_leaves_the_scene_as_it_was(tmp_path: Path):
    """The .blend that is saved after all other formats is the one that is saved before."""
    write_all = [suffix for suffix in FORMATS if suffix != ".blend"]
    for scene in (keyed_and_muted, posed_and_subdivided, hidden, animated_to_be_not_rendered):
        source = tmp_path / f"{scene.__name__}.blend"
        write(source, scene)
        read = load(source)
        before = described()
        for suffix in write_all:
            save(tmp_path / f"out{suffix}", None, read)
            assert described() == before, suffix


def scattered(path: Path) -> bpy.types.NodeTree:
    """Write a .blend of cubes on the vertices of a relief, by nodes, and return these."""
    obj = relief()
    group = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    group.interface.new_socket("In", in_out="INPUT", socket_type="NodeSocketGeometry")
    group.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    names = (
        "NodeGroupInput",
        "GeometryNodeInstanceOnPoints",
        "NodeGroupOutput",
        "GeometryNodeMeshCube",
    )
    start, scatter, end, cube = (group.nodes.new(name) for name in names)
    join = group.nodes.new("GeometryNodeJoinGeometry")
    group.links.new(start.outputs[0], scatter.inputs["Points"])
    group.links.new(cube.outputs["Mesh"], scatter.inputs["Instance"])
    for node in (start, scatter):
        group.links.new(node.outputs[0], join.inputs[0])
    group.links.new(join.outputs[0], end.inputs[0])
    obj.modifiers.new("Scatter", "NODES").node_group = group
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return group


def test_instances_that_cannot_come_along_are_told(tmp_path: Path, capfd):
    source = tmp_path / "in.blend"
    scattered(source)
    for suffix in (".glb", ".fbx"):
        target = tmp_path / f"out{suffix}"
        assert run(["decompose", str(source), "-o", str(target), *QUICK]) == 0
        assert "left out: instances that Grid shows" in capfd.readouterr().err


def points_shown() -> np.ndarray:
    """Where the vertices of all that is shown are in the world, instances too, (N, 3)."""
    bpy.context.view_layer.update()
    items = bpy.context.evaluated_depsgraph_get().object_instances
    return np.array(
        [
            item.matrix_world @ vertex.co
            for item in items
            if item.show_self and item.object.type == "MESH"
            for vertex in item.object.data.vertices
        ]
    )


@pytest.mark.parametrize("suffix", [".ply", ".stl", ".obj"])
def test_instances_of_nodes_are_as_the_screen_shows_them(tmp_path: Path, suffix):
    source, target = tmp_path / "in.blend", tmp_path / f"out{suffix}"
    scattered(source)
    expected = points_shown()
    assert run(["decompose", str(source), "-o", str(target), *QUICK, "--gain", "all=1"]) == 0
    load(target)
    assert distance(expected, seen()) < 2e-6


def test_nodes_that_tell_renders_from_the_screen_are_told(tmp_path: Path, capfd):
    """Where Blender writes what is rendered."""
    source = tmp_path / "in.blend"
    scattered(source).nodes.new("GeometryNodeIsViewport")
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    for suffix in (".ply", ".stl"):
        assert run(["decompose", str(source), "-o", str(tmp_path / f"out{suffix}"), *QUICK]) == 0
        told = "written as it is rendered, by the nodes that tell: Scatter"
        expected = suffix == ".ply" and bpy.app.version >= (5, 2)
        assert (told in capfd.readouterr().err) == expected


def test_what_the_extension_keeps_on_a_mesh_is_in_no_other_file(tmp_path: Path):
    """Before Blender 5.0 it is among the custom properties."""
    empty()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    bpy.context.object.data["mine"] = 7
    bpy.ops.spectral_tv.decompose(bands=2, steps=4)
    source, target = tmp_path / "in.blend", tmp_path / "out.gltf"
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    assert decompose(source, target) == 0
    extras = [mesh.get("extras", {}) for mesh in json.loads(target.read_text())["meshes"]]
    assert [sorted(set(each) - {"targetNames"}) for each in extras] == [["mine"]]
