"""OBJ files with odd lines and groups: read as they are, and what is not read is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import sheet_files
from sheet_files import grid, told, write_obj
from spectral_tv.files import obj as objs

pytestmark = pytest.mark.once
leave_an_empty_file = sheet_files.leave_an_empty_file


def test_obj_files_with_odd_lines_are_read_as_they_are(tmp_path: Path):
    """Indices from the end, lines that go on, corners with UVs, and what is no number."""
    source = tmp_path / "odd.obj"
    source.write_text(
        "v 0 0 0\n v 1 0 \\\n0 1 0.5 0\nv 1 1\nv 1 x 0\nvt 0 0\n"
        "f 1/1 2/1/1 3//1\nf -1 -2 \\\n -3\nf 1 2 99999999999999999999\nf 1 2 a\nf 4 0 5\nl 1 -1\n"
    )
    read = objs.read(source)
    np.testing.assert_array_equal(
        read.points, [[0, 0, 0], [1, 0, 0], [1, 1, np.nan], [1, np.nan, 0]]
    )
    assert read.faces.sizes.tolist() == [3, 3, 3, 3, 3]
    expected = [0, 1, 2, 3, 2, 1, 0, 1, -1, 0, 1, -1, 3, -1, -1]
    assert read.faces.corners.tolist() == expected
    assert read.loose.tolist() == []


def test_groups_of_an_obj_are_told(tmp_path: Path, capfd):
    source = write_obj(tmp_path / "a.obj", *grid())
    source.write_text(source.read_text().replace("f ", "g Left arm\nf ", 1))
    error = told(source, tmp_path / "out.obj", capfd)
    assert "left out, as they are not read: groups of faces (Left arm)" in error
