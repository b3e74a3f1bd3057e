"""Steps by accuracy: in bpy.ops, in the panel's settings and on the command line."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import decompose, load, meshes, write_monkey


def band(obj, index):
    keys = obj.data.shape_keys.key_blocks
    flat = np.empty((2, 3 * len(obj.data.vertices)), dtype=np.float32)
    for row, key in zip(flat, (keys[0], keys[index]), strict=True):
        key.data.foreach_get("co", row)
    return (flat[1] - flat[0]).reshape(-1, 3).astype(float)


def bands(obj, **choices):
    obj.shape_key_clear()
    bpy.ops.spectral_tv.decompose(bands=3, **choices)
    return np.array([band(obj, index) for index in (1, 2, 3)])


def test_finer_accuracy_comes_closer_to_the_finest_steps(monkey):
    fine = bands(monkey, method="M2", steps=600)
    errors = []
    for percent in (40, 4):
        found = bands(monkey, method="M2", use_accuracy=True, accuracy=percent)
        errors.append(np.linalg.norm(found - fine) / np.linalg.norm(fine))
    print(errors)
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < 0.1


def test_the_number_of_steps_is_then_of_no_account(monkey):
    found = [bands(monkey, steps=steps, use_accuracy=True, accuracy=20) for steps in (4, 64)]
    np.testing.assert_array_equal(*found)


def test_more_bands_than_the_fewest_steps_are_refused(monkey):
    with pytest.raises(RuntimeError, match="24 bands need more than 24 steps"):
        bpy.ops.spectral_tv.decompose(bands=24, steps=100, use_accuracy=True)
    assert monkey.data.shape_keys is None


def test_on_the_command_line(tmp_path: Path):
    source, target = write_monkey(tmp_path / "monkey.ply"), tmp_path / "bands.blend"
    assert decompose(source, target, "--accuracy", "0.1") == 0
    load(target)
    (obj,) = meshes()
    found = band(obj, 2)
    obj.shape_key_clear()
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.decompose(bands=3, use_accuracy=True, accuracy=10)
    np.testing.assert_allclose(band(obj, 2), found, atol=1e-6)
