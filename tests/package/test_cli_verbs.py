"""flow, deform, segment, accuracy, and gains that are clamped or limited, without Blender."""

from __future__ import annotations

import csv
import json
from io import StringIO
from pathlib import Path

import meshio
import numpy as np
import pytest
import spectral_tv
import trimesh
from shapes import bumpy_sphere
from spectral_tv.cli.formats import with_colors, with_numbers
from spectral_tv.cli.reading import read
from spectral_tv.cli.verbs import run

VERTICES, TRIANGLES = bumpy_sphere(3)
TOP = (VERTICES[:, 2] > 0.5).astype(float)


def written(path: Path, **values: np.ndarray) -> str:
    mesh = meshio.Mesh(VERTICES, [("triangle", TRIANGLES.astype(np.int32))], values)
    mesh.write(path)
    return str(path)


def numbers_of(path: Path) -> dict[str, np.ndarray]:
    if path.suffix == ".npz":
        return dict(np.load(path))
    return dict(read(path).values)


@pytest.mark.parametrize("suffix", with_numbers())
def test_a_flow_is_written_beside_the_numbers(suffix, tmp_path):
    source, target = written(tmp_path / "in.vtu", top=TOP), tmp_path / f"out{suffix}"
    assert run(["flow", source, "-o", str(target), "--steps", "8", "--size", "30"]) == 0
    found = numbers_of(target)
    if suffix != ".npz":
        np.testing.assert_array_equal(found["top"], TOP)
    flowed = found["top_flow"]
    areas = spectral_tv.Mesh(VERTICES, TRIANGLES).vertex_areas
    assert flowed @ areas == pytest.approx(TOP @ areas, rel=1e-6)  # the mean stays
    assert np.ptp(flowed) < 0.9 * np.ptp(TOP)


def test_bands_and_rest_add_up_whatever_has_how_many_channels(tmp_path):
    values = np.column_stack([TOP, VERTICES[:, 0], VERTICES[:, 1] ** 2])
    source, target = written(tmp_path / "in.vtu", many=values, top=TOP), tmp_path / "out.vtu"
    options = ["--result", "bands", "--bands", "3", "--steps", "8"]
    for name, expected in (("many", values), ("top", TOP)):
        assert run(["flow", source, "-o", str(target), "--source", name, *options]) == 0
        found = numbers_of(target)
        bands = [found[f"{name}_band_{number}"] for number in (1, 2, 3)]
        np.testing.assert_allclose(sum(bands) + found[f"{name}_rest"], expected, atol=1e-9)
    assert run(["flow", source, "-o", str(tmp_path / "o.ply"), "--source", "many", *options]) == 0
    np.testing.assert_allclose(numbers_of(tmp_path / "o.ply")["many_y"], VERTICES[:, 0])


def test_a_filter_has_gains(tmp_path, capfd):
    source, target = written(tmp_path / "in.vtu", top=TOP), tmp_path / "out.vtu"
    options = ["--result", "filter", "--steps", "8"]
    assert run(["flow", source, "-o", str(target), *options]) == 0
    assert "the filter changes nothing" in capfd.readouterr().err
    np.testing.assert_allclose(numbers_of(target)["top_filtered"], TOP, atol=1e-9)
    assert run(["flow", source, "-o", str(target), *options, "--gain", "1=0"]) == 0
    assert np.abs(numbers_of(target)["top_filtered"] - TOP).max() > 1e-3


def colored(path: Path) -> np.ndarray:
    colors = np.zeros((len(VERTICES), 4), np.uint8)
    colors[:, 0], colors[:, 1], colors[:, 3] = 40 + 200 * TOP, 90, 255
    made = trimesh.Trimesh(VERTICES, TRIANGLES, process=False, vertex_colors=colors)
    made.export(path)
    return colors


@pytest.mark.parametrize("suffix", with_colors())
def test_colors_are_flowed_in_place(suffix, tmp_path):
    before = colored(tmp_path / "in.ply")
    target = tmp_path / f"out{suffix}"
    options = ["--kind", "color", "--size", "40", "--steps", "8"]
    assert run(["flow", str(tmp_path / "in.ply"), "-o", str(target), *options]) == 0
    after = read(target).colors
    assert np.ptp(after[:, 0]) < 0.9 * np.ptp(before[:, 0])
    np.testing.assert_array_equal(after[:, 1], 90)  # one value flows nowhere


def test_what_cannot_be_flowed_is_told(tmp_path, capfd):
    source = written(tmp_path / "in.vtu", top=TOP, other=TOP, broken=np.where(TOP > 0, np.nan, 0))
    output = ["-o", str(tmp_path / "out.vtu")]
    for options, code, text in (
        ([], 1, "name the numbers at its vertices by --source; there are: top, other, broken"),
        (["--source", "x"], 1, "no numbers 'x' at its vertices"),
        (["--source", "broken"], 1, "'broken' is not a finite number at vertex"),
        (["--kind", "color"], 1, "it has no vertex colors"),
        (["--kind", "color", "--source", "top"], 2, "--source goes with --kind attribute"),
        (["--gain", "1=0"], 2, "--gain and --curve go with --result filter"),
        (["--law", "heat", "--elements", "edges"], 2, "--elements goes with --law tv"),
        (["--no-exact", "--elements", "edges"], 2, "--elements goes with --exact"),
        (["--size", "0"], 2, "not a number from 0.01 to 100"),
    ):
        assert run(["flow", source, *output, *options]) == code
        assert text in capfd.readouterr().err
    assert run(["flow", source, "-o", str(tmp_path / "out.stl"), "--source", "top"]) == 2
    assert "a .stl does not hold numbers at its vertices; .msh" in capfd.readouterr().err
    assert not list(tmp_path.glob("out*"))


def test_parts_are_moved_and_held(tmp_path, capfd):
    pinned = (VERTICES[:, 2] < -0.5).astype(float)
    source = written(tmp_path / "in.vtu", head=TOP, foot=pinned)
    offset = np.array([0.1, 0, 0.2])
    parts = ["--pin", "foot", "--move", "head:0.1,0,0.2"]
    for suffix, options in ((".ply", ["--unturned"]), (".vtu", ["--algorithm", "convex"])):
        target = tmp_path / f"out{suffix}"
        assert run(["deform", source, "-o", str(target), *parts, *options]) == 0
        moved = read(target).vertices - VERTICES
        np.testing.assert_allclose(moved[TOP > 0], np.tile(offset, (int(TOP.sum()), 1)), atol=1e-6)
        np.testing.assert_allclose(moved[pinned > 0], 0, atol=1e-6)
    assert "deformed to within" in capfd.readouterr().err
    np.testing.assert_allclose(numbers_of(tmp_path / "out.vtu")["deformation"], moved, atol=1e-9)
    assert run(["deform", source, "-o", str(tmp_path / "free.off"), *parts]) == 0
    free = read(tmp_path / "free.off").vertices - VERTICES  # its middle moves by the offset
    np.testing.assert_allclose(free[TOP > 0].mean(axis=0), offset, atol=1e-4)


def test_regions_are_of_the_bounding_box(tmp_path):
    source, target = written(tmp_path / "in.ply"), tmp_path / "out.off"
    parts = ["--pin", "z<20%", "--move", "z>80%:0,0,1", "--softness", "5"]
    assert run(["deform", source, "-o", str(target), *parts]) == 0
    along = (VERTICES[:, 2] - VERTICES[:, 2].min()) / np.ptp(VERTICES[:, 2])
    moved = (read(target).vertices - VERTICES)[:, 2]
    np.testing.assert_allclose(moved[along < 0.2], 0, atol=1e-6)
    np.testing.assert_allclose(moved[along > 0.8], 1, atol=1e-6)


def test_what_cannot_be_moved_is_told(tmp_path, capfd):
    source = written(tmp_path / "in.vtu", head=TOP, none=0 * TOP, wild=3 * TOP)
    output = ["-o", str(tmp_path / "out.vtu")]
    for options, code, text in (
        ([], 2, "say what moves: --move"),
        (["--pin", "head"], 2, "--pin alone moves nothing"),
        (["--move", "head:1,2"], 2, "is not WHERE:DX,DY,DZ"),
        (["--move", "tail:0,0,1"], 1, "no numbers 'tail' at its vertices; there are: head, none"),
        (["--move", "none:0,0,1"], 1, "the numbers 'none' are 0 at every vertex"),
        (["--move", "z>100%:0,0,1"], 1, "the region 'z>100%' holds no vertex"),
        (["--pin", "z<90%", "--move", "head:0,0,1"], 1, "which go different ways"),
        (["--move", "head:0,0,1", "--algorithm", "paper", "--softness", "1"], 2, "--softness goes"),
        (["--pin", "z<5%", "--move", "wild:0,0,0.1"], 0, "numbers 'wild' are cut off at 0 and 1"),
    ):
        assert run(["deform", source, *output, *options]) == code
        assert text in capfd.readouterr().err


def test_parts_of_poses_have_the_same_numbers(tmp_path, capfd):
    bent = VERTICES @ np.array([[0, 1.0, 0], [0, 0, 1], [1, 0, 0]]) * 3
    for name, vertices in (("one", VERTICES), ("two", bent)):
        trimesh.Trimesh(vertices, TRIANGLES, process=False).export(tmp_path / f"{name}.off")
    (tmp_path / "out").mkdir()
    report = tmp_path / "report.jsonl"
    sources = [str(tmp_path / name) for name in ("one.off", "missing.off", "two.off")]
    places = ["-o", str(tmp_path / "out"), "--format", "vtu", "--report", str(report)]
    assert run(["segment", *sources, *places, "--segments", "3", "--steps", "8"]) == 1
    one, two = (numbers_of(tmp_path / "out" / f"{name}.vtu")["segment"] for name in ("one", "two"))
    assert set(one) == {1, 2, 3}
    assert (one == two).mean() > 0.99
    expected = spectral_tv.cosegment(
        [
            spectral_tv.decompose(spectral_tv.Mesh(vertices, TRIANGLES), "m2", steps=8)
            for vertices in (read(Path(sources[0])).vertices, read(Path(sources[2])).vertices)
        ],
        3,
    )
    np.testing.assert_array_equal(one, expected[0] + 1)
    assert "labelled without" in capfd.readouterr().err
    lines = [json.loads(line) for line in report.read_text().splitlines()]
    assert [line["status"] for line in lines] == ["done", "failed", "done"]
    assert lines[0]["done"]["together"] == [sources[0], sources[2]]


def test_parts_are_colors_where_there_are_no_numbers(tmp_path, capfd):
    source = written(tmp_path / "in.ply")
    target = tmp_path / "out.glb"
    assert run(["segment", source, "-o", str(target), "--segments", "4", "--steps", "8"]) == 0
    assert len(np.unique(read(target).colors, axis=0)) == 4
    assert run(["segment", source, "-o", str(tmp_path / "out.stl")]) == 2
    assert "a .stl does not hold numbers or colors" in capfd.readouterr().err


def test_the_accuracy_is_a_table_and_numbers(tmp_path, capfd):
    source, report = written(tmp_path / "in.ply"), tmp_path / "report.jsonl"
    options = ["--steps", "8", "--bands", "3", "--report", str(report)]
    assert run(["accuracy", source, *options]) == 0
    told = capfd.readouterr()
    rows = list(csv.DictReader(StringIO(told.out)))
    assert [row["Steps"] for row in rows] == ["2", "4", "8"]
    errors = [float(row["Error of Bands"]) for row in rows]
    assert errors[0] > errors[-1] > 0
    assert "8 steps: bands" in told.err
    assert json.loads(report.read_text())["done"]["accuracy"][-1]["Steps"] == 8
    assert run(["accuracy", source, "-o", str(tmp_path / "t.csv"), *options]) == 0
    assert (tmp_path / "t.csv").read_text() == told.out
    assert run(["accuracy", source, "-o", str(tmp_path / "t.vtu"), *options]) == 0
    mesh = spectral_tv.Mesh(VERTICES, TRIANGLES)
    found = numbers_of(tmp_path / "t.vtu")["error_bands"]
    mean = np.sqrt(found**2 @ mesh.vertex_areas / mesh.area / mesh.area)
    assert 100 * mean == pytest.approx(errors[-1], rel=0.01)
    capfd.readouterr()
    assert run(["accuracy", source, "--method", "lb"]) == 2
    assert "takes no time steps" in capfd.readouterr().err


def test_gains_that_stretch_are_told_and_clamped(tmp_path, capfd):
    rough = VERTICES * (1 + 0.08 * np.random.default_rng(0).normal(size=(len(VERTICES), 1)))
    source, target = tmp_path / "in.ply", tmp_path / "out.npz"
    meshio.Mesh(rough, [("triangle", TRIANGLES.astype(np.int32))]).write(source)
    options = ["--steps", "8", "--bands", "3", "--gain", "all=5"]
    assert run(["decompose", str(source), "-o", str(target), *options]) == 0
    assert "; --safe clamps what they add" in capfd.readouterr().err
    mesh = spectral_tv.Mesh(rough, TRIANGLES)
    assert len(spectral_tv.folds(mesh, np.load(target)["filtered"] - rough).stretched)
    assert run(["decompose", str(source), "-o", str(target), *options, "--safe"]) == 0
    assert "of what the bands add" in capfd.readouterr().err
    found = np.load(target)
    np.testing.assert_allclose(found["filtered"], rough + found["safe"])
    np.testing.assert_array_equal(found["values"], [0, 0, 0, 1])
    folds = spectral_tv.folds(mesh, found["safe"])
    assert not len(folds.flipped)
    assert not len(folds.stretched)


def test_a_limit_holds_vertices_back(tmp_path, capfd):
    source, target = written(tmp_path / "in.ply"), tmp_path / "out.npz"
    options = ["--steps", "8", "--bands", "3", "--gain", "all=3", "--limit", "0.01"]
    assert run(["decompose", source, "-o", str(target), *options]) == 0
    moved = np.linalg.norm(np.load(target)["filtered"] - VERTICES, axis=1)
    assert moved.max() == pytest.approx(0.01)
    held = int((moved > 0.01 * (1 - 1e-9)).sum())
    assert f"{held} of {len(VERTICES)} vertices are held back at 0.01" in capfd.readouterr().err


def test_an_applied_look_has_no_bands(tmp_path):
    source = written(tmp_path / "in.ply")
    options = ["--steps", "8", "--bands", "3", "--gain", "1=0"]
    for suffix in (".vtu", ".glb"):
        plain, applied = tmp_path / f"plain{suffix}", tmp_path / f"applied{suffix}"
        assert run(["decompose", source, "-o", str(plain), *options]) == 0
        assert run(["decompose", source, "-o", str(applied), *options, "--apply"]) == 0
        assert np.abs(read(applied).vertices - VERTICES).max() > 1e-4
        assert applied.stat().st_size < plain.stat().st_size
    assert not numbers_of(tmp_path / "applied.vtu")
    assert b'"targets"' in (tmp_path / "plain.glb").read_bytes()
    assert b'"targets"' not in (tmp_path / "applied.glb").read_bytes()
