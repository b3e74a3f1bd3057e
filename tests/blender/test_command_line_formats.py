"""The command line reads and writes every format that Blender does."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import (
    band_values,
    decompose,
    empty,
    exportable,
    load,
    meshes,
    write_monkey,
)

# Formats that hold the filtered shape, and those that hold shape keys as well; of the former,
# Debian's Blender is built without some.
SHAPES = [
    suffix for suffix in (".ply", ".obj", ".stl", ".usdc", ".abc", ".dae") if suffix in exportable()
]
KEYS = [".blend", ".glb", ".gltf", ".fbx"]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def smoothness() -> float:
    """How much the normals of corners agree with those of their faces."""
    (obj,) = meshes()
    faces = obj.data.polygons
    corners = [obj.data.corner_normals[face.loop_start].vector for face in faces]
    return float(np.mean([a.dot(b.normal) for a, b in zip(corners, faces, strict=True)]))


def roughness(path: Path) -> float:
    """How far vertices lie from the middle of their neighbours, of the shape as it is shown.

    Vertices at the same place count as one, as some formats store one per face corner.
    """
    load(path)
    (obj,) = meshes()
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.array([vertex.co for vertex in shape.data.vertices])
    points, place = np.unique(points, axis=0, return_inverse=True)
    edges = place.ravel()[np.array([edge.vertices for edge in shape.data.edges])]
    edges = np.unique(np.sort(edges, axis=1), axis=0)
    total, count = np.zeros_like(points), np.zeros(len(points))
    for one, other in (edges.T, edges.T[::-1]):
        np.add.at(total, one, points[other])
        np.add.at(count, one, 1)
    used = count > 0
    away = points[used] - total[used] / count[used, None]
    size = np.linalg.norm(np.ptp(points, axis=0))
    return float(np.linalg.norm(away, axis=1).mean() / size)


@pytest.mark.parametrize("suffix", [*SHAPES, *KEYS])
def test_filters_every_format(tmp_path: Path, suffix):
    path, target = write_monkey(tmp_path / f"monkey{suffix}"), tmp_path / f"out{suffix}"
    untouched = path.read_bytes()
    before = roughness(path)
    plain = ["--keep-limbs", "0", "--soft-edges", "0"]
    assert decompose(path, target, "--gain", "all=0", *plain) == 0
    assert path.read_bytes() == untouched
    assert roughness(target) < 0.7 * before
    if suffix in KEYS:
        np.testing.assert_allclose(band_values(meshes()[0]), -1, atol=1e-6)
    else:
        assert meshes()[0].data.shape_keys is None


@pytest.mark.parametrize("suffix", [*SHAPES, *KEYS])
def test_every_format_becomes_a_blend_with_bands(tmp_path: Path, suffix):
    target = tmp_path / "out.blend"
    assert decompose(write_monkey(tmp_path / f"monkey{suffix}"), target) == 0
    load(target)
    (obj,) = meshes()
    names = [key.name for key in obj.data.shape_keys.key_blocks]
    assert names == ["Basis", "M1 Band 1", "M1 Band 2", "M1 Band 3"]
    assert band_values(obj) == [0, 0, 0]
    assert len(obj.data.spectral_tv.decompositions[-1].bands) == 3


@pytest.mark.parametrize(("suffix", "importer"), [("glb", "gltf"), ("ply", "ply_import")])
def test_files_that_tear_the_surface_keep_their_vertices_and_normals(
    tmp_path: Path, suffix, importer
):
    """Flat shading stores a vertex per face corner in glTF, UV seams store theirs twice in PLY."""
    path, target = write_monkey(tmp_path / f"monkey.{suffix}"), tmp_path / "out.blend"
    whole = len(meshes()[0].data.vertices)
    empty()
    module = bpy.ops.import_scene if suffix == "glb" else bpy.ops.wm
    getattr(module, importer)(filepath=str(path))
    count, shading = len(meshes()[0].data.vertices), smoothness()
    assert count > whole
    assert decompose(path, target, "--gain", "all=0") == 0
    load(target)
    (obj,) = meshes()
    assert len(obj.data.vertices) == count
    assert len(obj.data.uv_layers) == 1
    assert smoothness() == pytest.approx(shading, abs=1e-3)
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert len({tuple(vertex.co) for vertex in shape.vertices}) == whole
