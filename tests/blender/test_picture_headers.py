"""What picture files hold beside their values: kept, heeded or told; and files that are broken."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenEXR
import pictures
import pytest
import tifffile
from command_line_files import empty, run
from PIL import Image, ImageCms, ImageOps

KEEP = ["--bands", "2", "--steps", "4", "--gain", "all=1"]
EXIF_ORIENTATION = 274


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


@pytest.fixture
def keep(capfd):
    """Filters nothing; returns what was told."""

    def run_it(source: Path, target: Path, *options: str, code: int = 0) -> str:
        capfd.readouterr()
        assert run(["image", str(source), "-o", str(target), *KEEP, *options]) == code
        lines = capfd.readouterr().err.splitlines()
        return "\n".join(
            line.removeprefix(f"{source}: ")
            for line in lines
            if line.startswith(f"{source}: ")
            and not line.endswith((" %", f"wrote {target}", "it keeps every band"))
        )

    return run_it


def colors(depth: str = "8", channels: int = 3) -> np.ndarray:
    return pictures.values(channels, depth, False)


def profile(name: str) -> bytes:
    """An ICC profile of that name, for colors."""
    found = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    wide = name.ljust(len("sRGB built-in"))
    return found.replace("sRGB built-in".encode("utf-16-be"), wide.encode("utf-16-be"))


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("suffix", [".png", ".jpg", ".webp", ".tif"])
def test_pictures_come_out_as_they_are_seen(suffix, orientation, tmp_path, keep):
    """Whatever way a camera was held: upright, as the file has no such mark any more."""
    exif = Image.Exif()
    exif[EXIF_ORIENTATION] = orientation
    source = tmp_path / f"in{suffix}"
    if suffix == ".tif":
        tags = [(EXIF_ORIENTATION, 3, 1, orientation, True)]
        pictures.write(source, colors(), extratags=tags)
    else:
        settings = {".webp": {"lossless": True}, ".jpg": {"quality": 95}}.get(suffix, {})
        Image.fromarray(colors()).save(source, exif=exif, **settings)
    told = keep(source, tmp_path / "out.png")
    seen = np.asarray(ImageOps.exif_transpose(Image.open(source)))
    np.testing.assert_allclose(pictures.read(tmp_path / "out.png"), seen, atol=3)
    assert ("turned upright" in told) == (orientation > 1)
    assert "EXIF" not in told


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".tif"])
@pytest.mark.parametrize("goal", [".png", ".jpg", ".tif", ".webp", ".exr"])
def test_a_color_profile_goes_along_or_is_told(suffix, goal, tmp_path, keep):
    embedded = profile("Wide")
    source, target = tmp_path / f"in{suffix}", tmp_path / f"out{goal}"
    Image.fromarray(colors()).save(source, icc_profile=embedded)
    told = keep(source, target)
    if goal in (".webp", ".exr"):
        assert "its color profile 'Wide" in told and "colors were taken for sRGB" in told
    else:
        assert told == ""
        assert Image.open(target).info["icc_profile"] == embedded


def test_a_profile_of_srgb_is_nothing_to_tell_and_that_of_grey_stays_with_grey(tmp_path, keep):
    source = tmp_path / "in.png"
    Image.fromarray(colors()).save(source, icc_profile=profile("sRGB built-in"))
    assert keep(source, tmp_path / "out.webp") == ""
    grey = profile("Grey")[:16] + b"GRAY" + profile("Grey")[20:]
    Image.fromarray(colors("8", 1)[..., 0]).save(source, icc_profile=grey)
    assert keep(source, tmp_path / "out.png") == ""
    assert Image.open(tmp_path / "out.png").info["icc_profile"] == grey
    assert "its color profile 'Grey" in keep(source, tmp_path / "out.webp")


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".tif"])
def test_dots_per_inch_stay_or_are_told(suffix, tmp_path, keep):
    source = tmp_path / f"in{suffix}"
    Image.fromarray(colors()).save(source, dpi=(300, 200))
    for goal in (".png", ".jpg", ".tif"):
        assert keep(source, tmp_path / f"out{goal}") == ""
        found = Image.open(tmp_path / f"out{goal}").info["dpi"]
        np.testing.assert_allclose([float(each) for each in found], (300, 200), atol=0.1)
    assert "its resolution of 300 dpi is not kept" in keep(source, tmp_path / "out.webp")


def test_what_a_file_holds_besides_is_told(tmp_path, keep):
    exif = Image.Exif()
    exif[271] = "Maker"
    image = Image.fromarray(colors())
    other = image.rotate(180)
    image.save(tmp_path / "exif.jpg", exif=exif, xmp=b"<x/>")
    image.save(tmp_path / "moving.png", save_all=True, append_images=[other])
    image.convert("CMYK").save(tmp_path / "cmyk.tif")
    tifffile.imwrite(tmp_path / "pages.tif", np.stack([colors()] * 2), photometric="rgb")
    floats = np.random.default_rng(0).random((8, 9)).astype(np.float32)
    parts = dict.fromkeys("RGBZ", floats)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, parts) as file:
        file.write(str(tmp_path / "depth.exr"))
    for name, message in (
        ("exif.jpg", "not kept: EXIF data, XMP data"),
        ("moving.png", "not kept: all but the first of its pictures"),
        ("cmyk.tif", "its CMYK colors are read as red, green and blue"),
        ("pages.tif", "not kept: its further pages"),
        ("depth.exr", "not kept: its channels Z"),
    ):
        source = tmp_path / name
        assert keep(source, tmp_path / f"out{source.suffix}").startswith(message), name


@pytest.mark.parametrize(
    ("pixels", "suffix", "goal", "options", "message"),
    [
        (colors("16"), ".png", ".jpg", (), "written with 8 bits; the input has 16 bits"),
        (colors("16"), ".png", ".exr", ("--depth", "half"), "written with floats of 16 bits; the"),
        (colors("8", 4), ".png", ".jpg", (), "pixels that were transparent are shown in full"),
        (colors("8", 4), ".png", ".webp", (), "pixels under alpha 0 are not kept"),
        (colors("8", 4), ".png", ".exr", (), "pixels under alpha 0 are not kept"),
        (
            colors("8", 1),
            ".png",
            ".webp",
            (),
            "its grey becomes red, green and blue, as no grey is",
        ),
        (
            colors("8", 2),
            ".png",
            ".png",
            (),
            "its grey with alpha becomes red, green, blue and alpha, as no grey with alpha is "
            "written to a .png",
        ),
        (colors("half", 1), ".exr", ".exr", (), "blue, as no grey is written to an .exr"),
        (colors("8"), ".png", ".exr", (), "its colors were converted from sRGB to Linear Rec.709"),
        (colors("float"), ".exr", ".png", (), "converted from Linear Rec.709 to sRGB"),
        (colors("float"), ".exr", ".tif", (), "are in Linear Rec.709, but Blender will open it as"),
        (1e6 * colors("float"), ".exr", ".exr", ("--depth", "half"), "cut off at what floats of"),
    ],
)
def test_what_a_format_does_not_hold_is_told(
    pixels, suffix, goal, options, message, tmp_path, keep
):
    source = pictures.write(tmp_path / f"in{suffix}", pixels)
    assert message in keep(source, tmp_path / f"out{goal}", *options)


def test_pixels_beyond_black_and_white_are_counted_and_floats_keep_them(tmp_path, keep):
    pixels = np.full((10, 10, 3), 0.5, dtype=np.float32)
    pixels[0, :3], pixels[9, 9] = 7.5, -0.25
    source = pictures.write(tmp_path / "in.exr", pixels)
    told = keep(source, tmp_path / "out.png")
    assert "4 pixels (4 %) were cut off at what 16 bits hold; floats hold all" in told
    found = pictures.read(tmp_path / "out.png")
    assert found[0, 0, 0] == 65535 and found[9, 9, 0] == 0
    for goal in (".exr", ".tif"):
        assert "cut off" not in keep(source, tmp_path / f"out{goal}")
        np.testing.assert_array_equal(pictures.read(tmp_path / f"out{goal}"), pixels)


def test_a_suffix_that_is_wrong_is_told(tmp_path, keep):
    source = tmp_path / "in.png"
    Image.fromarray(colors()).save(source, format="JPEG")
    told = keep(source, tmp_path / "out.png")
    assert told == "it is a file of the format JPEG, whatever its name says"
    assert Image.open(tmp_path / "out.png").format == "PNG"


@pytest.mark.parametrize("name", ["in.png", "in.jpg", "in.webp", "in.tif", "in.exr"])
@pytest.mark.parametrize("part", [0.0, 0.02, 0.3, 0.6, 0.9, 0.999])
def test_files_that_are_cut_short_are_refused(name, part, tmp_path, keep):
    source = pictures.write(
        tmp_path / name, pictures.values(3, "half" if name == "in.exr" else "8", False, (60, 60))
    )
    data = source.read_bytes()
    source.write_bytes(data[: int(part * len(data))])
    told = keep(source, tmp_path / "out.png", code=1)
    assert told.startswith("error: ")
    assert any(
        text in told for text in ("cut short", "cut off", "makes no sense", "no pixels", "empty")
    )
    assert not (tmp_path / "out.png").exists()


def test_files_that_blender_would_misread_are_refused(tmp_path, keep):
    floats = np.random.default_rng(0).random((8, 9)).astype(np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    for name, channels in (("depth.exr", ["Z"]), ("layers.exr", ["a.R", "a.G", "a.B", "R"])):
        with OpenEXR.File(header, dict.fromkeys(channels, floats)) as file:
            file.write(str(tmp_path / name))
    image = Image.fromarray(colors())
    image.save(tmp_path / "moving.webp", save_all=True, append_images=[image.rotate(180)])
    image.save(tmp_path / "moving.gif", save_all=True, append_images=[image.rotate(180)])
    image.convert("1").save(tmp_path / "bits.tif")
    Image.fromarray(colors()[:1]).save(tmp_path / "line.png")
    for name, message in (
        ("depth.exr", "its channels Z are no colors"),
        ("layers.exr", "it has several layers; save one layer as an image of its own"),
        ("moving.webp", "it is animated, which is not read"),
        ("moving.gif", "moving.gif is a movie; open one of its frames as an image"),
        ("bits.tif", "its values have 1 bits, which is misread"),
        ("line.png", "line.png has 14 × 1 pixels, but 2 × 2 are needed"),
    ):
        assert message in keep(tmp_path / name, tmp_path / "out.png", code=1)


def test_colors_that_an_openexr_file_describes_stay_described(tmp_path, keep):
    primaries = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
    pixels = pictures.values(3, "half", True)
    source = pictures.write(tmp_path / "in.exr", pixels, chromaticities=primaries)
    keep(source, tmp_path / "out.exr")
    with OpenEXR.File(str(tmp_path / "out.exr")) as file:
        np.testing.assert_allclose(file.header()["chromaticities"], primaries, atol=1e-6)
    np.testing.assert_array_equal(pictures.read(tmp_path / "out.exr"), pixels)
    keep(source, tmp_path / "named.exr", "--colorspace", "Linear CIE-XYZ E")
    with OpenEXR.File(str(tmp_path / "named.exr")) as file:
        assert file.header().get("colorInteropID") != "lin_rec709_scene"


@pytest.mark.parametrize("dtype", ["uint32", "int32", "int16", "int8", "uint64", "complex64"])
def test_numbers_that_would_become_others_are_refused(dtype, tmp_path, keep):
    source, target = tmp_path / "in.tif", tmp_path / "out.tif"
    values = np.arange(20 * 30).reshape(20, 30) % 100
    tifffile.imwrite(source, values.astype(dtype), photometric="minisblack")
    told = keep(source, target, code=1)
    kind = "complex floats" if dtype[0] == "c" else f"integers of {np.dtype(dtype).itemsize * 8} b"
    assert kind in told
    assert not target.exists()


def test_digits_that_are_lost_of_floats_are_told(tmp_path, keep):
    source, target = tmp_path / "in.tif", tmp_path / "out.tif"
    values = 1000 + np.random.default_rng(0).random((20, 30))
    tifffile.imwrite(source, values, photometric="minisblack")
    assert "its floats of 64 bits are read with 32" in keep(source, target)
    np.testing.assert_array_equal(tifffile.imread(target), values.astype(np.float32))
