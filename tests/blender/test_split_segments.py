"""bpy.ops.spectral_tv.split_segments: the connected parts of segments, as vertex groups."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
from ball import object_of
from conftest import MODULE
from masked_ball import SMALL, mask, weights
from shapes import dumbbell

OPS = bpy.ops.spectral_tv
ENDS, NECK = "Segment 1", "Segment 2"
PARTS = [f"{ENDS} Part 1", f"{ENDS} Part 2"]


def segmented(name: str, vertices: np.ndarray, faces: np.ndarray) -> bpy.types.Object:
    """A dumbbell, both ends of which are one segment, and the neck another."""
    obj = object_of(name, vertices, faces)
    obj.select_set(True)
    labels = (np.abs(vertices[:, 2] + 0.01) < 0.4).astype(int)
    import_module(f"{MODULE}.segmentation.segments").write(obj, labels, 2, {"GROUPS"})
    return obj


@pytest.fixture
def shape():
    return dumbbell(neck_radius=0.3, neck_length=1.5, n_around=24, n_along=60)


@pytest.fixture
def bar(shape):
    return segmented("Bar", *shape)


def groups(obj) -> list[str]:
    return obj.vertex_groups.keys()


def heights(obj) -> np.ndarray:
    return np.array([vertex.co.z for vertex in obj.data.vertices])


def test_both_ends_become_parts_the_larger_one_first(bar):
    before = {name: weights(bar, name) for name in groups(bar)}
    assert OPS.split_segments() == {"FINISHED"}
    assert groups(bar) == [ENDS, NECK, *PARTS]  # the neck is one part
    np.testing.assert_array_equal(weights(bar, PARTS[0]), heights(bar) >= 0.39)
    np.testing.assert_array_equal(weights(bar, PARTS[1]), heights(bar) <= -0.41)
    for name, found in before.items():
        np.testing.assert_array_equal(weights(bar, name), found)


def test_parts_that_are_too_small_belong_to_their_neighbors(bar, shape, capfd):
    """Specks of the neck at the tips of the ends; a chain of them goes to the end at once."""
    vertices, faces = shape
    labels = (np.abs(vertices[:, 2] + 0.01) < 0.4).astype(int)
    tip = int(vertices[:, 2].argmax())
    around = np.unique(faces[(faces == tip).any(axis=1)])
    labels[around], labels[tip] = 1, 0
    segments = import_module(f"{MODULE}.segmentation.segments")
    segments.write(bar, labels, 2, {"GROUPS"})
    OPS.split_segments(least=2)
    assert "2 parts were too small, and belong to their neighbors now" in capfd.readouterr().out
    np.testing.assert_array_equal(weights(bar, PARTS[0]), heights(bar) >= 0.39)
    OPS.split_segments(least=0)
    assert f"{ENDS} Part 3" in groups(bar) and f"{NECK} Part 2" in groups(bar)
    assert weights(bar, f"{ENDS} Part 3").sum() == 1
    OPS.split_segments(least=2)
    assert groups(bar) == [ENDS, NECK, *PARTS]


def test_seams_connect(shape):
    """Triangles that share no vertices, but places."""
    vertices, faces = shape
    apart = segmented("Apart", vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))
    OPS.split_segments()
    assert groups(apart) == [ENDS, NECK, *PARTS]


def test_all_selected_meshes_are_split_and_errors_name_one(bar, shape, capfd):
    other = segmented("Other", *shape)
    assert OPS.split_segments() == {"FINISHED"}
    assert "4 connected parts in 2 meshes" in capfd.readouterr().out
    assert {*PARTS} <= {*groups(bar)} & {*groups(other)}
    before = groups(bar), groups(other)
    bare = object_of("Bare", *shape)
    bare.select_set(True)
    with pytest.raises(RuntimeError, match="Bare: it has no segments as vertex groups"):
        OPS.split_segments()
    assert (groups(bar), groups(other)) == before


def test_a_part_that_you_changed_stays_and_another_one_is_written(bar, capfd):
    OPS.split_segments()
    bar.vertex_groups[PARTS[0]].remove([0, 1, 2, 3])
    bar.vertex_groups[PARTS[0]].add([700], 0.5, "REPLACE")
    changed = weights(bar, PARTS[0])
    OPS.split_segments()
    assert f"the vertex group '{PARTS[0]}' was changed since, and is kept" in capfd.readouterr().out
    np.testing.assert_array_equal(weights(bar, PARTS[0]), changed)
    np.testing.assert_array_equal(weights(bar, f"{PARTS[0]}.001"), heights(bar) >= 0.39)


def test_a_part_becomes_a_mask_that_segmenting_again_leaves(bar):
    OPS.decompose(**SMALL)
    OPS.split_segments()
    OPS.fill_mask(band=2, source="GROUP", group=PARTS[0])
    OPS.fill_mask(band=2, source="GROUP", group=PARTS[1], combine="ADD")
    both = np.abs(heights(bar) + 0.01) >= 0.4
    np.testing.assert_array_equal(mask(bar), both)
    OPS.cosegment(segments=3, steps=8)
    OPS.split_segments()
    np.testing.assert_array_equal(mask(bar), both)
