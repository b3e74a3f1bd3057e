"""bpy.ops.spectral_tv.decompose on real objects."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import saved_and_loaded
from mathutils import Euler, Matrix
from spectral_tv.bands.methods import METHODS


def coordinates(data) -> np.ndarray:
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def bands(obj, prefix="Shape Detail") -> np.ndarray:
    """Displacements of the bands' shape keys, (K, V, 3)."""
    blocks = obj.data.shape_keys.key_blocks
    basis = coordinates(blocks[0].data)
    return np.array(
        [coordinates(key.data) - basis for key in blocks if key.name.startswith(f"{prefix} Band")]
    )


def evaluated(obj) -> np.ndarray:
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    return coordinates(obj.evaluated_get(graph).data.vertices)


@pytest.mark.parametrize("method", ["M1", "M2", "M3", "NAIVE", "HEAT"])
def test_adds_one_key_per_band_after_basis(monkey, method):
    before = coordinates(monkey.data.vertices)
    assert bpy.ops.spectral_tv.decompose(method=method, bands=4, steps=12) == {"FINISHED"}
    keys = monkey.data.shape_keys
    names = [key.name for key in keys.key_blocks]
    label = METHODS[method].label
    assert names == ["Basis", *(f"{label} Band {band}" for band in range(1, 5))]
    assert keys.use_relative
    for key in keys.key_blocks[1:]:
        assert key.relative_key == keys.key_blocks["Basis"]
        assert (key.slider_min, key.slider_max, key.value) == (-1, 2, 0)
    displacements = bands(monkey, label)
    assert all(np.abs(band).max() > 1e-4 for band in displacements)
    np.testing.assert_array_equal(coordinates(monkey.data.vertices), before)
    np.testing.assert_array_equal(evaluated(monkey), before)


def test_every_band_at_minus_one_is_the_residual(monkey):
    bpy.ops.spectral_tv.decompose(method="M1", bands=5, steps=16, keep_limbs=0, soft_edges=0)
    basis = coordinates(monkey.data.vertices)
    monkey.data.calc_loop_triangles()
    triangles = [list(triangle.vertices) for triangle in monkey.data.loop_triangles]
    split = spectral_tv.decompose(spectral_tv.Mesh(basis, triangles), "m1", steps=16)
    for key in monkey.data.shape_keys.key_blocks[1:]:
        key.value = -1
    np.testing.assert_allclose(evaluated(monkey), split.residual, atol=1e-5)
    for key in monkey.data.shape_keys.key_blocks[1:]:
        key.value = 2
    amplified = split.filter(np.full(15, 3.0))
    np.testing.assert_allclose(evaluated(monkey), amplified, atol=1e-5)


def test_flow_runs_in_world_scale_and_results_are_in_object_space(monkey):
    """A stretched object gives the bands of the stretched shape."""
    transform = Matrix.LocRotScale((5, -3, 2), Euler((0.3, 1.1, -0.4)), (2.0, 0.5, 1.0))
    monkey.matrix_world = transform
    bpy.context.view_layer.update()
    exact = {"bands": 3, "steps": 10, "keep_limbs": 0}
    bpy.ops.spectral_tv.decompose(**exact)
    scaled = bands(monkey) @ np.array(transform.to_3x3()).T

    applied = monkey.copy()
    applied.data = monkey.data.copy()
    bpy.context.collection.objects.link(applied)
    applied.shape_key_clear()
    applied.data.transform(transform)
    applied.matrix_world = Matrix.Identity(4)
    bpy.context.view_layer.objects.active = applied
    bpy.ops.spectral_tv.decompose(**exact)
    np.testing.assert_allclose(scaled, bands(applied), atol=1e-5)


def test_everything_else_stays(monkey):
    mesh = monkey.data
    monkey.vertex_groups.new(name="half").add(range(100), 0.5, "REPLACE")
    mesh.materials.append(bpy.data.materials.new("skin"))
    mesh.attributes.new("mark", "FLOAT", "POINT").data[7].value = 3.5
    monkey.modifiers.new("Bevel", "BEVEL")
    monkey.shape_key_add(name="Basis")
    smile = monkey.shape_key_add(name="Smile", from_mix=False)
    smile.data[3].co.x += 0.25
    smile.value = 0.75
    monkey.active_shape_key_index = 1
    monkey.show_only_shape_key = True
    uv = mesh.uv_layers.active.name
    basis = coordinates(mesh.shape_keys.key_blocks["Basis"].data)
    moved = coordinates(smile.data)

    bpy.ops.spectral_tv.decompose(bands=3, steps=8)

    keys = mesh.shape_keys.key_blocks
    expected = [
        "Basis",
        "Smile",
        "Shape Detail Band 1",
        "Shape Detail Band 2",
        "Shape Detail Band 3",
    ]
    assert [key.name for key in keys] == expected
    np.testing.assert_array_equal(coordinates(keys["Basis"].data), basis)
    np.testing.assert_array_equal(coordinates(keys["Smile"].data), moved)
    assert keys["Smile"].value == pytest.approx(0.75)
    assert monkey.active_shape_key_index == 1
    assert monkey.show_only_shape_key
    assert monkey.vertex_groups["half"].weight(5) == pytest.approx(0.5)
    assert mesh.materials[0].name == "skin"
    assert mesh.attributes["mark"].data[7].value == pytest.approx(3.5)
    assert mesh.uv_layers.active.name == uv
    assert [modifier.name for modifier in monkey.modifiers] == ["Bevel"]


def test_rigged_meshes_with_custom_normals_keep_both(monkey):
    mesh = monkey.data
    bpy.ops.object.armature_add()
    rig = bpy.context.object
    bone = rig.data.bones[0].name
    monkey.vertex_groups.new(name=bone).add(range(len(mesh.vertices)), 1.0, "REPLACE")
    monkey.modifiers.new("Armature", "ARMATURE").object = rig
    normals = np.tile([0.6, 0.0, 0.8], (len(mesh.vertices), 1))
    mesh.normals_split_custom_set_from_vertices(normals.tolist())
    for material in ("skin", "eyes"):
        mesh.materials.append(bpy.data.materials.new(material))
    mesh.polygons[3].material_index = 1
    rig.pose.bones[bone].location = (0, 0.5, 0)
    posed = evaluated(monkey)

    bpy.context.view_layer.objects.active = monkey
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)

    np.testing.assert_allclose(evaluated(monkey), posed, atol=1e-6)
    assert mesh.has_custom_normals
    assert mesh.corner_normals[0].vector.x == pytest.approx(0.6, abs=1e-2)
    assert mesh.polygons[3].material_index == 1
    mesh.shape_keys.key_blocks["Shape Detail Band 3"].value = 1
    offsets = evaluated(monkey) - posed
    np.testing.assert_allclose(offsets, bands(monkey)[2], atol=1e-5)


def test_again_adds_keys_of_their_own(monkey):
    bpy.ops.spectral_tv.decompose(method="M1", bands=2, steps=8)
    bpy.ops.spectral_tv.decompose(method="M2", bands=2, steps=8)
    bpy.ops.spectral_tv.decompose(method="M1", bands=2, steps=8)
    names = [key.name for key in monkey.data.shape_keys.key_blocks]
    assert len(names) == len(set(names)) == 7


def test_polygons_of_any_kind():
    bpy.ops.mesh.primitive_cylinder_add(vertices=24, end_fill_type="NGON")
    obj = bpy.context.object
    obj.data.vertices.add(2)  # in no face
    assert bpy.ops.spectral_tv.decompose(method="M3", bands=3, steps=8) == {"FINISHED"}
    displacements = bands(obj, "Edge-Keeping Detail")
    assert np.isfinite(displacements).all()
    np.testing.assert_array_equal(displacements[:, -2:], 0)


def test_shared_mesh_changes_for_every_user(monkey):
    twin = bpy.data.objects.new("Twin", monkey.data)
    bpy.context.collection.objects.link(twin)
    bpy.ops.spectral_tv.decompose(bands=2, steps=8)
    assert len(twin.data.shape_keys.key_blocks) == 3


def test_vertex_group_limits_the_bands(monkey):
    monkey.vertex_groups.new(name="Face").add(range(50), 1.0, "REPLACE")
    bpy.ops.spectral_tv.decompose(bands=2, steps=8, vertex_group="Face")
    keys = monkey.data.shape_keys.key_blocks[1:]
    assert all(key.vertex_group == "Face" for key in keys)
    bpy.ops.spectral_tv.cut(bands=3)
    assert all(key.vertex_group == "Face" for key in monkey.data.shape_keys.key_blocks[1:])
    with pytest.raises(RuntimeError, match="no vertex group 'Feet'"):
        bpy.ops.spectral_tv.decompose(vertex_group="Feet")


def refused(message, **arguments):
    count = len(bpy.data.shape_keys)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.spectral_tv.decompose(**arguments)
    assert len(bpy.data.shape_keys) == count


def test_refuses_what_has_no_surface():
    bpy.context.view_layer.objects.active = None
    refused("no active object")
    bpy.ops.curve.primitive_bezier_circle_add()
    refused("not a mesh")
    obj = bpy.data.objects.new("Empty", bpy.data.meshes.new("Empty"))
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    refused("no faces")


def test_refuses_edit_mode(monkey):
    bpy.ops.object.mode_set(mode="EDIT")
    refused("Leave Edit Mode")


def test_refuses_absolute_shape_keys(monkey):
    monkey.shape_key_add(name="Basis")
    monkey.data.shape_keys.use_relative = False
    refused("absolute shape keys")
    monkey.shape_key_clear()


def test_refuses_flat_scale_and_too_many_bands(monkey):
    monkey.scale.z = 0
    bpy.context.view_layer.update()
    refused("scale is zero")
    monkey.scale.z = 1
    bpy.context.view_layer.update()
    refused("8 bands need more than 8 steps", bands=8, steps=8)


def test_refuses_broken_coordinates_and_names_the_vertex(monkey):
    monkey.data.vertices[11].co.y = math.nan
    refused("vertex 11 has a coordinate")


def test_refuses_linked_meshes(monkey, tmp_path: Path):
    path = tmp_path / "library.blend"
    bpy.data.libraries.write(str(path), {monkey})
    name = monkey.name
    bpy.data.batch_remove([monkey])
    with bpy.data.libraries.load(str(path), link=True) as (_, target):
        target.objects = [name]
    linked = target.objects[0]
    bpy.context.collection.objects.link(linked)
    bpy.context.view_layer.objects.active = linked
    refused("linked from another file")


def test_survives_saving_and_loading(monkey, tmp_path: Path):
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    expected = bands(monkey)
    obj = saved_and_loaded(monkey, tmp_path / "saved.blend")
    np.testing.assert_array_equal(bands(obj), expected)
