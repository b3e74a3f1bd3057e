"""The command line's verb for pictures."""

from __future__ import annotations

import json
from pathlib import Path

import bpy
import numpy as np
import pytest
from command_line_files import empty, run

QUICK = ["--bands", "3", "--steps", "8"]


@pytest.fixture(autouse=True)
def _leave_an_empty_file():
    yield
    empty()


def picture(path: Path) -> Path:
    """A disc with faint noise, as an RGB picture."""
    y, x = np.mgrid[:40, :50]
    values = np.full((40, 50, 3), 90.0)
    values[np.hypot(x - 25, y - 20) < 12] = (220, 160, 60)
    values += np.random.default_rng(0).normal(0, 6, values.shape)
    image = bpy.data.images.new("Picture", 50, 40)
    rows = np.dstack([values.clip(0, 255) / 255, np.ones((40, 50))])[::-1]
    image.pixels.foreach_set(rows.astype(np.float32).ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return path


def pixels(path: Path) -> np.ndarray:
    image = bpy.data.images.load(str(path))
    flat = np.empty(40 * 50 * 4, dtype=np.float32)
    image.pixels.foreach_get(flat)
    bpy.data.images.remove(image)
    return 255 * flat.reshape(40, 50, 4)[::-1, :, :3].astype(float)


def test_all_gains_at_1_give_the_picture_back(tmp_path: Path):
    source, target = picture(tmp_path / "in.png"), tmp_path / "out.png"
    assert run(["image", str(source), "-o", str(target), *QUICK]) == 0
    assert np.abs(pixels(source) - pixels(target)).max() <= 1


def test_without_the_finest_band_noise_is_gone_and_the_edge_is_not(tmp_path: Path, capfd):
    source, target = picture(tmp_path / "in.png"), tmp_path / "out.png"
    gains = ["--gain", "1=0", "--gain", "2=0", "--finest", "0.5", "--largest", "20"]
    for metric in ("flat", "surface"):
        options = [*QUICK, *gains, "--exact", "--metric", metric]
        assert run(["image", str(source), "-o", str(target), *options]) == 0
        before, after = pixels(source), pixels(target)
        assert after[15:25, 20:30].std(axis=(0, 1)).max() < 0.3 * before[15:25, 20:30].std()
        assert after[20, 20, 0] - after[20, 8, 0] > 90
    assert f"{source}: wrote {target}" in capfd.readouterr().err


def test_luminance_keeps_the_differences_of_the_channels(tmp_path: Path):
    source, target = picture(tmp_path / "in.png"), tmp_path / "out.png"
    assert (
        run(["image", str(source), "-o", str(target), *QUICK, "--luminance", "--gain", "1=0"]) == 0
    )
    before, after = pixels(source), pixels(target)
    assert np.abs(before - after).mean() > 2
    for channel in (0, 1):
        difference = np.diff(before[..., channel : channel + 2], axis=2)
        assert np.abs(np.diff(after[..., channel : channel + 2], axis=2) - difference).max() <= 2


def test_the_report_tells_what_was_read_done_and_lost(tmp_path: Path):
    source, target = picture(tmp_path / "in.png"), tmp_path / "out.exr"
    report = tmp_path / "report.jsonl"
    options = [*QUICK, "--gain", "1=0", "--report", str(report)]
    assert run(["image", str(source), "-o", str(target), *options]) == 0
    (line,) = map(json.loads, report.read_text().splitlines())
    assert (line["status"], line["output"]) == ("done", str(target))
    assert line["read"] == {
        "format": "PNG", "width": 50, "height": 40, "depth": "8", "channels": 3,
        "colorspace": "sRGB",
    }  # fmt: skip
    assert line["done"]["settings"]["bands"] == 3
    assert line["warnings"] == ["its colors were converted from sRGB to Linear Rec.709"]


def test_a_folder_gets_pictures_of_another_format(tmp_path: Path):
    names = [str(picture(tmp_path / name)) for name in ("one.png", "two.png")]
    folder = tmp_path / "out"
    folder.mkdir()
    assert run(["image", *names, "-o", str(folder), "--format", "TIF", *QUICK]) == 0
    assert sorted(path.name for path in folder.iterdir()) == ["one.tif", "two.tif"]


def test_failures_and_wrong_arguments(tmp_path: Path, capfd):
    good = picture(tmp_path / "good.png")
    broken = tmp_path / "broken.png"
    broken.write_text("rubbish")
    folder = tmp_path / "out"
    folder.mkdir()
    missing = tmp_path / "missing.jpg"
    names = [str(path) for path in (broken, missing, good)]
    assert run(["image", *names, "-o", str(folder), *QUICK]) == 1
    assert [path.name for path in folder.iterdir()] == ["good.png"]
    errors = capfd.readouterr().err
    assert f"{missing}: error: there is no such file" in errors
    assert f"{broken}: error: broken.png has no pixels that can be read" in errors
    for arguments, message in (
        (names, "several inputs need a folder"),
        ([str(good), "-o", str(good)], "an input would be overwritten"),
        ([str(good), "-o", str(folder / "a.xyz")], "pictures are written as"),
        ([str(good), "-o", str(tmp_path / "no" / "a.png")], "there is no folder"),
        ([str(good), "-o", str(folder), "--gain", "6=0"], "there is no band 6 among 5"),
        ([str(good), "-o", str(folder), "--height", "0"], "'0' is not a number"),
        ([str(good), "-o", str(folder), "--depth", "half"], "depth of a .png is 8 or 16, not half"),
        ([str(good), "-o", str(tmp_path / "a.png"), "--format", "tif"], "--format goes with -o"),
        ([str(good), "-o", str(folder), "--format", "gif"], "choose another with --format"),
        ([str(good), "-o", str(folder), "--colorspace", "RGB"], "there is no color space 'RGB'"),
        ([str(good), "-o", str(folder), "--quality", "0"], "'0' is not a number from 1 to 100"),
        ([str(good), str(tmp_path / "x" / "good.png"), "-o", str(folder)], "two inputs would"),
    ):
        output = [] if "-o" in arguments else ["-o", str(tmp_path / "a.png")]
        assert run(["image", *arguments, *output]) == 2
        assert message in capfd.readouterr().err
