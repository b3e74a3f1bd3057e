"""The command line gives pictures back: every pair of formats, with gains that keep every band."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pictures
import pytest
from command_line_files import empty, run

KEEP = ["--bands", "2", "--steps", "4", "--gain", "all=1"]
# Format and depth of what goes in and comes out.
FILES = [
    (".png", "8"), (".png", "16"), (".tif", "8"), (".tif", "16"), (".tif", "float"),
    (".exr", "half"), (".exr", "float"),
    (".jpg", "8"), (".webp", "8"), (".bmp", "8"), (".tga", "8"),
]  # fmt: skip
# Of floats a step is relative.
STEP = {"8": 1 / 255, "16": 1 / 65535, "half": 2.0**-10, "float": 2.0**-23}
# What single precision makes of values that are converted to another colour space, relatively.
CONVERSION = 3e-7


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def keep(source: Path, target: Path, *options: str) -> int:
    return run(["image", str(source), "-o", str(target), *KEEP, *options])


def decoded(values: np.ndarray) -> np.ndarray:
    """Linear values of sRGB."""
    above = np.maximum(values, 0.04045)
    return np.where(values <= 0.04045, values / 12.92, ((above + 0.055) / 1.055) ** 2.4)


def encoded(values: np.ndarray) -> np.ndarray:
    """SRGB of linear values."""
    above = np.maximum(values, 0.0031308)
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * above ** (1 / 2.4) - 0.055)


def converted(pixels: np.ndarray, target: Path, depth: str, source: Path) -> np.ndarray:
    """What is to be in the target, of fractions of white (H, W, 4) in the source."""
    was, found = pictures.is_associated(source), pixels.copy()
    alpha = found[..., 3:]
    if was:
        found[..., :3] /= np.where(alpha == 0, 1, alpha)
    if target.suffix == ".exr" and source.suffix != ".exr":
        found[..., :3] = decoded(found[..., :3])
    elif source.suffix == ".exr" and depth in ("8", "16"):
        found[..., :3] = encoded(found[..., :3])
    if pictures.is_associated(target):
        found[..., :3] *= np.where(alpha == 0, was, alpha)
    return found.clip(0, 1) if depth in ("8", "16") else found


@pytest.mark.parametrize("channels", pictures.MODES)
@pytest.mark.parametrize(("suffix", "depth"), FILES)
def test_an_all_pass_gives_every_format_back_in_every_format(suffix, depth, channels, tmp_path):
    """To half a step of the depth that is written."""
    lacking = {".jpg": (2, 4), ".webp": (2,), ".bmp": (2,), ".tga": (2,)}
    if channels in lacking.get(suffix, ()):
        pytest.skip("the format has no such channels")
    associated = suffix == ".exr"
    pixels = pictures.values(channels, depth, associated)
    source = pictures.write(tmp_path / f"in{suffix}", pixels, associated)
    if suffix == ".jpg":
        pixels = pictures.read(source)
    for goal, wanted in FILES:
        target = tmp_path / f"out{goal}"
        assert keep(source, target, "--depth", wanted) == 0
        found = pictures.read(target)
        assert found.dtype == pictures.DTYPES[wanted]
        expected = converted(pictures.fractions(pixels), target, wanted, source)
        got = pictures.fractions(found)
        if goal == ".jpg":
            as_jpeg_gives_them(got, expected, tmp_path)
            continue
        if found.shape[2] % 2:  # without alpha
            expected[..., 3] = 1
        if goal == ".webp":  # which loses what is under alpha 0
            got, expected = got[expected[..., 3] > 0], expected[expected[..., 3] > 0]
        allowed = np.array(0.501 * STEP[wanted])
        if wanted in ("half", "float"):
            is_converted = (goal == ".exr") != (suffix == ".exr")
            allowed = (allowed + is_converted * CONVERSION) * np.maximum(np.abs(expected), 6.2e-5)
        assert (np.abs(got - expected) <= allowed).all(), (goal, wanted)


def as_jpeg_gives_them(got: np.ndarray, expected: np.ndarray, folder: Path) -> None:
    """Off no more than another program is that writes them with the same quality."""
    wanted = np.rint(255 * expected[..., :3]).astype(np.uint8)
    other = pictures.write(folder / "other.jpg", wanted, subsampling="4:2:0")
    theirs = np.abs(pictures.fractions(pictures.read(other)) - expected)[..., :3]
    ours = np.abs(got - expected)[..., :3]
    assert ours.mean() <= 1.05 * theirs.mean() + 0.5 / 255


@pytest.mark.parametrize(
    ("suffix", "depth", "channels", "goal", "expected"),
    [
        (".png", "16", 1, ".png", (np.uint16, 1)),
        (".png", "8", 4, ".tif", (np.uint8, 4)),
        (".png", "16", 2, ".tif", (np.uint16, 2)),
        (".png", "8", 2, ".png", (np.uint8, 4)),
        (".png", "8", 3, ".exr", (np.float16, 3)),
        (".png", "16", 3, ".exr", (np.float32, 3)),
        (".tif", "float", 1, ".tif", (np.float32, 1)),
        (".tif", "16", 4, ".jpg", (np.uint8, 3)),
        (".exr", "half", 4, ".exr", (np.float16, 4)),
        (".exr", "float", 3, ".exr", (np.float32, 3)),
        (".exr", "half", 3, ".tif", (np.float32, 3)),
        (".exr", "half", 3, ".png", (np.uint16, 3)),
        (".jpg", "8", 1, ".jpg", (np.uint8, 1)),
    ],
)
def test_depth_and_channels_are_those_of_the_input(
    suffix, depth, channels, goal, expected, tmp_path
):
    """Or the next that the format has."""
    pixels = pictures.values(channels, depth, suffix == ".exr")
    source = pictures.write(tmp_path / f"in{suffix}", pixels)
    assert keep(source, tmp_path / f"out{goal}") == 0
    found = pictures.read(tmp_path / f"out{goal}")
    assert (found.dtype.type, found.shape[2]) == expected
