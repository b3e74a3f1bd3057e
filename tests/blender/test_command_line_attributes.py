"""Bands as attributes on the command line."""

from __future__ import annotations

import numpy as np
import pytest
from command_line_files import decompose, empty, exportable, load, meshes, write_monkey
from deform_scene import evaluated


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


FORMATS = [".blend", ".usdc", ".ply", ".glb", ".obj"]


@pytest.mark.parametrize("suffix", [each for each in FORMATS if each in exportable()])
def test_bands_as_attributes_give_the_same_shape_in_every_format(suffix, tmp_path):
    source = write_monkey(tmp_path / "monkey.ply")
    shapes = []
    for kind in ("keys", "attributes"):
        target = tmp_path / f"{kind}{suffix}"
        assert decompose(source, target, "--bands-as", kind, "--gain", "1=0", "--gain", "2=2") == 0
        empty()
        load(target)
        (obj,) = meshes()
        shapes.append(evaluated(obj))
        names = [each.name for each in obj.data.attributes if "band" in each.name.lower()]
        # A .ply has a column for each axis.
        expected = {".blend": 3, ".usdc": 3, ".ply": 9, ".glb": 3}.get(suffix, 0)
        assert len(names) == (expected if kind == "attributes" else 0), names
    if suffix == ".blend":
        assert [each.type for each in obj.modifiers] == ["NODES"]
    size = np.linalg.norm(np.ptp(shapes[0], axis=0))
    assert len(shapes[0]) == len(shapes[1])
    np.testing.assert_allclose(*shapes, rtol=0, atol=2e-6 * size)


def test_heights_are_written_where_asked_for(tmp_path):
    source = write_monkey(tmp_path / "monkey.ply")
    assert decompose(source, tmp_path / "out.blend", "--heights") == 0
    load(tmp_path / "out.blend")
    names = [each.name for each in meshes()[0].data.attributes if "Height" in each.name]
    assert len(names) == 3
