"""image without Blender: what comes out of files that Pillow, pypng and tifffile wrote."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import png
import pytest
import tifffile
from PIL import Image, ImageCms
from spectral_tv.cli.verbs import run

STEPS = ["--steps", "8", "--bands", "3"]
KEEPS = ["image", *STEPS]


def colors(channels: int = 3) -> np.ndarray:
    """A disc with noise, in [0, 1]."""
    y, x = np.mgrid[:24, :32]
    disc = 0.3 + 0.4 * (np.hypot(x - 14, y - 11) < 7)
    noise = 0.02 * np.random.default_rng(0).normal(size=(24, 32))
    return np.stack([disc + noise, disc**2, 1 - disc, 0.2 + 0.7 * (x > 5)][:channels], axis=-1)


def steps(values: np.ndarray, bits: int) -> np.ndarray:
    return np.rint(values * (2**bits - 1)).astype(np.uint8 if bits == 8 else np.uint16)


def write_png(path: Path, pixels: np.ndarray) -> None:
    height, width, count = pixels.shape
    writer = png.Writer(
        width, height, greyscale=count < 3, alpha=count in (2, 4), bitdepth=8 * pixels.itemsize
    )
    with path.open("wb") as file:
        writer.write(file, pixels.reshape(height, -1))


def read_png(path: Path) -> np.ndarray:
    width, height, rows, about = png.Reader(filename=str(path)).asDirect()
    return np.vstack([np.asarray(row) for row in rows]).reshape(height, width, about["planes"])


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_all_gains_at_1_give_every_value_back(bits, channels, tmp_path):
    values = colors(4)[..., [0, 3] if channels == 2 else slice(channels)][..., :channels]
    write_png(tmp_path / "in.png", steps(values, bits))
    for name in ("out.png", "out.tif"):
        assert run([*KEEPS, str(tmp_path / "in.png"), "-o", str(tmp_path / name)]) == 0
    np.testing.assert_array_equal(read_png(tmp_path / "out.png"), steps(values, bits))
    found = tifffile.imread(tmp_path / "out.tif").reshape(values.shape)
    np.testing.assert_array_equal(found, steps(values, bits))
    assert run([*KEEPS, str(tmp_path / "out.tif"), "-o", str(tmp_path / "back.png")]) == 0
    np.testing.assert_array_equal(read_png(tmp_path / "back.png"), steps(values, bits))


def test_without_the_finest_band_noise_is_gone(tmp_path):
    write_png(tmp_path / "in.png", steps(colors(), 16))
    options = [*STEPS, "--gain", "1=0", "--finest", "2"]
    places = [str(tmp_path / "in.png"), "-o", str(tmp_path / "out.png")]
    assert run(["image", *places, *options]) == 0
    inner = (slice(8, 14), slice(11, 17), 0)
    before, after = (read_png(tmp_path / name)[inner].std() for name in ("in.png", "out.png"))
    assert after < 0.5 * before


def test_webp_keeps_what_is_under_alpha_0(tmp_path):
    pixels = steps(colors(4), 8)
    pixels[:, :6, 3] = 0
    write_png(tmp_path / "in.png", pixels)
    assert run([*KEEPS, str(tmp_path / "in.png"), "-o", str(tmp_path / "out.webp")]) == 0
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "out.webp")), pixels)


def test_floats_stay_floats_and_become_srgb_in_integers(tmp_path, capfd):
    values = (0.5 * colors()).astype(np.float32)
    tifffile.imwrite(tmp_path / "in.tif", values, photometric="rgb", compression="zlib")
    for name in ("out.tif", "out.png"):
        assert run([*KEEPS, str(tmp_path / "in.tif"), "-o", str(tmp_path / name)]) == 0
    np.testing.assert_array_equal(tifffile.imread(tmp_path / "out.tif"), values)
    found = read_png(tmp_path / "out.png") / 65535
    above = np.where(values > 0.0031308, 1.055 * values ** (1 / 2.4) - 0.055, 12.92 * values)
    np.testing.assert_allclose(found, above, atol=2e-5)
    told = capfd.readouterr().err
    assert "its colors were converted from Linear Rec.709 to sRGB" in told
    options = ["--colorspace", "non-color", "--depth", "16"]
    places = [str(tmp_path / "in.tif"), "-o", str(tmp_path / "out.png")]
    assert run([*KEEPS, *places, *options]) == 0
    np.testing.assert_allclose(read_png(tmp_path / "out.png") / 65535, values, atol=1e-5)
    assert "converted" not in capfd.readouterr().err


def test_profile_and_resolution_are_kept_and_exif_is_told(tmp_path, capfd):
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    exif = Image.Exif()
    exif[0x010F], exif[0x0112] = "Maker", 6
    Image.fromarray(steps(colors(), 8)).save(
        tmp_path / "in.jpg", icc_profile=profile, dpi=(200, 200), exif=exif
    )
    for name in ("out.png", "out.jpg", "out.tif", "out.webp", "deep.png"):
        depth = ["--depth", "16"] if name == "deep.png" else []
        assert run([*KEEPS, str(tmp_path / "in.jpg"), "-o", str(tmp_path / name), *depth]) == 0
        told = capfd.readouterr().err
        with Image.open(tmp_path / name) as found:
            assert found.info["icc_profile"] == profile
            assert found.size == (24, 32)
            if name != "out.webp":
                assert found.info["dpi"][0] == pytest.approx(200, abs=0.1)
        assert ("its resolution of 200 dpi is not kept" in told) == (name == "out.webp")
        assert "not kept: EXIF data" in told
        assert "it was turned upright" in told


def test_what_a_format_does_not_hold_is_told(tmp_path, capfd):
    write_png(tmp_path / "in.png", steps(colors(4), 16))
    assert run([*KEEPS, str(tmp_path / "in.png"), "-o", str(tmp_path / "out.jpg")]) == 0
    told = capfd.readouterr().err
    assert "written with 8 bits; the input has 16 bits" in told
    assert "a .jpg has no alpha" in told


def test_bad_files_are_told_and_others_go_on(tmp_path, capfd):
    good = tmp_path / "good.png"
    write_png(good, steps(colors(), 8))
    (tmp_path / "torn.png").write_bytes(good.read_bytes()[:400])
    (tmp_path / "text.png").write_text("hello")
    Image.new("RGB", (1, 5)).save(tmp_path / "thin.png")
    tifffile.imwrite(tmp_path / "bits.tif", np.zeros((4, 4), np.uint32))
    (tmp_path / "out").mkdir()
    report = tmp_path / "report.jsonl"
    names = ["torn.png", "text.png", "thin.png", "bits.tif", "none.png", "good.png"]
    places = ["-o", str(tmp_path / "out"), "--format", "png", "--report", str(report)]
    assert run([*KEEPS, *(str(tmp_path / name) for name in names), *places, "--gain", "1=2"]) == 1
    lines = [json.loads(line) for line in report.read_text().splitlines()]
    for line, text in zip(
        lines,
        (
            "it is cut short",
            "pictures are read from files of the formats PNG, JPEG",
            "it has 1 × 5 pixels",
            "which is misread",
            "there is no such file",
        ),
        strict=False,
    ):
        assert text in line["error"]
    assert lines[-1]["status"] == "done"
    assert lines[-1]["done"]["settings"]["gains"] == [[1, 2.0]]
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["good.png"]


def test_wrong_arguments_end_with_2(tmp_path, capfd):
    good = tmp_path / "good.png"
    write_png(good, steps(colors(), 8))
    for name, options, text in (
        ("out.exr", [], "pictures are written as .png"),
        ("out.jpg", ["--depth", "16"], "the depth of a .jpg is 8, not 16"),
        ("out.png", ["--colorspace", "ACEScg"], "there are: sRGB, Linear Rec.709, Non-Color"),
        ("out.png", ["--bands", "9", "--steps", "4"], "9 bands need more than 4 steps"),
        ("good.png", [], "an input would be overwritten"),
    ):
        assert run(["image", str(good), "-o", str(tmp_path / name), *options]) == 2
        assert text in capfd.readouterr().err
