"""bpy.ops.spectral_tv.bake_safe: the mix of the bands as a key in which no face folds."""

from __future__ import annotations

import bpy
import folding_sheet
import numpy as np
import pytest
import spectral_tv
from ball import object_of
from folding_sheet import (
    SCALES,
    STRETCH,
    WILD,
    banded,
    counted,
    key,
    line,
    moved,
    points,
    sheet_with_bumps,
    text,
    triangles,
    turn,
)
from reference_guard import lengths
from shapes import grid

sheet = folding_sheet.sheet


def test_baked_safe_nothing_folds(sheet, capfd):
    turn(sheet)
    mix = sum(value * moved(sheet, name) for name, value in WILD.items())
    assert bpy.ops.spectral_tv.bake_safe() == {"FINISHED"}
    safe = key(sheet, "Safe")
    assert safe.value == 0 and [key(sheet, name).value for name in WILD] == [*WILD.values()]
    assert counted(sheet, moved(sheet, "Safe")) == (0, 0)
    said = capfd.readouterr().out
    assert f"{text(*counted(sheet, mix))} in the mix; no face folds in 'Safe', which keeps" in said
    mesh = spectral_tv.Mesh(points(key(sheet, "Basis")), triangles(sheet))
    expected = spectral_tv.safe_displacement(mesh, mix)
    np.testing.assert_allclose(moved(sheet, "Safe"), expected.displacement, atol=1e-5)
    assert f"keeps {100 * expected.kept:.1f}"[:-2] in said
    assert line() == text(*counted(sheet, mix))


def test_the_stretch_can_be_chosen(sheet):
    turn(sheet, **{"Shape Detail Band 3": 1.0})
    bpy.ops.spectral_tv.bake_safe()
    bpy.ops.spectral_tv.bake_safe(stretch=1.05)
    shape, faces = points(key(sheet, "Basis")), triangles(sheet)
    before = lengths(shape, faces)
    for name, most in (("Safe", STRETCH), ("Safe.001", 1.05)):
        largest = (lengths(shape + moved(sheet, name), faces) / before).max()
        assert most / 1.4 < largest <= most + 1e-6


def test_what_does_not_fold_is_baked_as_it_is(sheet, capfd):
    smile = sheet.shape_key_add(name="Smile", from_mix=False)
    smile.data[3].co.z += 0.5
    turn(sheet, **{"Shape Detail Band 1": 0.5, "Shape Detail Band 3": 0.3, "Smile": 0.75})
    bpy.ops.spectral_tv.bake_safe()
    assert "keeps all of what the bands add" in capfd.readouterr().out
    mix = 0.5 * moved(sheet, "Shape Detail Band 1") + 0.3 * moved(sheet, "Shape Detail Band 3")
    np.testing.assert_allclose(moved(sheet, "Safe"), mix, atol=1e-6)


def test_what_is_taken_away_is_not_clamped(sheet, capfd):
    turn(sheet, **dict.fromkeys(WILD, -10.0))
    key(sheet, "Shape Detail Band 1").mute = True
    bpy.ops.spectral_tv.bake_safe()
    mix = sum(-10 * moved(sheet, name) for name in WILD)
    np.testing.assert_allclose(moved(sheet, "Safe"), mix, atol=1e-5)
    said = capfd.readouterr().out
    found = text(*counted(sheet, mix))
    assert "no band is above 0, so nothing is clamped" in said
    assert f"what bands below 0 take away is not clamped: with it {found}" in said


def test_what_is_added_is_clamped_on_what_is_left(sheet):
    """At −1 the small bump is gone; what the other band adds is safe on the shape without it."""
    turn(
        sheet,
        **{"Shape Detail Band 1": -1.0, "Shape Detail Band 2": -1.0, "Shape Detail Band 3": 8.0},
    )
    taken = -moved(sheet, "Shape Detail Band 1") - moved(sheet, "Shape Detail Band 2")
    bpy.ops.spectral_tv.bake_safe()
    added = moved(sheet, "Safe") - taken
    left = points(key(sheet, "Basis")) + taken
    assert counted(sheet, 8 * moved(sheet, "Shape Detail Band 3"), left) != (0, 0)
    assert counted(sheet, added, left) == (0, 0)


def test_parts_that_meet_are_told(capfd):
    """Two sheets face to face, each with a bump: raised, they cross without any fold."""
    vertices, faces = grid(21, 21, 2, 2)
    x, y = vertices[:, 0] - 1, vertices[:, 1] - 1
    vertices[:, 2] = 0.2 * np.exp(-4 * (x**2 + y**2))
    other = vertices * [1, 1, -1] + [0, 0, 0.7]
    both = np.vstack([vertices, other])
    obj = banded(object_of("Mouth", both, np.vstack([faces, faces[:, ::-1] + len(vertices)])))
    turn(obj, **{"Shape Detail Band 3": 1.5})
    bpy.ops.spectral_tv.bake_safe()
    said = capfd.readouterr().out
    assert "parts meet that lie apart, which clamping does not prevent" in said
    assert "0 without the bands" in said
    faces = triangles(obj)
    for shape in ("Basis", "Safe"):
        mesh = spectral_tv.Mesh(points(key(obj, shape)), faces)
        crossing = len(spectral_tv.self_intersections(mesh))
        assert (crossing > 0) == (shape == "Safe")
        if crossing:
            assert f"{crossing} triangles cross" in said


def test_the_midline_of_a_mirrored_object_stays(capfd):
    obj = sheet_with_bumps()
    for vertex in obj.data.vertices:
        vertex.co.x -= 1
    far = [vertex.index for vertex in obj.data.vertices if vertex.co.x < -1e-6]
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for index in far:
        obj.data.vertices[index].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete(type="VERT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for vertex in obj.data.vertices:
        vertex.co.x = 0 if vertex.co.x < 0.03 else vertex.co.x
    obj.modifiers.new("Mirror", "MIRROR")
    banded(obj)
    turn(obj)
    bpy.ops.spectral_tv.bake_safe()
    assert "no face folds in 'Safe'" in capfd.readouterr().out
    basis = points(key(obj, "Basis"))
    middle = basis[:, 0] == 0
    assert middle.sum() > 20
    np.testing.assert_allclose(moved(obj, "Safe")[middle, 0], 0, atol=1e-6)
    assert counted(obj, moved(obj, "Safe")) == (0, 0)


def test_objects_that_meet_stay_joined():
    vertices, faces = grid(31, 31, 2, 2)
    x, y = vertices[:, 0] - 1, vertices[:, 1] - 1
    vertices[:, 2] = 0.3 * np.exp(-8 * (x**2 + y**2))
    side = vertices[faces].mean(axis=1)[:, 0] > 1
    for name, chosen in (("Left", faces[~side]), ("Right", faces[side])):
        kept, numbers = np.unique(chosen, return_inverse=True)
        obj = object_of(name, vertices[kept], numbers.reshape(-1, 3))
        obj.select_set(True)
    bpy.ops.spectral_tv.decompose(bands=3, steps=12, together=True, **SCALES)
    halves = [bpy.data.objects[name] for name in ("Left", "Right")]
    for obj in halves:
        turn(obj, **{"Shape Detail Band 3": 9.0})
    assert bpy.ops.spectral_tv.bake_safe(together=True) == {"FINISHED"}
    seams = []
    for obj in halves:
        basis = points(key(obj, "Basis"))
        seam = np.flatnonzero(np.abs(basis[:, 0] - 1) < 1e-6)
        order = seam[np.argsort(basis[seam, 1])]
        seams.append(points(key(obj, "Safe"))[order])
        assert counted(obj, moved(obj, "Safe")) == (0, 0)
        assert counted(obj, 9 * moved(obj, "Shape Detail Band 3")) != (0, 0)
    assert len(seams[0]) == 31
    np.testing.assert_allclose(seams[0], seams[1], atol=1e-6)


def test_without_bands_it_is_refused():
    sheet_with_bumps()
    for name in ("bake_safe", "count_folds"):
        with pytest.raises(RuntimeError, match="has no bands; decompose it first"):
            getattr(bpy.ops.spectral_tv, name)()
