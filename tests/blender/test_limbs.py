"""Keep Limbs: bands are cut anew in their places, and their sum with the residual stays."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import object_of, saved_and_loaded
from conftest import MODULE
from shapes import dumbbell

STEPS = 12


def bands_of(obj) -> np.ndarray:
    keys = obj.data.shape_keys.key_blocks
    found = [np.empty(3 * len(obj.data.vertices), np.float32) for _ in keys]
    for key, values in zip(keys, found, strict=True):
        key.data.foreach_get("co", values)
    return np.array([(each - found[0]).reshape(-1, 3) for each in found[1:]], dtype=float)


@pytest.fixture
def body():
    """A dumbbell with a neck that the largest bands of the paper take away."""
    obj = object_of("Body", *dumbbell(neck_length=3.0))
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.spectral_tv.decompose(bands=3, steps=STEPS) == {"FINISHED"}
    return obj


def expected(obj, keep_limbs: float, soft_edges: float = 0.3) -> np.ndarray:
    """What the package finds."""
    vertices = np.array([vertex.co for vertex in obj.data.vertices], dtype=float)
    triangles = np.array([face.vertices for face in obj.data.polygons])
    mesh = spectral_tv.Mesh(vertices, triangles)
    split = spectral_tv.decompose(mesh, "m1", steps=STEPS, soft_edges=soft_edges)
    return split.bands(split.band_edges(3), keep_limbs)


def test_bands_keep_limbs_and_have_soft_edges_by_default(body):
    assert np.abs(bands_of(body) - expected(body, 1.0)).max() < 1e-5
    bpy.ops.spectral_tv.decompose(bands=3, steps=STEPS, keep_limbs=0, soft_edges=0)
    assert np.abs(bands_of(body) - expected(body, 0, 0)).max() < 1e-5


@pytest.mark.parametrize("method", ["M2", "HEAT"])
def test_methods_that_are_for_limbs_or_for_comparison_take_them(body, method):
    bpy.ops.spectral_tv.decompose(method=method, bands=3, steps=STEPS)
    assert body.data.spectral_tv_limbs.keep == 0
    own = bands_of(body)[3:]
    body.data.spectral_tv_limbs.keep = 2
    assert np.abs(bands_of(body)[3:] - own).max() > 0.01


def test_the_slider_cuts_bands_anew_and_keeps_what_was_set(body):
    keys = body.data.shape_keys.key_blocks
    keys[1].value, keys[1].name, keys[2].mute = 2, "Skin", True
    limbs = body.data.spectral_tv_limbs
    assert limbs.keep == 1
    for amount in (0, 0.5, 3):
        limbs.keep = amount
        assert limbs.keep == pytest.approx(amount)
        assert np.abs(bands_of(body) - expected(body, amount)).max() < 1e-5
    assert [key.name for key in keys] == ["Basis", "Skin", "M1 Band 2", "M1 Band 3"]
    assert keys[1].value == 2 and keys[2].mute
    # Bands are known as such afterwards.
    assert bpy.ops.spectral_tv.filter(preset="RESET") == {"FINISHED"}
    assert keys["Skin"].value == 0


def test_the_neck_stays_at_minus_one(body):
    limbs, radii = body.data.spectral_tv_limbs, {}
    basis = np.array([vertex.co for vertex in body.data.vertices])
    neck = np.abs(basis[:, 2]) < 0.5
    for amount in (0, 3):
        limbs.keep = amount
        low = basis - bands_of(body).sum(axis=0)
        radii[amount] = np.linalg.norm(low[neck, :2], axis=1).mean()
    own = np.linalg.norm(basis[neck, :2], axis=1).mean()
    assert radii[3] > 0.95 * own > 0.85 * own > radii[0]


def test_a_sculpted_band_stays_and_is_named(body, capfd):
    key = body.data.shape_keys.key_blocks[2]
    for point in key.data[:40]:
        point.co.x += 0.3
    before = bands_of(body)
    assert bpy.ops.spectral_tv.cut.poll()
    body.data.spectral_tv_limbs.keep = 3
    after = bands_of(body)
    assert np.array_equal(after[1], before[1])
    assert np.abs(after - before)[[0, 2]].max() > 1e-3
    record = body.data.spectral_tv.decompositions[-1]
    assert [band.is_sculpted for band in record.bands] == [False, True, False]


def test_cut_again_keeps_as_much_unless_it_is_told(body):
    body.data.spectral_tv_limbs.keep = 2
    bpy.ops.spectral_tv.cut(bands=2)
    assert body.data.spectral_tv_limbs.keep == 2
    kept = bands_of(body).sum(axis=0)
    assert np.abs(kept - expected(body, 2).sum(axis=0)).max() < 1e-5
    bpy.ops.spectral_tv.cut(bands=3, keep_limbs=0)
    assert body.data.spectral_tv_limbs.keep == 0
    assert np.abs(bands_of(body) - expected(body, 0)).max() < 1e-5


def test_a_flow_that_is_gone_leaves_bands_as_they_are(body, tmp_path, capfd):
    body.data.spectral_tv_limbs.keep = 0.5
    import_module(f"{MODULE}.bands.bands").flows.clear()  # as when a file is loaded
    again = saved_and_loaded(body, tmp_path / "body.blend")
    bpy.context.collection.objects.link(again)
    before = bands_of(again)
    assert again.data.spectral_tv_limbs.keep == 0.5
    again.data.spectral_tv_limbs.keep = 3
    assert again.data.spectral_tv_limbs.keep == 0.5
    assert "stays as it is: The flow is no longer in memory" in capfd.readouterr().err
    assert np.array_equal(bands_of(again), before)


def test_bands_of_before_are_what_they_were(body):
    """A record without the options is of bands that keep no limbs and have hard edges."""
    record = body.data.spectral_tv.decompositions[-1]
    record.settings = '{"method": "M1", "bands": 3, "steps": 12}'
    assert body.data.spectral_tv_limbs.keep == 0
    settings = import_module(f"{MODULE}.bands.bands").settings_of(record)
    assert (settings.soft_edges, settings.base, settings.displacement) == (0, "FLOW", "SCALAR")


def test_objects_of_one_surface_follow_and_copies_do_not():
    vertices, triangles = dumbbell(neck_length=3.0)
    upper = (vertices[triangles][:, :, 2] > 0).all(axis=1)
    parts = [object_of(str(part), vertices, triangles[part]) for part in (upper, ~upper)]
    for obj in parts:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = parts[0]
    assert bpy.ops.spectral_tv.decompose(bands=3, steps=STEPS, together=True) == {"FINISHED"}
    copy = parts[0].copy()
    copy.data = parts[0].data.copy()
    bpy.context.collection.objects.link(copy)
    parts[0].data.spectral_tv_limbs.keep = 3
    assert [obj.data.spectral_tv_limbs.keep for obj in (*parts, copy)] == [3, 3, 1]
    low = [bands_of(obj).sum(axis=0) for obj in parts]
    seam = np.abs(vertices[:, 2]) < 1e-6
    used = [np.isin(np.arange(len(vertices)), triangles[part]) for part in (upper, ~upper)]
    seam = used[0] & used[1]
    assert seam.any()
    assert np.abs(low[0][seam] - low[1][seam]).max() < 1e-6
