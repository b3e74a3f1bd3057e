"""Segments leave the user's groups, colors and face sets alone."""

from __future__ import annotations

import bpy
import kinds_of_results
import numpy as np
from kinds_of_results import FACES, Group, told

sphere = kinds_of_results.sphere


def face_sets(obj, name=".sculpt_face_set") -> np.ndarray:
    values = np.empty(len(obj.data.polygons), dtype=np.int32)
    obj.data.attributes[name].data.foreach_get("value", values)
    return values


def test_segments_leave_own_groups_and_colors_alone(sphere):
    sphere.select_set(True)
    for name in ("Segment 2", "Segment 11"):
        Group.new(sphere, name)
    sphere.data.color_attributes.new("Segment", "BYTE_COLOR", "CORNER")
    own = [Group.values(sphere, name) for name in ("Segment 2", "Segment 11")]
    for segments in (3, 2):
        bpy.ops.spectral_tv.cosegment(segments=segments, steps=8)
    assert [Group.values(sphere, name) for name in ("Segment 2", "Segment 11")] == own
    assert [group.name for group in sphere.vertex_groups] == [
        "Cap", "Segment 2", "Segment 11", "Segment 1", "Segment 2.001",
    ]  # fmt: skip
    assert sphere.data.color_attributes["Segment"].domain == "CORNER"
    assert sphere.data.color_attributes.active_color.name == "Segment.001"


def test_own_face_sets_are_kept_as_an_attribute(sphere, capfd):
    sphere.select_set(True)
    own = np.arange(len(FACES), dtype=np.int32) % 12
    sphere.data.attributes.new(".sculpt_face_set", "INT", "FACE").data.foreach_set("value", own)
    for segments in (3, 2):
        bpy.ops.spectral_tv.cosegment(segments=segments, steps=8, outputs={"FACE_SETS"})
    assert set(face_sets(sphere)) == {1, 2}
    np.testing.assert_array_equal(face_sets(sphere, "Face Sets"), own)
    assert told(capfd).count("12 face sets were replaced; the attribute 'Face Sets' keeps") == 1
    assert "Face Sets.001" not in sphere.data.attributes
