"""Doubles stay doubles, and what is far from 0 is written without steps, or they are told."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
import sheet_files
from command_line_files import load, meshes, run, write_scene
from sheet_files import ORDERS, grid, points_of, told, write_ply
from spectral_tv.files import ply

pytestmark = pytest.mark.once
leave_an_empty_file = sheet_files.leave_an_empty_file


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("offset", [0.0, 4_512_345.678])
def test_a_double_ply_that_is_not_changed_has_the_same_doubles(
    tmp_path: Path, capfd, order, offset
):
    points, faces = grid()
    points = 100 * points + offset
    source = write_ply(tmp_path / "a.ply", points, faces.tolist(), order, "double")
    target = tmp_path / "out.ply"
    told(source, target, capfd)
    assert ply.read_header(target).is_double
    np.testing.assert_array_equal(points_of(target), points_of(source))


def test_a_filtered_double_ply_differs_by_its_displacements(tmp_path: Path, capfd):
    points, faces = grid()
    source = write_ply(tmp_path / "a.ply", points, faces.tolist(), "<", "double")
    blend, target = tmp_path / "a.blend", tmp_path / "out.ply"
    choices = ["--gain", "all=0", "--bands", "1", "--steps", "4"]
    assert run(["decompose", str(source), "-o", str(blend), *choices]) == 0
    load(blend)
    (obj,) = meshes()
    basis, band = (
        np.array([point.co for point in key.data]) for key in obj.data.shape_keys.key_blocks[:2]
    )
    assert run(["decompose", str(source), "-o", str(target), *choices]) == 0
    np.testing.assert_allclose(points_of(target), points - (band - basis), atol=1e-6)


@pytest.mark.parametrize("order", ORDERS)
def test_floats_in_map_coordinates_are_filtered_without_steps(tmp_path: Path, capfd, order):
    """The result is in double precision, though the input is not."""
    points, faces = grid(8)
    points = (10 * points).round() / 2  # as floats have them there
    far = points + np.array([500_000.0, 4_512_345.0, 100.0])
    shapes = []
    for name, where in (("near.ply", points), ("far.ply", far)):
        source = write_ply(tmp_path / name, where, faces.tolist(), order)
        target = tmp_path / f"out_{name}"
        choices = ["--gain", "all=0", "--bands", "1", "--steps", "4"]
        assert run(["decompose", str(source), "-o", str(target), *choices]) == 0
        shapes.append(points_of(target))
    assert "its coordinates are far from 0" in capfd.readouterr().err
    assert ply.read_header(target).is_double
    assert np.abs(shapes[0] + (far - points) - shapes[1]).max() < 1e-4
    assert np.abs(shapes[0] - points).max() > 0.05


@pytest.mark.parametrize("suffix", [".stl", ".glb", ".blend"])
def test_formats_with_floats_alone_tell_of_coarse_steps(tmp_path: Path, capfd, suffix):
    points, faces = grid()
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata((points + 4_512_345).tolist(), [], faces.tolist())
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Sheet", mesh))
    source = write_scene(tmp_path / f"in{suffix}")
    error = told(source, tmp_path / f"out{suffix}", capfd)
    assert "so far from 0 that its coordinates are in steps of 0.5" in error


@pytest.mark.parametrize("suffix", [".ply", ".obj"])
def test_an_object_far_away_is_written_with_all_digits_of_its_mesh(tmp_path: Path, capfd, suffix):
    points, faces = grid()
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("Sheet", mesh)
    obj.location = (500_000, 4_512_345, 100)
    bpy.context.scene.collection.objects.link(obj)
    source, target = write_scene(tmp_path / "in.blend"), tmp_path / f"out{suffix}"
    told(source, target, capfd)
    expected = points + np.array([500_000, 4_512_345, 100])
    found = points_of(target)
    if suffix == ".obj":
        found = found[:, [0, 2, 1]] * (1, -1, 1)
    assert np.abs(found - expected).max() < 1e-5
