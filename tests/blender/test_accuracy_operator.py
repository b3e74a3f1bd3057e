"""bpy.ops.spectral_tv.measure_accuracy: a table, attributes and a color attribute."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import object_of, saved_and_loaded
from shapes import grid

SCALARS = [
    "Shape Detail Error of Bands",
    "Shape Detail All-Pass Error",
    "Shape Detail Paper's Error of Bands",
    "Shape Detail Paper's All-Pass Error",
]


def values(obj, name) -> np.ndarray:
    data = obj.data.attributes[name].data
    flat = np.empty(len(data), dtype=np.float32)
    data.foreach_get("value", flat)
    return flat


def colors(obj) -> np.ndarray:
    data = obj.data.attributes["Shape Detail Error Color"].data
    flat = np.empty(4 * len(data), dtype=np.float32)
    data.foreach_get("color", flat)
    return flat.reshape(-1, 4)


@pytest.fixture
def sphere():
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    obj = bpy.context.object
    for vertex in obj.data.vertices:
        vertex.co *= 1 + 0.1 * np.sin(9 * vertex.co.x) * np.sin(7 * vertex.co.y)
    return obj


def measured(obj, steps, bands):
    obj.data.calc_loop_triangles()
    triangles = [list(triangle.vertices) for triangle in obj.data.loop_triangles]
    mesh = spectral_tv.Mesh([list(vertex.co) for vertex in obj.data.vertices], triangles)
    return spectral_tv.accuracy(mesh, "m1", steps, bands, keep_limbs=1, soft_edges=0.3)


def test_attributes_are_what_the_package_measures(sphere):
    before = [attribute.name for attribute in sphere.data.attributes]
    result = bpy.ops.spectral_tv.measure_accuracy(method="M1", bands=3, steps=16)
    assert result == {"FINISHED"}
    found = measured(sphere, [4, 8, 16], 3)
    new = [attribute.name for attribute in sphere.data.attributes if attribute.name not in before]
    assert new == [*SCALARS, "Shape Detail Error Color"]
    tables = found.bands, found.all_pass, found.paper_bands, found.paper_all_pass
    for name, table in zip(SCALARS, tables, strict=True):
        np.testing.assert_allclose(values(sphere, name), table[-1], atol=1e-7)
    assert sphere.data.shape_keys is None
    rows = list(csv.DictReader(io.StringIO(sphere.data.spectral_tv.accuracy.as_string())))
    assert [row["Steps"] for row in rows] == ["4", "8", "16"]
    for row, relative in zip(rows, found.relative, strict=True):
        read = [float(row[f"Band {band}"]) for band in (1, 2, 3)]
        np.testing.assert_allclose(read, 100 * relative, rtol=0.01)


def test_again_replaces_what_was_written_and_shows_another_error(sphere):
    bpy.ops.spectral_tv.measure_accuracy(bands=2, steps=8)
    names = [attribute.name for attribute in sphere.data.attributes]
    first, text = colors(sphere), sphere.data.spectral_tv.accuracy
    bpy.ops.spectral_tv.measure_accuracy(bands=2, steps=12, shown="PAPER_ALL_PASS")
    assert [attribute.name for attribute in sphere.data.attributes] == names
    assert sphere.data.spectral_tv.accuracy == text
    assert text.as_string().splitlines()[-1].startswith("12,")
    assert sphere.data.color_attributes.active_color.name == "Shape Detail Error Color"
    shown = colors(sphere)
    assert np.abs(shown - first).max() > 0.1
    # The warmer, the larger.
    error = values(sphere, SCALARS[3])
    assert shown[error.argmax(), 0] == shown[:, 0].max()
    assert shown[error.argmin(), 1] == shown[:, 1].min()
    np.testing.assert_array_equal(shown[:, 3], 1)


def test_what_was_measured_survives_saving(sphere, tmp_path: Path):
    bpy.ops.spectral_tv.measure_accuracy(bands=2, steps=8)
    kept, text = values(sphere, SCALARS[0]), sphere.data.spectral_tv.accuracy.as_string()
    obj = saved_and_loaded(sphere, tmp_path / "saved.blend")
    np.testing.assert_array_equal(values(obj, SCALARS[0]), kept)
    assert obj.data.spectral_tv.accuracy.as_string() == text


def test_it_says_why_it_cannot(sphere):
    for arguments, message in (
        ({"method": "LB"}, "takes no time steps"),
        ({"method": "DISPLACEMENT"}, "takes no time steps"),
        ({"bands": 8, "steps": 8}, "8 bands need more than 8 steps"),
        ({"use_scales": True, "finest": 10, "largest": 5}, "finest scale"),
    ):
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.spectral_tv.measure_accuracy(**arguments)
    assert sphere.data.spectral_tv.accuracy is None


def test_what_is_measured_is_what_the_bands_were_made_by():
    """Whatever the sidebar says now."""
    vertices, faces = grid(16, 16, 2.0, 2.0)
    vertices[:, 2] = 0.6 * (np.hypot(*(vertices[:, :2] - 1).T) < 0.5)
    obj = object_of("Relief", vertices, faces)
    with pytest.raises(RuntimeError, match="it has no bands"):
        bpy.ops.spectral_tv.measure_accuracy(of_bands=True)
    obj.vertex_groups.new(name="Some").add([1, 2], 1, "REPLACE")
    choices = {"finest": 3, "largest": 15, "base": "FLAT", "metric": "BASE", "method": "M3"}
    bpy.ops.spectral_tv.decompose(bands=3, steps=8, use_scales=True, vertex_group="Some", **choices)
    obj.vertex_groups.clear()
    assert bpy.ops.spectral_tv.measure_accuracy(of_bands=True) == {"FINISHED"}
    corners = vertices.astype(np.float32).astype(float)
    relief = spectral_tv.Mesh(corners, faces)
    scales = 0.03**2 * relief.area, 0.15**2 * relief.area
    along_base, along_surface = (
        spectral_tv.accuracy(
            relief,
            "m3",
            [2, 4, 8],
            3,
            scales=scales,
            base=corners * [1, 1, 0],
            metric=metric,
            displacement="vector",
        ).bands[-1]
        for metric in ("base", "surface")
    )
    np.testing.assert_allclose(
        values(obj, "Edge-Keeping Detail Error of Bands"), along_base, atol=5e-4
    )
    assert np.abs(along_base - along_surface).max() > 0.01
    rows = csv.DictReader(io.StringIO(obj.data.spectral_tv.accuracy.as_string()))
    assert [row["Steps"] for row in rows] == ["2", "4", "8"]


def test_bands_by_an_accuracy_are_measured_at_the_steps_that_were_taken(sphere):
    bpy.ops.spectral_tv.decompose(method="M2", bands=2, use_accuracy=True, accuracy=40)
    steps = len(sphere.data.spectral_tv.decompositions[-1].kept_spectrum) + 1
    bpy.ops.spectral_tv.measure_accuracy(of_bands=True)
    rows = [*csv.DictReader(io.StringIO(sphere.data.spectral_tv.accuracy.as_string()))]
    assert rows[-1]["Steps"] == str(steps)
    assert "Band 2" in rows[0] and "Band 3" not in rows[0]
    assert "Limbs and Head Error of Bands" in sphere.data.attributes
