"""bpy.ops.spectral_tv.cosegment on several poses."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from shapes import dumbbell


@pytest.fixture
def poses():
    """A dumbbell, straight and leaning."""
    vertices, faces = dumbbell(neck_radius=0.3, neck_length=1.5, n_around=24, n_along=60)
    objects = []
    for lean in (0, 0.4):
        mesh = bpy.data.meshes.new("Pose")
        shape = vertices + lean * np.clip(vertices[:, 2:], -0.5, 0.5) * [1, 0, 0]
        mesh.from_pydata(shape.tolist(), [], faces.tolist())
        objects.append(bpy.data.objects.new("Pose", mesh))
        bpy.context.scene.collection.objects.link(objects[-1])
        objects[-1].select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
    return objects


def groups(obj) -> np.ndarray:
    """The number of every vertex's only group."""
    return np.array([[each.group for each in vertex.groups] for vertex in obj.data.vertices])[:, 0]


def colors(obj) -> np.ndarray:
    flat = np.empty(4 * len(obj.data.vertices), dtype=np.float32)
    obj.data.color_attributes["Segment"].data.foreach_get("color", flat)
    return flat.reshape(-1, 4)


def test_poses_get_the_same_parts_in_the_same_colors(poses):
    assert bpy.ops.spectral_tv.cosegment(segments=3, steps=24) == {"FINISHED"}
    first, second = poses
    assert [group.name for group in first.vertex_groups] == [f"Segment {n}" for n in (1, 2, 3)]
    assert (groups(first) == groups(second)).mean() > 0.9
    same = groups(first) == groups(second)
    np.testing.assert_array_equal(colors(first)[same], colors(second)[same])
    assert len(np.unique(colors(first), axis=0)) == 3
    assert first.data.shape_keys is None


def test_face_sets_and_segmenting_again(poses):
    obj = poses[0]
    obj.vertex_groups.new(name="Mine").add([0], 1.0, "REPLACE")
    outputs = {"GROUPS", "FACE_SETS"}
    for count in (4, 2):
        bpy.ops.spectral_tv.cosegment(segments=count, steps=12, outputs=outputs)
    assert [group.name for group in obj.vertex_groups] == ["Mine", "Segment 1", "Segment 2"]
    values = np.empty(len(obj.data.polygons), dtype=np.int32)
    obj.data.attributes[".sculpt_face_set"].data.foreach_get("value", values)
    assert set(values) == {1, 2}
    labels = np.array([max(each.group for each in v.groups) for v in obj.data.vertices]) - 1
    for polygon, value in zip(obj.data.polygons, values, strict=True):
        assert value == max(labels[list(polygon.vertices)]) + 1
    assert "Segment" not in obj.data.color_attributes


def test_a_mesh_that_cannot_be_used_is_named(poses):
    mesh = bpy.data.meshes.new("Empty")
    empty = bpy.data.objects.new("Bare", mesh)
    bpy.context.scene.collection.objects.link(empty)
    empty.select_set(True)
    with pytest.raises(RuntimeError, match="Bare: The mesh has no faces"):
        bpy.ops.spectral_tv.cosegment()
    assert not poses[0].vertex_groups
