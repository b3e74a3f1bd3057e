"""bpy.ops.spectral_tv.take_bands between meshes of other vertices."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import object_of
from mathutils import Euler, Matrix
from nearby import body, distances

OPS = bpy.ops.spectral_tv


def world_shape(obj: bpy.types.Object) -> np.ndarray:
    """Where the vertices are seen in the world."""
    bpy.context.view_layer.update()
    seen = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.array([vertex.co for vertex in seen.data.vertices])
    matrix = np.array(obj.matrix_world)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def offsets(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> np.ndarray:
    """By how much a key moves each vertex, in object space."""
    basis = obj.data.shape_keys.key_blocks[0]
    return np.array([a.co - b.co for a, b in zip(key.data, basis.data, strict=True)])


def triangles(obj: bpy.types.Object) -> np.ndarray:
    return np.array([polygon.vertices for polygon in obj.data.polygons])


def placed(name: str, shape: tuple, matrix: Matrix) -> bpy.types.Object:
    """An object whose vertices are at places of the world, whatever its matrix is."""
    vertices, faces = shape
    back = np.array(matrix.inverted())
    obj = object_of(name, vertices @ back[:3, :3].T + back[:3, 3], faces)
    obj.matrix_world = matrix
    return obj


@pytest.fixture
def scan():
    turn = Euler((0.4, 1.2, -0.3)).to_matrix().to_4x4()
    obj = placed(
        "Scan", body(120, 60), Matrix.Translation((3, 1, -2)) @ turn @ Matrix.Scale(0.5, 4)
    )
    bpy.context.view_layer.update()
    OPS.decompose(bands=4, steps=10)
    return obj


def retopology(**options) -> bpy.types.Object:
    turn = Euler((-1, 0.1, 2)).to_matrix().to_4x4()
    shape = body(40, 20, twist=0.1, **options)
    return placed("Retopology", shape, Matrix.Translation((-1, 0, 4)) @ turn @ Matrix.Scale(2, 4))


def select(source: bpy.types.Object, target: bpy.types.Object) -> None:
    for obj in bpy.context.scene.objects:
        obj.select_set(obj in (source, target))
    bpy.context.view_layer.objects.active = target


def test_a_retopology_gets_the_look_of_its_scan(scan):
    target = retopology()
    modifier = target.modifiers.new("Shrinkwrap", "SHRINKWRAP")
    modifier.target = scan
    bpy.ops.object.modifier_apply(modifier="Shrinkwrap")
    values, rest = [0.5, 1, -1, 0.75], world_shape(scan)
    keys = scan.data.shape_keys.key_blocks[1:]
    for key, value in zip(keys, values, strict=True):
        key.value = value
    select(scan, target)
    assert OPS.take_bands(first=1, last=9) == {"FINISHED"}
    taken = target.data.shape_keys.key_blocks[1:]
    assert [key.name for key in taken] == [key.name for key in keys]
    assert [key.value for key in taken] == values
    moved = world_shape(scan) - rest
    amplitude = np.sqrt((moved**2).sum(axis=1).mean())
    away = distances(world_shape(target), world_shape(scan), triangles(scan))
    assert away.mean() < 0.02 * amplitude
    own, other = (obj.data.spectral_tv.decompositions[0] for obj in (target, scan))
    assert (own.name, own.method) == (other.name, other.method)
    np.testing.assert_allclose(
        [(band.start, band.end) for band in own.bands],
        [(band.start, band.end) for band in other.bands],
        rtol=1e-5,
    )
    # The panel's operators work on them.
    assert OPS.filter(preset="RESET") == {"FINISHED"}
    assert [key.value for key in taken] == [0, 0, 0, 0]
    assert OPS.solo(band=2) == {"FINISHED"}
    assert [key.mute for key in taken] == [True, False, True, True]
    with pytest.raises(RuntimeError, match="no longer in memory"):
        OPS.cut(bands=3)


def test_masks_come_along(scan):
    upper = [vertex.index for vertex in scan.data.vertices if (scan.matrix_world @ vertex.co).z > 0]
    scan.vertex_groups.new(name="Upper").add(upper, 1, "REPLACE")
    OPS.choose_mask(band=2, group="Upper")
    target = retopology()
    select(scan, target)
    OPS.take_bands(first=2, last=3)
    second, third = target.data.shape_keys.key_blocks[1:]
    assert third.vertex_group == ""
    group = target.vertex_groups[second.vertex_group]
    for vertex in target.data.vertices:
        height = (target.matrix_world @ vertex.co).z
        if abs(height) > 0.06:
            weight = next((g.weight for g in vertex.groups if g.group == group.index), 0)
            assert weight == pytest.approx(float(height > 0), abs=1e-4)


def test_bands_that_are_attributes_are_taken_as_such(scan):
    OPS.convert_bands(to="ATTRIBUTES")
    target = retopology()
    select(scan, target)
    OPS.take_bands(first=1, last=9)
    assert target.data.shape_keys is None
    assert target.data.spectral_tv.decompositions[0].kept == "ATTRIBUTES"


def test_bands_of_another_sculpt_take_the_place_of_its_own(scan):
    target = retopology(bumps=0.0)
    OPS.decompose(bands=4, steps=10)
    select(scan, target)
    for _ in range(2):  # again in the place of the first
        OPS.take_bands(first=2, last=3)
        keys = target.data.shape_keys.key_blocks[1:]
        assert [key.value for key in keys] == [0, -1, -1, 0, 1, 1]
        assert [key.name for key in keys[4:]] == [
            "Scan Shape Detail Band 2", "Scan Shape Detail Band 3"
        ]  # fmt: skip
    OPS.take_bands(first=1, last=4, into="ADD")
    assert len(target.data.spectral_tv.decompositions) == 2
    assert target.data.spectral_tv.active_decomposition == 1


def test_what_is_missed_is_selected_and_told(scan, capfd):
    vertices, faces = body(40, 20, twist=0.1)
    far = vertices[:, 0] > 0.5
    vertices[far] += [1, 0, 0]
    target = placed("Pulled", (vertices, faces), Matrix())
    select(scan, target)
    OPS.take_bands(first=1, last=4)
    selected = np.array([vertex.select for vertex in target.data.vertices])
    assert selected[far].mean() > 0.95 and not selected[~far].any()
    assert f"{selected.sum()} vertices are missed, as Scan is farther" in capfd.readouterr().out
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.object.mode_set(mode="OBJECT")
    np.testing.assert_array_equal([vertex.select for vertex in target.data.vertices], selected)
    moved = np.zeros(len(vertices))
    for key in target.data.shape_keys.key_blocks[1:]:
        moved += np.linalg.norm(offsets(target, key), axis=1)
    assert moved[~far].mean() > 10 * moved[vertices[:, 0] > 2].mean()


def test_what_lies_elsewhere_is_refused_or_fitted(scan, capfd):
    vertices, faces = body(40, 20, twist=0.1)
    turn = Euler((0.3, 2.5, 0.7)).to_matrix().to_4x4()
    target = object_of("Elsewhere", 3 * vertices, faces)
    target.matrix_world = Matrix.Translation((20, 0, 5)) @ turn
    select(scan, target)
    with pytest.raises(RuntimeError, match=r"Scan is nowhere within .*, or have it fitted first"):
        OPS.take_bands(first=1, last=4)
    assert target.data.shape_keys is None
    capfd.readouterr()
    OPS.take_bands(first=1, last=4, fit="similar")
    said = capfd.readouterr().out
    assert "scaled by 3" in said or "scaled by 2.99" in said
    largest, like = (obj.data.spectral_tv.decompositions[0].bands[3] for obj in (target, scan))
    assert largest.end == pytest.approx(9 * like.end, rel=0.02)
    sizes = []
    for obj in (target, scan):
        key = obj.data.shape_keys.key_blocks[4]
        length = np.sqrt((offsets(obj, key) ** 2).sum(axis=1).mean())
        sizes.append(obj.matrix_world.median_scale * length)
    assert sizes[0] == pytest.approx(3 * sizes[1], rel=0.1)


def test_bands_finer_than_the_faces_are_told(scan, capfd):
    target = placed("Coarse", body(14, 8), Matrix())
    select(scan, target)
    OPS.take_bands(first=1, last=4)
    assert " finer than the faces of Coarse, whose edges are" in capfd.readouterr().out


def test_bands_come_onto_the_same_vertices_as_a_decomposition(scan):
    twin = scan.copy()
    twin.data = scan.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    twin.shape_key_clear()
    select(scan, twin)
    OPS.take_bands(first=1, last=4)
    for name in [f"Shape Detail Band {band}" for band in (1, 2, 3, 4)]:
        own, other = (offsets(obj, obj.data.shape_keys.key_blocks[name]) for obj in (twin, scan))
        np.testing.assert_allclose(own, other, atol=1e-5)
