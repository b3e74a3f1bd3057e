"""bpy.ops.spectral_tv.blur_mask: the heat flow of weights."""

from __future__ import annotations

from math import erf

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import ball, object_of
from deform_scene import evaluated
from masked_ball import BANDS, MASKS, SMALL, heights, keys, mask, own, paint, select

OPS = bpy.ops.spectral_tv


@pytest.fixture
def sheet():
    """A square of 2 × 2 with bumps, its first band masked where x > 0."""
    steps = 41
    along = np.linspace(-1, 1, steps)
    x, y = (each.ravel() for each in np.meshgrid(along, along))
    places = np.arange(steps**2).reshape(steps, steps)
    corners = places[:-1, :-1], places[:-1, 1:], places[1:, 1:], places[1:, :-1]
    obj = object_of(
        "Sheet",
        np.column_stack([x, y, 0.001 * np.sin(9 * x) * np.sin(9 * y)]),
        np.stack(corners, axis=-1).reshape(-1, 4),
    )
    obj.select_set(True)
    OPS.decompose(**SMALL, keep_limbs=0)
    select(obj, x > 0)
    OPS.fill_mask(band=1)
    return obj


@pytest.mark.parametrize("scale", [1, 100])
def test_a_straight_border_becomes_the_error_function(sheet, scale):
    """As heat does in the plane; the radius is relative to the size, √4 = 2 here."""
    sheet.scale = 3 * [scale]
    bpy.context.view_layer.update()
    radius = 0.2
    assert OPS.blur_mask(band=1, radius=100 * radius / 2) == {"FINISHED"}
    x = np.array([vertex.co.x for vertex in sheet.data.vertices])
    # Between the vertices at 0 and at 0.05.
    expected = np.array([(1 + erf((each - 0.025) / radius)) / 2 for each in x])
    np.testing.assert_allclose(mask(sheet, 1), expected, atol=0.02)
    assert abs(mask(sheet, 1)[np.isclose(x, -0.2 + 0.05)] - 0.08).max() < 0.03
    assert sheet.vertex_groups.keys() == [MASKS[0]] == own(sheet)


def test_it_is_the_flow_of_the_package_on_what_is_seen(sheet):
    keys(sheet)[BANDS[0]].value = -1
    vertices = evaluated(sheet)
    before = mask(sheet, 1)
    assert OPS.blur_mask(band=1, radius=5) == {"FINISHED"}
    faces = np.array([each.vertices for each in sheet.data.loop_triangles])
    mesh = spectral_tv.Mesh(vertices, faces)
    time = (0.05**2 * mesh.area) / 4
    flow = spectral_tv.flow(mesh, before, np.linspace(0, time, 5), "heat")
    np.testing.assert_allclose(mask(sheet, 1), np.ravel(flow.states[-1]), atol=1e-5)


def test_seams_do_not_stop_it():
    """Two halves whose vertices are apart, but at the same places."""
    obj = ball("Ball")
    vertices = np.array([vertex.co for vertex in obj.data.vertices])
    faces = np.array([face.vertices for face in obj.data.polygons])
    apart = object_of("Apart", vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))
    bpy.ops.object.select_all(action="DESELECT")
    apart.select_set(True)
    for each in (obj, apart):
        bpy.context.view_layer.objects.active = each
        OPS.decompose(**SMALL)
        select(each, heights(each) > 0)
        OPS.fill_mask(band=2)
        OPS.blur_mask(band=2, radius=10)
    np.testing.assert_allclose(mask(apart), mask(obj)[faces].ravel(), atol=1e-4)


def test_a_group_of_yours_is_copied_first_and_nothing_to_blur_is_refused(sheet, capfd):
    sheet.vertex_groups.new(name="Mine").add(range(800), 0.5, "REPLACE")
    OPS.choose_mask(band=2, group="Mine")
    OPS.blur_mask(band=2)
    assert "'Mine' stays as it was" in capfd.readouterr().out
    assert keys(sheet)[BANDS[1]].vertex_group == MASKS[1]
    OPS.paint_mask(band=3, weight=0.5)
    with pytest.raises(RuntimeError, match=rf"the mask of '{BANDS[2]}' is 0\.5 everywhere"):
        OPS.blur_mask(band=3)


def test_in_weight_paint_the_result_is_what_is_painted_on(sheet):
    OPS.paint_mask(band=1)
    OPS.blur_mask(band=1, radius=5)
    assert sheet.mode == "WEIGHT_PAINT" and sheet.vertex_groups.active.name == MASKS[0]
    paint(sheet, MASKS[0], range(10), 0.75)
    before = mask(sheet, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    np.testing.assert_array_equal(mask(sheet, 1), before)
