"""Vertices, objects and edges of a file come out in the order in which they came in."""

from __future__ import annotations

import re
from pathlib import Path

import bpy
import numpy as np
import pytest
import sheet_files
from command_line_files import empty, meshes, write_scene
from sheet_files import ORDERS, grid, points_of, told, write_obj, write_ply
from spectral_tv.files import ply_table as tables

pytestmark = pytest.mark.once
leave_an_empty_file = sheet_files.leave_an_empty_file


@pytest.mark.parametrize("is_parted", [False, True])
def test_loose_vertices_of_an_obj_stay_in_their_places(tmp_path: Path, capfd, is_parted):
    points, faces = grid()
    loose = np.array([[9.0, 9, 9], [8, 8, 8]])
    points = np.vstack([loose[:1], points[:10], loose[1:], points[10:]])
    shift = 1 + np.arange(36) + (np.arange(36) >= 10)
    source, target = (
        write_obj(tmp_path / "a.obj", points, shift[faces].tolist()),
        tmp_path / "o.obj",
    )
    if is_parted:  # all vertices before the only object
        source.write_text(source.read_text().replace("f ", "o Sheet\nf ", 1))
    told(source, target, capfd)
    np.testing.assert_allclose(points_of(target), points, atol=1e-6)
    found = re.findall(r"^f (\d+)\S* (\d+)\S* (\d+)", target.read_text(), re.MULTILINE)
    assert sorted(map(tuple, np.array(found).astype(int) - 1)) == sorted(map(tuple, shift[faces]))
    assert target.read_text().count("o ") == 1


def test_objects_of_an_obj_stay_in_their_order(tmp_path: Path, capfd):
    points, faces = grid()
    source, target = tmp_path / "a.obj", tmp_path / "out.obj"
    lines = []
    for number, name in enumerate(("Zebra", "Apple", "Moon")):
        lines += [
            f"o {name}",
            *("v {!r} {!r} {!r}".format(*p) for p in (points + 9 * number).tolist()),
        ]
        lines += ["f {} {} {}".format(*(face + 1 + 36 * number)) for face in faces]
    source.write_text("\n".join([*lines, ""]))
    told(source, target, capfd)
    assert re.findall(r"^o (\S+)", target.read_text(), re.MULTILINE) == ["Zebra", "Apple", "Moon"]
    np.testing.assert_allclose(points_of(target), points_of(source), atol=1e-5)


@pytest.mark.parametrize("order", ORDERS)
def test_vertices_of_a_ply_with_uvs_stay_in_their_order(tmp_path: Path, capfd, order):
    points, faces = grid()
    rng = np.random.default_rng(1)
    normals = rng.normal(size=points.shape)
    normals[:, 2] = np.abs(normals[:, 2]) + 1
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    columns = dict(zip(("nx", "ny", "nz"), normals.T, strict=True))
    uvs = dict(zip("st", rng.random((2, len(points))), strict=True))
    colors = {n: rng.integers(0, 256, 36).astype(np.uint8) for n in ("red", "green", "blue")}
    extra = {"label": np.arange(36.0)}
    source = write_ply(
        tmp_path / "a.ply", points, faces.tolist(), order, **columns, **uvs, **colors, **extra
    )
    target = tmp_path / "out.ply"
    told(source, target, capfd)
    before, after = tables.read(source), tables.read(target)
    assert set(after.columns) == set(before.columns)  # no alpha
    assert after.header.format == before.header.format
    for name, values in before.columns.items():
        within = 1e-3 if name.startswith("n") else 1e-6  # Blender keeps directions in 16 bits
        np.testing.assert_allclose(after.columns[name], values, atol=within, err_msg=name)
    np.testing.assert_array_equal(after.faces.corners, before.faces.corners)


def test_vertices_of_a_blend_become_those_of_a_ply_in_order(tmp_path: Path, capfd):
    """Where UVs have seams vertices are doubled, behind all others; quads and edges stay."""
    empty()
    bpy.ops.mesh.primitive_cube_add(size=2)
    bpy.ops.mesh.primitive_uv_sphere_add(
        segments=8, ring_count=6, location=(3, 1, 0), rotation=(1, 2, 3)
    )
    mesh = bpy.context.object.data
    bpy.context.object.data.vertices.add(2)
    mesh.edges.add(1)
    mesh.edges[-1].vertices = (len(mesh.vertices) - 2, 5)
    mesh.update()
    bpy.context.view_layer.update()
    expected = np.array([obj.matrix_world @ v.co for obj in meshes() for v in obj.data.vertices])
    source, target = write_scene(tmp_path / "a.blend"), tmp_path / "out.ply"
    error = told(source, target, capfd, "--apart")
    found = points_of(target)
    assert f"{len(found) - len(expected)} vertices were doubled at the seams of UV maps" in error
    assert len(found) > len(expected)
    np.testing.assert_allclose(found[: len(expected)], expected, atol=1e-5)
    assert tables.read(target).edges.tolist() == [[len(expected) - 2, 8 + 5]]
