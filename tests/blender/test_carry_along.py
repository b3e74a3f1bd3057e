"""bpy.ops.spectral_tv.carry_along: a dressed body, whose sliders move all."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import object_of
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree
from nearby import body

OPS = bpy.ops.spectral_tv


def seen(obj: bpy.types.Object) -> np.ndarray:
    """Where the vertices are in the world, by keys and modifiers."""
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    matrix = np.array(obj.matrix_world)
    points = np.array([vertex.co for vertex in mesh.vertices])
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def inside(points: np.ndarray, obj: bpy.types.Object) -> np.ndarray:
    """Which points the surface of an object goes around: rays leave it an odd number of times."""
    faces = [polygon.vertices[:] for polygon in obj.data.polygons]
    tree = BVHTree.FromPolygons(seen(obj).tolist(), faces, epsilon=0.0)
    found = []
    for point in points:
        count, origin = 0, Vector(point)
        while (hit := tree.ray_cast(origin, Vector((0.31, 0.21, 0.93))))[0] is not None:
            count, origin = count + 1, hit[0] + 1e-5 * Vector((0.31, 0.21, 0.93))
        found.append(count % 2 == 1)
    return np.array(found)


@pytest.fixture
def dressed():
    """A body with bands and a mask, a tight shirt on it, and a tooth in it; the body is active."""
    vertices, faces = body(60, 30)
    shirt_vertices, shirt_faces = body(32, 16, twist=0.1)
    shirt = object_of("Shirt", shirt_vertices, shirt_faces)
    normals = np.array([vertex.normal for vertex in shirt.data.vertices])
    shirt.data.vertices.foreach_set("co", (shirt_vertices + 0.012 * normals).astype("f").ravel())
    shirt.matrix_world = Matrix.Translation((1, 2, 3))
    tooth = object_of("Tooth", 0.02 * np.eye(3) + [1.1, 0, 0], [(0, 1, 2)])
    tooth.matrix_world = Matrix.Translation((1, 2, 3))
    obj = object_of("Body", vertices / 2, faces)
    obj.matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Scale(2, 4)
    for each in (shirt, tooth, obj):
        each.select_set(True)
    bpy.context.view_layer.update()
    OPS.decompose(bands=4, steps=10)
    return obj, shirt, tooth


def test_one_slider_moves_all_and_no_vertex_of_the_shirt_goes_inside(dressed):
    obj, shirt, tooth = dressed
    outside = ~inside(seen(shirt), obj)
    assert outside.sum() > 300
    bare, teeth = seen(shirt), seen(tooth)
    assert OPS.carry_along() == {"FINISHED"}
    np.testing.assert_allclose(seen(shirt), bare, atol=1e-6)
    keys = obj.data.shape_keys.key_blocks[1:]
    assert shirt.data.shape_keys.key_blocks.keys()[1:] == [key.name for key in keys]
    rng = np.random.default_rng(3)
    without = 0
    for gains in [*np.eye(4), np.ones(4), 0.5 * np.ones(4), *rng.uniform(0, 1, (3, 4))]:
        for key, gain in zip(keys, gains, strict=True):
            key.value = gain
        assert not inside(seen(shirt)[outside], obj).any(), gains
        without += inside(bare[outside], obj).sum()
    assert without > 20
    assert np.linalg.norm(seen(tooth) - teeth, axis=1).min() > 0.001
    for key in keys:
        key.mute = True
    np.testing.assert_allclose(seen(shirt), bare, atol=1e-6)


def test_again_it_takes_the_place_of_before(dressed):
    obj, shirt, _ = dressed
    OPS.carry_along()
    key = obj.data.shape_keys.key_blocks[4]
    key.value = 1
    before = seen(shirt)
    OPS.carry_along()
    assert len(shirt.data.shape_keys.key_blocks) == 5
    np.testing.assert_allclose(seen(shirt), before, atol=1e-5)
    key.name = "Large"
    driver = shirt.data.shape_keys.animation_data.drivers[3].driver
    assert 'key_blocks["Large"]' in driver.variables[0].targets[0].data_path


def test_bands_that_are_attributes_drive_it_too(dressed):
    _, shirt, _ = dressed
    OPS.convert_bands(to="ATTRIBUTES")
    OPS.carry_along()
    before = seen(shirt)
    OPS.filter(preset="EXAGGERATE", first=4, last=4, amount=1)
    assert np.linalg.norm(seen(shirt) - before, axis=1).max() > 0.01


def test_what_cannot_follow_is_told(dressed, capfd):
    obj, shirt, tooth = dressed
    bpy.ops.object.empty_add()
    bpy.context.view_layer.objects.active = obj
    with pytest.raises(RuntimeError, match="select the meshes that follow it"):
        shirt.select_set(False)
        tooth.select_set(False)
        OPS.carry_along()
    shirt.select_set(True)
    OPS.carry_along()
    assert "these do not follow: Empty" in capfd.readouterr().out
    assert tooth.data.shape_keys is None
