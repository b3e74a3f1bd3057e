"""A grid mesh as an image: M3 on a flat base, measured along the base or along the surface."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import object_of
from banded_monkey import shape
from command_line_files import load, run
from shapes import grid

SIDE = 25
CHOICES = {"bands": 3, "steps": 12, "use_scales": True, "finest": 1, "largest": 15}


@pytest.fixture
def relief():
    """A grid with a square block on it."""
    vertices, triangles = grid(SIDE, SIDE, 2.0, 2.0)
    block = np.abs(vertices[:, :2] - 1).max(axis=1) < 0.4
    vertices[block, 2] = 0.3
    obj = object_of("Relief", vertices, triangles)
    return obj


def bands(obj: bpy.types.Object) -> np.ndarray:
    """Displacements (3, V, 3)."""
    keys = obj.data.shape_keys.key_blocks
    shapes = [np.array([point.co for point in key.data]) for key in keys]
    return np.stack(shapes[1:4]) - shapes[0]


@pytest.mark.parametrize("metric", ["SURFACE", "BASE"])
def test_bands_move_vertices_up_and_down_only(relief, metric):
    bpy.ops.spectral_tv.decompose(method="M3", base="FLAT", metric=metric, **CHOICES)
    found = bands(relief)
    np.testing.assert_allclose(found[..., :2], 0, atol=1e-6)
    assert np.abs(found[..., 2]).max() > 0.01
    vertices = np.array([vertex.co for vertex in relief.data.vertices]).astype(float)
    triangles = np.array([list(polygon.vertices) for polygon in relief.data.polygons])
    mesh = spectral_tv.Mesh(vertices, triangles)
    times = spectral_tv.graded_times(0.01**2 * mesh.area, 0.15**2 * mesh.area, 12)
    base = vertices * [1, 1, 0]
    options = {"base": base, "metric": metric.lower(), "displacement": "vector"}
    split = spectral_tv.decompose(mesh, "m3", times, **options)
    np.testing.assert_allclose(found, split.bands(split.band_edges(3)), atol=1e-4)


def test_the_metrics_differ_where_it_is_steep(relief):
    found = {}
    for metric in ("SURFACE", "BASE"):
        relief.shape_key_clear()
        bpy.ops.spectral_tv.decompose(method="M3", base="FLAT", metric=metric, **CHOICES)
        found[metric] = bands(relief)[..., 2].sum(axis=0)
    assert np.abs(found["SURFACE"] - found["BASE"]).max() > 0.01


def test_bases_of_m3():
    """A relief over its flattened self moves along Z alone; a shape key serves as well."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=40, y_subdivisions=40)
    obj = bpy.context.object
    for vertex in obj.data.vertices:
        vertex.co.z = 0.2 * np.sin(6 * vertex.co.x) * np.cos(5 * vertex.co.y)
    bpy.ops.spectral_tv.decompose(method="M3", bands=3, steps=8, base="FLAT")
    keys = obj.data.shape_keys.key_blocks
    moves = (shape(keys["Edge-Keeping Detail Band 3"]) - shape(keys["Basis"])).reshape(-1, 3)
    assert np.abs(moves[:, :2]).max() < 1e-6 < np.abs(moves[:, 2]).max()

    flat = obj.shape_key_add(name="Flat", from_mix=False)
    for point in flat.data:
        point.co.z = -0.2
    bpy.ops.spectral_tv.decompose(method="M3", bands=3, steps=8, base="KEY", base_key="Flat")
    again = (shape(keys["Edge-Keeping Detail Band 3"]) - shape(keys["Basis"])).reshape(-1, 3)
    np.testing.assert_allclose(again, moves, atol=1e-4)
    with pytest.raises(RuntimeError, match="no shape key 'Nothing'"):
        bpy.ops.spectral_tv.decompose(method="M3", base="KEY", base_key="Nothing")


def test_the_command_line_takes_the_metric(relief, tmp_path):
    source, target = tmp_path / "relief.blend", tmp_path / "flat.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(source))
    options = "--method m3 --base flat --metric base --bands 3 --steps 12 --finest 1 --largest 15"
    assert run(["decompose", str(source), "-o", str(target), *options.split()]) == 0
    load(target)
    by_line = bands(bpy.data.objects["Relief"])
    load(source)
    obj = bpy.data.objects["Relief"]
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.decompose(method="M3", base="FLAT", metric="BASE", **CHOICES)
    np.testing.assert_allclose(by_line, bands(obj), atol=1e-4)
