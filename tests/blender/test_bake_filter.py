"""Baking a filter over frames: a cache that plays the filter of each frame, or nothing at all."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import object_of
from command_line_files import exportable
from conftest import MODULE
from contents import contents, differences
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from moving_shapes import body, frames, remeshed_frames
from shapes import icosphere

FRAMES = range(3, 8)
SUFFIXES = [suffix for suffix in (".abc", ".pc2") if suffix == ".pc2" or suffix in exportable()]
SMALL = {"method": "M1", "bands": 4, "steps": 8}


@pytest.fixture(autouse=True)
def _as_it_was():
    yield
    bpy.data.batch_remove([*bpy.data.actions, *bpy.data.armatures, *bpy.data.cache_files])
    bpy.data.batch_remove([*bpy.data.node_groups])
    bpy.context.scene.frame_set(1)


def bending_body(*, bends: bool = True) -> bpy.types.Object:
    """The body with an armature that bends it, its bands at gains."""
    vertices, faces = icosphere(4)
    obj = object_of("Body", body(vertices, 0.0, bends=False), faces)
    obj.select_set(True)
    upper = np.clip(obj.data.vertices and [v.co.z for v in obj.data.vertices], -0.5, 0.5) + 0.5
    for name, weights in (("Lower", 1 - upper), ("Upper", upper)):
        group = obj.vertex_groups.new(name=name)
        for vertex, weight in enumerate(weights):
            group.add([vertex], weight, "REPLACE")
    bpy.ops.object.armature_add()
    rig = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones[0]
    bone.name, bone.head, bone.tail = "Lower", (0, 0, -1), (0, 0, 0)
    other = rig.data.edit_bones.new("Upper")
    other.head, other.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    pose = rig.pose.bones["Upper"]
    pose.rotation_mode = "XYZ"
    for frame, angle in ((FRAMES[0], 0.0), (FRAMES[-1], 0.8 if bends else 0.0)):
        pose.rotation_euler.x = angle
        pose.keyframe_insert("rotation_euler", frame=frame)
    obj.modifiers.new("Rig", "ARMATURE").object = rig
    bpy.context.view_layer.objects.active = obj
    bpy.context.scene.frame_set(FRAMES[0])
    bpy.ops.spectral_tv.decompose(**SMALL)
    for key, value in zip(obj.data.shape_keys.key_blocks[1:], (-1, -0.5, 0.4, 0), strict=True):
        key.value = value
    return obj


def bake(target: Path, **options) -> bpy.types.Object:
    """Bake what is active, and return the new object."""
    ends = {"frame_start": FRAMES[0], "frame_end": FRAMES[-1]}
    done = bpy.ops.spectral_tv.bake_filter(filepath=str(target), **ends, **options)
    assert done == {"FINISHED"}
    return bpy.context.object


def seen(obj: bpy.types.Object, frame: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices in the world and triangles of what is seen on a frame."""
    bpy.context.scene.frame_set(frame)
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = shape.data
    mesh.calc_loop_triangles()
    vertices = np.array([obj.matrix_world @ vertex.co for vertex in mesh.vertices])
    return vertices, np.array([triangle.vertices[:] for triangle in mesh.loop_triangles])


def without_bands(obj: bpy.types.Object, frame: int) -> tuple[np.ndarray, np.ndarray]:
    values = [key.value for key in obj.data.shape_keys.key_blocks]
    for key in obj.data.shape_keys.key_blocks[1:]:
        key.value = 0
    found = seen(obj, frame)
    for key, value in zip(obj.data.shape_keys.key_blocks, values, strict=True):
        key.value = value
    return found


def expected(shapes, values, masks=None, area=None) -> list[np.ndarray]:
    """What the package makes of frames."""
    meshes = [spectral_tv.Mesh(*shape, weld=0.0) for shape in shapes]
    area = meshes[0].area if area is None else area
    times = spectral_tv.graded_times(
        *(area * scale for scale in spectral_tv.default_scales("m1")), SMALL["steps"]
    )
    splits = spectral_tv.decompose_sequence(
        meshes, "m1", times, area=area, keeps_limbs=True, soft_edges=0.3
    )
    found = []
    for mesh, split in zip(meshes, splits, strict=True):
        bands = split.bands(split.band_edges(SMALL["bands"]), 1.0)
        if masks is not None:
            bands = masks[:, :, np.newaxis] * bands
        found.append(mesh.vertices + np.tensordot(values, bands, 1))
    return found


def away(one, other) -> float:
    """How far the vertices of a shape are from the surface of another, root mean square."""
    tree = BVHTree.FromPolygons(one[0].tolist(), one[1].tolist())
    return float(np.sqrt(np.mean([tree.find_nearest(Vector(p))[3] ** 2 for p in other[0]])))


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_cache_plays_the_filter_of_every_frame(tmp_path: Path, suffix):
    obj = bending_body()
    obj.location, obj.rotation_euler, obj.scale = (1, 2, 3), (0.3, 0, 0.5), (1.5, 1.5, 1.5)
    key = obj.data.shape_keys.key_blocks[1]
    values = [key.value for key in obj.data.shape_keys.key_blocks[1:]]
    key.vertex_group = "Upper"
    weights = np.zeros((SMALL["bands"], len(obj.data.vertices)))
    weights[:] = 1
    index = obj.vertex_groups["Upper"].index
    weights[0] = [
        sum(each.weight for each in vertex.groups if each.group == index)
        for vertex in obj.data.vertices
    ]
    inputs = [without_bands(obj, frame) for frame in FRAMES]
    outputs = expected(inputs, values, weights)
    bpy.context.scene.frame_set(5)
    target = tmp_path / f"cache{suffix}"
    new = bake(target)
    assert bpy.context.scene.frame_current == 5
    assert target.stat().st_size > 0 and [*tmp_path.iterdir()] == [target]
    assert obj.hide_get() and obj.hide_render and new.name == "Body Filtered"
    assert [item.type for item in new.modifiers] == [
        {".abc": "MESH_SEQUENCE_CACHE", ".pc2": "MESH_CACHE"}[suffix]
    ]
    for frame, before, after in zip(FRAMES, inputs, outputs, strict=True):
        found, _ = seen(new, frame)
        assert np.abs(after - before[0]).max() > 0.01
        np.testing.assert_allclose(found, after, atol=2e-5)
    for (one, other), (before, after) in zip(
        pairwise(inputs), pairwise([seen(new, frame) for frame in FRAMES]), strict=True
    ):
        moved = [np.linalg.norm(b[0] - a[0]) for a, b in ((one, other), (before, after))]
        assert moved[1] < 2 * moved[0]


def test_values_that_are_keyframed_are_those_of_each_frame(tmp_path: Path):
    obj = bending_body(bends=False)
    key = obj.data.shape_keys.key_blocks[2]
    for frame, value in ((FRAMES[0], 0.0), (FRAMES[-1], -1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    obj.data.shape_keys.key_blocks[3].mute = True
    new = bake(tmp_path / "cache.pc2")
    bpy.context.scene.frame_set(4)
    values = [-1, key.value, 0, 0]
    assert -1 < key.value < 0
    before = without_bands(obj, FRAMES[0])
    (after,) = expected([before], values)
    np.testing.assert_allclose(seen(new, 4)[0], after, atol=2e-5)


def test_bands_as_attributes_are_baked_alike(tmp_path: Path):
    obj = bending_body()
    by_keys = seen(bake(tmp_path / "keys.pc2"), 3)[0]
    bpy.ops.object.select_all(action="DESELECT")
    obj.hide_viewport = False
    obj.hide_set(False)
    bpy.context.view_layer.objects.active = obj
    bpy.context.scene.frame_set(FRAMES[0])
    assert bpy.ops.spectral_tv.convert_bands(to="ATTRIBUTES") == {"FINISHED"}
    new = bake(tmp_path / "attributes.pc2")
    np.testing.assert_allclose(seen(new, 3)[0], by_keys, atol=2e-6)


def test_sizes_may_go_by_all_frames(tmp_path: Path):
    obj = bending_body(bends=False)
    for frame, scale in ((FRAMES[0], 0.5), (FRAMES[1], 1.0)):
        obj.scale = (scale, scale, scale)
        obj.keyframe_insert("scale", frame=frame)
    values = [key.value for key in obj.data.shape_keys.key_blocks[1:]]
    inputs = [without_bands(obj, frame) for frame in FRAMES]
    for scales, area in (("FIRST", None), ("ALL", spectral_tv.Mesh(*inputs[-1]).area)):
        bpy.context.view_layer.objects.active = obj
        obj.hide_set(False)
        new = bake(tmp_path / f"{scales}.pc2", scales=scales)
        outputs = expected(inputs, values, area=area)
        for frame, after in zip(FRAMES, outputs, strict=True):
            np.testing.assert_allclose(seen(new, frame)[0], after, atol=5e-5)


@pytest.mark.skipif(".abc" not in SUFFIXES, reason="this Blender is built without Alembic")
def test_frames_with_other_vertices_do_not_flicker(tmp_path: Path):
    obj = bending_body()
    remesh = obj.modifiers.new("Remesh", "REMESH")
    remesh.mode, remesh.voxel_size = "VOXEL", 0.06
    inputs = [without_bands(obj, frame) for frame in FRAMES]
    assert len({len(vertices) for vertices, _ in inputs}) > 1
    meshes = len(bpy.data.meshes)
    new = bake(tmp_path / "cache.abc")
    assert len(bpy.data.meshes) == meshes + 1 and not bpy.data.node_groups
    outputs = [seen(new, frame) for frame in FRAMES]
    for before, after in zip(inputs, outputs, strict=True):
        assert len(before[0]) == len(after[0])
        assert away(before, after) > 5e-4
    for (one, other), (before, after) in zip(pairwise(inputs), pairwise(outputs), strict=True):
        assert away(before, after) < 2 * away(one, other)


@pytest.mark.skipif(".abc" not in SUFFIXES, reason="this Blender is built without Alembic")
@pytest.mark.parametrize("keeps_vertices", [True, False])
def test_what_an_alembic_file_plays_is_filtered(tmp_path: Path, keeps_vertices):
    if not keeps_vertices and find_spec("scipy") is None:
        pytest.skip("this Blender is built without SciPy")
    made = {True: frames, False: remeshed_frames}[keeps_vertices]
    shapes = made(
        len(FRAMES), 0.02, **({"subdivisions": 3} if keeps_vertices else {"vertices": 700})
    )
    playing = import_module(f"{MODULE}.scene.playing")
    obj = object_of("Cloth", *shapes[0])
    meshes = []
    for vertices, faces in shapes:
        meshes.append(bpy.data.meshes.new("Frame"))
        meshes[-1].from_pydata(vertices.tolist(), [], faces.tolist())
    modifier = playing.play_meshes(obj, meshes, FRAMES)
    bpy.ops.wm.alembic_export(
        filepath=str(tmp_path / "in.abc"),
        start=FRAMES[0],
        end=FRAMES[-1],
        evaluation_mode="VIEWPORT",
    )
    playing.take_apart(modifier)
    bpy.data.objects.remove(obj)
    bpy.context.scene.frame_set(FRAMES[0])
    bpy.ops.wm.alembic_import(filepath=str(tmp_path / "in.abc"))
    (obj,) = (each for each in bpy.context.scene.objects if each.type == "MESH")
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.decompose(**SMALL)
    values = (-1, -1, 0.5, 0)
    for key, value in zip(obj.data.shape_keys.key_blocks[1:], values, strict=True):
        key.value = value
    outputs = expected(shapes, values)
    new = bake(tmp_path / "out.abc")
    for frame, after in zip(FRAMES, outputs, strict=True):
        np.testing.assert_allclose(seen(new, frame)[0], after, atol=1e-4)


def test_what_cannot_be_baked_is_refused_and_leaves_nothing(tmp_path: Path):
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)  # a file without a name
    obj = bending_body()
    before = contents()
    ends = {"frame_start": FRAMES[0], "frame_end": FRAMES[-1]}
    build = obj.modifiers.new("Build", "BUILD")
    build.frame_start, build.frame_duration = FRAMES[0] - 1, 3
    with_build = contents()
    for options, message in (
        ({}, "save the .blend first"),
        ({"filepath": "//cache.pc2"}, "save the .blend first"),
        ({"filepath": str(tmp_path / "cache.txt")}, "a cache is an .abc or a .pc2"),
        ({"filepath": str(tmp_path / "none" / "cache.pc2")}, "there is no folder"),
        ({"filepath": str(tmp_path / "cache.pc2")}, "its vertices are others on other frames"),
        ({"filepath": str(tmp_path / "cache.pc2"), "frame_end": 1}, "comes before frame"),
    ):
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.spectral_tv.bake_filter(**{**ends, **options})
        assert not differences(with_build, contents())
    obj.modifiers.remove(build)
    taken = tmp_path / "cache.pc2"
    taken.mkdir()
    with pytest.raises(RuntimeError, match="Body: "):
        bpy.ops.spectral_tv.bake_filter(filepath=str(taken), **ends)
    assert not differences(before, contents()) and [*taken.iterdir()] == []


def test_cancelled_work_writes_nothing():
    """As Esc does it, between two frames and in the midst of one."""
    obj = bending_body()
    shapes = import_module(f"{MODULE}.bands.frame_shapes").read_frames(obj, FRAMES, lambda _: None)
    module = import_module(f"{MODULE}.bands.frame_filter")
    settings = import_module(f"{MODULE}.bands.bands").settings_as_taken(
        obj.data.spectral_tv.decompositions[0]
    )
    before = contents()
    job = module.start(shapes, settings, "FIRST")
    while job.progress < 0.4:
        assert not job.done
    job.cancel()
    with pytest.raises(spectral_tv.Cancelled):
        job.result()
    assert not differences(before, contents())


def test_the_cache_is_beside_the_blend_and_is_written_over_unless_it_is_read(tmp_path: Path):
    obj = bending_body()
    place = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(place))
    try:
        obj = bpy.data.objects["Body"]
        found = []
        for _ in range(2):
            bpy.context.view_layer.objects.active = obj
            obj.hide_set(False)
            found.append(_bake_beside())
        suffix = SUFFIXES[0]
        assert [path.name for path in sorted(tmp_path.glob(f"*{suffix}"))] == [
            f"scene_Body{suffix}",
            f"scene_Body_2{suffix}",
        ]
        bpy.data.batch_remove(found)
        bpy.data.batch_remove([*bpy.data.cache_files])
        bpy.context.view_layer.objects.active = obj
        obj.hide_set(False)
        _bake_beside()
        assert len([*tmp_path.glob(f"*{suffix}")]) == 2
    finally:
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


def _bake_beside() -> bpy.types.Object:
    ends = {"frame_start": FRAMES[0], "frame_end": FRAMES[-1]}
    assert bpy.ops.spectral_tv.bake_filter(**ends) == {"FINISHED"}
    return bpy.context.object
