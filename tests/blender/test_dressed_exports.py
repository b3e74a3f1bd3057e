"""Files of a dressed body that the command line splits into bands show what the .blend does."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import exportable, load, run
from dressed_body import dressed
from following import in_world
from rigged_body import FRAMES
from saved_scene import Saved, clear

GAINS = ("--gain", "1=2", "--gain", "2=0", "--gain", "3=1.5")
BANDS = ("--bands", "3", "--steps", "8", "--heights")
KINDS = ("keys", "attributes")
# What holds attributes.
HOLDING = (".usdc", ".glb")


@pytest.fixture(scope="module")
def source(tmp_path_factory) -> Path:
    return Saved.of(dressed, tmp_path_factory.mktemp("source")).path


@pytest.fixture(autouse=True)
def _leave_nothing():
    yield
    clear()


def filtered(source: Path, target: Path, kind: str) -> dict[str, bpy.types.Object]:
    """The meshes that come out, by the names they had."""
    clear()
    assert (
        run(["decompose", str(source), "-o", str(target), *BANDS, "--bands-as", kind, *GAINS]) == 0
    )
    clear()
    load(target)
    bpy.context.scene.frame_set(FRAMES[0])
    meshes = [obj for obj in bpy.context.scene.objects if obj.type == "MESH"]
    return {obj.name.partition(".")[0]: obj for obj in meshes}


def key_values(obj: bpy.types.Object) -> dict[str, list[float]]:
    """Those of the face keys on FRAMES, but for names that .usdc gives to others."""
    found: dict[str, list[float]] = {}
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        for key in obj.data.shape_keys.key_blocks[1:] if obj.data.shape_keys else ():
            if "Band" not in key.name:
                found.setdefault(key.name.rstrip("2"), []).append(key.value)
    bpy.context.scene.frame_set(FRAMES[0])
    return found


@pytest.fixture(scope="module")
def expected(source, tmp_path_factory):
    """What the .blend shows on the first frame, the values of face keys, and attributes."""
    target = tmp_path_factory.mktemp("blend") / "out.blend"
    meshes = filtered(source, target, "attributes")
    return {name: (in_world(obj), key_values(obj), attributes(obj)) for name, obj in meshes.items()}


def attributes(obj: bpy.types.Object) -> dict[str, np.ndarray]:
    """Vectors of bands, and heights, by their names as no format changes them."""
    found = {}
    for each in obj.data.attributes:
        name = each.name.strip("_").replace("_", " ").lower()
        if name.startswith("shape detail band"):
            channels = 3 if each.data_type == "FLOAT_VECTOR" else 1
            values = np.empty(channels * len(each.data), dtype=np.float32)
            each.data.foreach_get("vector" if channels == 3 else "value", values)
            found[name] = values
    return found


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "suffix", [each for each in (".usdc", ".abc", ".obj", ".glb", ".fbx") if each in exportable()]
)
def test_a_file_shows_what_the_blend_does(source, expected, suffix, kind, tmp_path):
    meshes = filtered(source, tmp_path / f"out{suffix}", kind)
    assert meshes.keys() == expected.keys()
    for name, (shape, values, held) in expected.items():
        obj = meshes[name]
        assert obj.data.uv_layers and (obj.data.materials or suffix == ".abc"), name
        found = in_world(obj)
        if suffix != ".glb":  # whose vertices are split
            assert len(found) == len(shape), name
        away = [np.abs(shape - point).max(axis=1).min() for point in found[::7]]
        assert max(away) < 1e-5, (name, max(away))
        if suffix in (".usdc", ".glb", ".fbx"):
            now = key_values(obj)
            assert now.keys() == values.keys(), name
            for key, wanted in values.items():
                # Values are beyond the ends of sliders, as drivers' are.
                np.testing.assert_allclose(now[key], wanted, atol=0.051, err_msg=f"{name} {key}")
        if suffix in HOLDING:
            there = attributes(obj)
            assert {each for each in held if kind == "attributes" or "height" in each} == {*there}
            for each, numbers in there.items():
                # Vertices are split, or went through Subdivision.
                if suffix == ".usdc" and numbers.shape == held[each].shape:
                    np.testing.assert_allclose(numbers, held[each], atol=1e-6, err_msg=each)
