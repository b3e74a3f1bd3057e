"""A vertex that has no finite place in a file is refused by its number, or left out."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import bpy
import numpy as np
import pytest
import sheet_files
from command_line_files import exportable, write_scene
from sheet_files import WRITERS, grid, points_of, told

pytestmark = pytest.mark.once
leave_an_empty_file = sheet_files.leave_an_empty_file
FLOATS = ("little.ply", "binary.stl")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *((name, value) for name in WRITERS for value in (np.nan, np.inf, -np.inf)),
        *((name, 1e39) for name in WRITERS if name not in FLOATS),
    ],
)
@pytest.mark.filterwarnings("error")
def test_a_vertex_that_is_nowhere_is_refused_or_left_out(tmp_path: Path, capfd, name, value):
    points, faces = grid()
    vertex = int(faces[0, 0])
    points[vertex, 1] = value
    source = WRITERS[name](tmp_path / name, points, faces.tolist())
    target = tmp_path / f"out{source.suffix}"
    error = told(source, target, capfd, code=1)
    assert "has a coordinate that is not finite" in error
    if source.suffix != ".stl":
        assert f"vertex {vertex} has" in error
    assert not target.exists()
    left_out = told(source, target, capfd, "--leave-out")
    assert re.search(r"dropped \d+ vert.* not finite, and \d+ triangles there", left_out), left_out
    if source.suffix != ".stl":
        ensure_whole(points_of(target), np.delete(points, vertex, axis=0))


def ensure_whole(found: np.ndarray, expected: np.ndarray) -> None:
    """What has a place in a file is all that is expected, and no more."""
    found = found[(np.abs(found) < 1e37).all(axis=1)]
    apart = np.linalg.norm(found[:, np.newaxis] - expected, axis=2)
    assert apart.min(axis=1).max() < 1e-5
    assert apart.min(axis=0).max() < 1e-5


@pytest.mark.parametrize("suffix", [".glb", ".gltf", ".fbx", ".usdc", ".abc"])
def test_a_vertex_that_is_nowhere_in_other_formats_is_refused_or_left_out(
    tmp_path: Path, capfd, suffix
):
    if suffix not in exportable():
        pytest.skip(f"this Blender is built without {suffix}")
    points, faces = grid()
    vertex = int(faces[0, 0])
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    points[vertex, 1] = -77.25 if suffix.startswith(".gl") else np.nan
    mesh.vertices.foreach_set("co", points.ravel())
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Sheet", mesh))
    source, target = write_scene(tmp_path / f"in{suffix}"), tmp_path / "out.ply"
    if suffix.startswith(".gl"):  # its exporter writes no such numbers
        data = source if suffix == ".glb" else source.with_suffix(".bin")
        mark, nan = (struct.pack("<f", number) for number in (77.25, np.nan))
        assert mark in data.read_bytes()
        data.write_bytes(data.read_bytes().replace(mark, nan))
    assert "has a coordinate that is not finite" in told(source, target, capfd, code=1)
    assert not target.exists()
    told(source, target, capfd, "--leave-out")
    ensure_whole(points_of(target), np.delete(points, vertex, axis=0))
