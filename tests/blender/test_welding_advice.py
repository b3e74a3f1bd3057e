"""Advice about welding names what the user sets, in its unit, and it helps."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import sheet_files
from command_line_files import load, meshes
from sheet_files import grid, told, write_ply
from spectral_tv import notes

pytestmark = pytest.mark.once
leave_an_empty_file = sheet_files.leave_an_empty_file


def soup(gap: float) -> tuple[np.ndarray, list[list[int]]]:
    """The triangles of a sheet, each with corners of its own, moved by up to a gap."""
    points, faces = grid()
    corners = points[faces].reshape(-1, 3)
    corners += gap * np.random.default_rng(0).uniform(-1, 1, corners.shape)
    return corners, np.arange(len(corners)).reshape(-1, 3).tolist()


def test_advice_about_welding_is_that_of_the_option(tmp_path: Path, capfd):
    """What it advises joins the corners, so that nothing is advised then."""
    source = write_ply(tmp_path / "soup.ply", *soup(1e-3), "<")
    error = told(source, tmp_path / "out.ply", capfd, "--weld", "0")
    found = re.search(r"drift apart; pass --weld (\S+)\n", error)
    assert found, error
    again = told(source, tmp_path / "out.ply", capfd, "--weld", found[1])
    assert "--weld" not in again
    assert "drift apart" not in again


def test_advice_about_welding_in_blender_names_the_property(tmp_path: Path):
    surface = import_module("bl_ext.user_default.spectral_tv.scene.surface")
    load(write_ply(tmp_path / "soup.ply", *soup(1e-3), "<"))
    with notes.gathered() as found:
        surface.Surface.read(meshes()[0], reading=surface.Reading(0, False))
    assert re.search(r"set Join Within to [\d.]+ %$", found[-1]), found
