"""The command line gives pictures back: every pair of formats, with gains that keep every band."""

from __future__ import annotations

from pathlib import Path

import bpy
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
# Channels that Pillow does not write.
LACKING = {".jpg": (2, 4), ".webp": (2,), ".bmp": (2,), ".tga": (2,)}
# Of floats a step is relative.
STEP = {"8": 1 / 255, "16": 1 / 65535, "half": 2.0**-10, "float": 2.0**-23}
# What single precision makes of values that are converted to another color space, relatively.
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
    if channels in LACKING.get(suffix, ()):
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


# Format, depth and channels of what comes in, and of what goes out.
DEPTHS = """\
.png 16 1 -> .png uint16 1
.png 8 4 -> .tif uint8 4
.png 16 2 -> .tif uint16 2
.png 8 2 -> .png uint8 4
.png 8 3 -> .exr float16 3
.png 16 3 -> .exr float32 3
.tif float 1 -> .tif float32 1
.tif 16 4 -> .jpg uint8 3
.exr half 4 -> .exr float16 4
.exr float 3 -> .exr float32 3
.exr half 3 -> .tif float32 3
.exr half 3 -> .png uint16 3
.jpg 8 1 -> .jpg uint8 1
"""


@pytest.mark.parametrize("row", DEPTHS.splitlines())
def test_depth_and_channels_are_those_of_the_input(row, tmp_path):
    """Or the next that the format has."""
    suffix, depth, channels, _, goal, kind, count = row.split()
    pixels = pictures.values(int(channels), depth, suffix == ".exr")
    source = pictures.write(tmp_path / f"in{suffix}", pixels)
    assert keep(source, tmp_path / f"out{goal}") == 0
    found = pictures.read(tmp_path / f"out{goal}")
    assert (found.dtype.name, found.shape[2]) == (kind, int(count))


def spaces() -> list[str]:
    settings = bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"]
    return [item.identifier for item in settings.enum_items]


@pytest.mark.parametrize("space", spaces())
def test_in_every_color_space_an_all_pass_gives_the_values_back(space, tmp_path, capfd):
    """To the last bit where the format stays, and it is told where Blender would see others."""
    for suffix, depth in ((".png", "16"), (".tif", "float"), (".exr", "float"), (".exr", "half")):
        pixels = pictures.values(4, depth, suffix == ".exr")
        source = pictures.write(tmp_path / f"in{suffix}", pixels, suffix == ".exr")
        target = tmp_path / f"out{suffix}"
        assert keep(source, target, "--colorspace", space.lower()) == 0
        np.testing.assert_array_equal(pictures.read(target), pixels)
        image = bpy.data.images.load(str(target))
        assumed = image.colorspace_settings.name
        bpy.data.images.remove(image)
        real = "Linear Rec.709" if space == "scene_linear" else space
        told = f"its colors are in {real}, but Blender will open it as {assumed}:"
        assert (told in capfd.readouterr().err) == (real != assumed)


@pytest.mark.parametrize("space", [None, "sRGB", "Linear Rec.709", "ACEScg", "Non-Color"])
def test_what_is_converted_looks_the_same_in_blender(space, tmp_path):
    """From 16 bits to OpenEXR and back: the first as seen in that space, the second as in sRGB."""
    options = [] if space is None else ["--colorspace", space]
    pixels = np.rint(65535 * np.random.default_rng(0).uniform(0.2, 0.5, (8, 9, 3)))
    source = pictures.write(tmp_path / "in.png", pixels.astype(np.uint16))
    assert keep(source, tmp_path / "out.exr", *options) == 0
    seen = seen_in_blender(source, space)
    np.testing.assert_allclose(seen_in_blender(tmp_path / "out.exr", space), seen, atol=3e-5)
    if space != "Non-Color":
        assert keep(tmp_path / "out.exr", tmp_path / "back.png") == 0
        back = pictures.read(tmp_path / "back.png").astype(int)
        if space in (None, "sRGB"):
            assert np.abs(back - pixels).max() <= 1


def seen_in_blender(path: Path, space: str | None) -> np.ndarray:
    """Scene-linear colors of a file, in a space; OpenEXR tells its own unless it is not known."""
    image = bpy.data.images.load(str(path))
    if space is not None and (path.suffix != ".exr" or space in ("ACEScg", "Non-Color")):
        image.colorspace_settings.name = space
    flat = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(flat)
    found = flat.reshape(image.size[1], image.size[0], 4)[..., :3]
    bpy.data.images.remove(image)
    return found


def test_blender_itself_gives_all_formats_back(blender, tmp_path):
    """To the last bit where nothing is lost; and what goes to OpenEXR and comes back."""
    folders = {name: tmp_path / name for name in ("in", "out", "linear", "back")}
    for folder in folders.values():
        folder.mkdir()
    sources = {}
    for suffix, depth in FILES:
        for channels in pictures.MODES:
            if suffix == ".jpg" or channels in LACKING.get(suffix, ()):
                continue
            if (suffix, channels) == (".bmp", 4):  # which Blender 4 does not write
                continue
            pixels = pictures.values(channels, depth, suffix == ".exr")
            path = folders["in"] / f"{suffix[1:]}_{depth}_{channels}{suffix}"
            sources[pictures.write(path, pixels, suffix == ".exr")] = pixels
    verb = ["--command", "spectral_tv", "image"]
    blender(*verb, *map(str, sources), "-o", str(folders["out"]), *KEEP)
    for source, pixels in sources.items():
        found = pictures.read(folders["out"] / source.name)
        got, expected = pictures.fractions(found), pictures.fractions(pixels)
        if source.suffix == ".webp":
            got, expected = got[expected[..., 3] > 0], expected[expected[..., 3] > 0]
        assert found.dtype == pixels.dtype
        np.testing.assert_array_equal(got, expected, source.name)
    deep = [str(source) for source in sources if source.name.startswith("png_16")]
    blender(*verb, *deep, "-o", str(folders["linear"]), "--format", "exr", *KEEP)
    there = [str(path) for path in folders["linear"].iterdir()]
    blender(*verb, *there, "-o", str(folders["back"]), "--format", "png", *KEEP)
    for path in folders["back"].iterdir():
        expected = pictures.fractions(sources[folders["in"] / path.name])
        expected[expected[..., 3] == 0, :3] = 0  # as colors are multiplied by alpha
        np.testing.assert_allclose(
            pictures.fractions(pictures.read(path)), expected, atol=0.501 / 65535
        )
    assert len(list(folders["back"].iterdir())) == 4
