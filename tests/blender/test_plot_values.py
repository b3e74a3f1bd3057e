"""bpy.ops.spectral_tv.plot_values and export_values."""

from __future__ import annotations

import csv

import bpy
import numpy as np
import pytest
from ball import object_of
from shapes import icosphere

VERTICES, FACES = icosphere(4)
plot = bpy.ops.spectral_tv.plot_values


@pytest.fixture
def sphere():
    """A unit sphere with the groups Cap, and Rest for all others."""
    obj = object_of("Sphere", VERTICES, FACES)
    cap = VERTICES[:, 2] > np.cos(1.0)
    for name, members in (("Cap", cap), ("Rest", ~cap)):
        obj.vertex_groups.new(name=name).add(np.flatnonzero(members).tolist(), 1, "REPLACE")
    yield obj
    bpy.data.batch_remove([*bpy.data.texts, *bpy.data.images])


def rows(text: str) -> tuple[list[str], np.ndarray]:
    names, *values = csv.reader(text.splitlines())
    return names, np.array(values, dtype=float)


def test_a_cap_falls_and_the_rest_rises_in_straight_lines(sphere):
    """At the rates per/area of each, until both are at the mean."""
    bpy.ops.spectral_tv.flow_attribute(kind="GROUP", source="Cap")  # Cap Flow gets no curve
    plot(kind="GROUP", source="Cap", size=80, steps=40)
    names, table = rows(sphere.data.spectral_tv.table.as_string())
    assert names == ["time", "Cap", "Rest"]
    time, cap, rest = table.T
    assert time[0] == 0 and len(time) == 41
    area, perimeter = 2 * np.pi * (1 - np.cos(1.0)), 2 * np.pi * np.sin(1.0)
    mean = area / (4 * np.pi)
    alive = cap - rest > 0.1
    assert np.polyfit(time[alive], cap[alive], 1)[0] == pytest.approx(-perimeter / area, rel=0.06)
    slope = np.polyfit(time[alive], rest[alive], 1)[0]
    assert slope == pytest.approx(perimeter / (4 * np.pi - area), rel=0.06)
    np.testing.assert_allclose([cap[-1], rest[-1]], mean, atol=0.01)
    assert [group.name for group in sphere.vertex_groups] == ["Cap", "Rest", "Cap Flow"]


def test_the_picture_shows_every_curve(sphere):
    for size in (20, 80):  # the second time replaces
        plot(kind="GROUP", source="Cap", size=size, steps=20)
    assert [image.name for image in bpy.data.images] == ["Cap Values"]
    assert [text.name for text in bpy.data.texts] == ["Cap Values.csv"]
    image = sphere.data.spectral_tv.picture
    assert image.packed_file is not None
    pixels = np.empty(4 * image.size[0] * image.size[1], dtype=np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(image.size[1], image.size[0], 4)[..., :3]
    colored = np.ptp(pixels, axis=2) > 0.2
    plot_area = colored[51:-24, 160:700]  # left of the legend
    # Falling and rising, so that they are far apart on the left and together on the right.
    heights = [np.flatnonzero(plot_area[:, x]) for x in (0, -1)]
    assert np.ptp(heights[0]) > 0.8 * len(plot_area) and np.ptp(heights[1]) < 10


def test_the_small_picture_of_the_sidebar_has_colored_curves(sphere):
    """As wide as they have to be, so that they do not turn grey in it."""
    plot(kind="GROUP", source="Cap", size=80, steps=20)
    preview = sphere.data.spectral_tv.picture.preview
    width, height = preview.image_size
    assert width < 300
    pixels = np.array(preview.image_pixels_float).reshape(height, width, 4)[..., :3]
    shown = np.ptp(pixels[15:-8, 45 : width // 2], axis=2) > 0.3
    assert (shown.sum(axis=0) >= 4).all()  # two curves, of two pixels or more


def test_vertices_and_channels_have_columns(sphere, tmp_path):
    wind = sphere.data.attributes.new("Wind", "FLOAT_VECTOR", "POINT")
    wind.data.foreach_set("vector", VERTICES.astype(np.float32).ravel())
    sphere.data.vertices.foreach_set("select", np.isin(np.arange(len(VERTICES)), (3, 70)))
    path = tmp_path / "wind.csv"
    plot(source="Wind", parts="VERTICES", size=5, steps=4, filepath=str(path))
    names, table = rows(path.read_text(encoding="utf-8"))
    assert names == ["time", *(f"Vertex {v} {axis}" for v in (3, 70) for axis in "XYZ")]
    np.testing.assert_allclose(table[0, 1:], VERTICES[[3, 70]].ravel(), atol=1e-6)


def test_export_writes_the_table(sphere, tmp_path):
    assert not bpy.ops.spectral_tv.export_values.poll()
    plot(kind="GROUP", source="Cap", groups="Rest", steps=4)
    path = tmp_path / "cap.csv"
    assert bpy.ops.spectral_tv.export_values(filepath=str(path)) == {"FINISHED"}
    names, table = rows(path.read_text(encoding="utf-8"))
    assert names == ["time", "Rest"] and len(table) == 5
    with pytest.raises(RuntimeError, match="cannot be written"):
        bpy.ops.spectral_tv.export_values(filepath=str(tmp_path / "no" / "cap.csv"))


def test_refusals(sphere):
    sphere.vertex_groups.new(name="Empty")
    sphere.data.vertices.foreach_set("select", np.zeros(len(VERTICES), dtype=bool))
    for options, message in (
        ({"groups": "Cap, Nothing"}, "no vertex group 'Nothing'"),
        ({"groups": "Empty"}, "'Empty' is empty"),
        ({"parts": "VERTICES"}, "select 1 to 16 vertices, not 0"),
    ):
        with pytest.raises(RuntimeError, match=message):
            plot(kind="GROUP", source="Cap", **options)
    assert sphere.data.spectral_tv.table is None
