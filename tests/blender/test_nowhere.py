"""Vertices without a finite place: no file but a .blend has them, and that is told."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import decompose, empty, exportable, load, meshes

FORMATS = [suffix for suffix in exportable() if suffix not in (".blend", ".usd", ".usda")]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def write_broken(path: Path) -> Path:
    """A ball two of whose vertices have no place; one more is in no face."""
    empty()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    mesh = bpy.context.object.data
    mesh.vertices[5].co.z = np.nan
    mesh.vertices[77].co = (np.nan, np.nan, np.nan)
    mesh.vertices.add(1)
    mesh.vertices[-1].co = (np.inf, 0, 0)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.mark.parametrize("suffix", FORMATS)
def test_broken_faces_are_in_no_file(tmp_path: Path, capfd, suffix):
    source, target = write_broken(tmp_path / "in.blend"), tmp_path / f"out{suffix}"
    assert decompose(source, target, "--gain", "1=0", "--leave-out") == 0
    told = capfd.readouterr().err
    assert f"{suffix} does not hold 3 vertices without a finite place: left out, with 11 faces" in (
        told
    )
    assert len(meshes()[0].data.vertices) == 643  # the scene is as it was
    load(target)
    (obj,) = meshes()
    places = np.array([vertex.co for vertex in obj.data.vertices])
    assert len(obj.data.polygons) == 1280 - 11
    assert np.linalg.norm(places, axis=1).max() < 1.1


def test_bands_of_the_rest_are_in_files_that_hold_keys(tmp_path: Path):
    source, target = write_broken(tmp_path / "in.blend"), tmp_path / "out.glb"
    assert decompose(source, target, "--gain", "1=0", "--leave-out") == 0
    load(target)
    (obj,) = meshes()
    names = [key.name for key in obj.data.shape_keys.key_blocks]
    assert names[1:] == ["Shape Detail Band 1", "Shape Detail Band 2", "Shape Detail Band 3"]
    for key in obj.data.shape_keys.key_blocks:
        places = np.array([point.co for point in key.data])
        assert np.isfinite(places).all()
        assert np.abs(places).max() < 2


def test_a_blend_keeps_them_and_that_is_told(tmp_path: Path, capfd):
    source, target = write_broken(tmp_path / "in.blend"), tmp_path / "out.blend"
    assert decompose(source, target, "--leave-out") == 0
    assert "a .blend keeps 3 vertices without a finite place" in capfd.readouterr().err
    load(target)
    assert len(meshes()[0].data.polygons) == 1280


def test_a_refusal_names_the_coordinate_that_is_none(tmp_path: Path, capfd):
    source, target = write_broken(tmp_path / "in.blend"), tmp_path / "out.ply"
    assert decompose(source, target) == 1
    error = capfd.readouterr().err.splitlines()[-1]
    assert "vertex 5" in error
    assert error.count("NaN") == 1
    assert not target.exists()
