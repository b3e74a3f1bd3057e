"""Sequences on the command line without Blender: numbered files in, numbered files out."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import spectral_tv
import trimesh
from moving_shapes import frames, remeshed_frames
from shapes import Mesh
from spectral_tv.cli.verbs import run

SMALL = ["--bands", "4", "--steps", "8"]
GAINS = ["--gain", "1=0", "--gain", "2=0", "--gain", "3=1.5"]
VALUES = (-1, -1, 0.5, 0)
NUMBERS = (8, 9, 10, 12)


def write_folder(folder: Path, shapes: list[Mesh]) -> Path:
    folder.mkdir()
    for number, shape in zip(NUMBERS, shapes, strict=True):
        trimesh.Trimesh(*shape, process=False).export(folder / f"body{number}.ply")
    return folder


def expected(shapes: list[Mesh], area: float | None = None) -> list[np.ndarray]:
    made = [spectral_tv.Mesh(*shape) for shape in shapes]
    area = made[0].area if area is None else area
    scales = (area * scale for scale in spectral_tv.default_scales("m1"))
    options = {"area": area, "keeps_limbs": True, "soft_edges": 0.3}
    splits = spectral_tv.decompose_sequence(
        made, "m1", spectral_tv.graded_times(*scales, 8), **options
    )
    bands = [split.bands(split.band_edges(4), 1.0) for split in splits]
    pairs = zip(shapes, bands, strict=True)
    return [vertices + np.tensordot(VALUES, each, 1) for (vertices, _), each in pairs]


def vertices_of(path: Path) -> np.ndarray:
    return trimesh.load_mesh(path, process=False).vertices


@pytest.mark.parametrize("keeps_vertices", [True, False])
def test_numbered_files_are_filtered_by_the_scales_of_the_first(tmp_path: Path, keeps_vertices):
    made = frames(4, 0.02, subdivisions=3)
    shapes = made if keeps_vertices else remeshed_frames(4, 0.02, vertices=700)
    folder, results = write_folder(tmp_path / "frames", shapes), tmp_path / "results"
    results.mkdir()
    report = tmp_path / "report.jsonl"
    options = ["--frames", "all", "--report", str(report), *SMALL, *GAINS]
    assert run(["decompose", str(folder), "-o", str(results), *options]) == 0
    names = [f"body_{number:04d}.ply" for number in NUMBERS]
    assert [path.name for path in sorted(results.iterdir())] == names
    for name, wanted in zip(names, expected(shapes), strict=True):
        np.testing.assert_allclose(vertices_of(results / name), wanted, atol=1e-6)
    entry = json.loads(report.read_text())
    assert entry["read"]["frames"] == [8, 12] and len(entry["output"]) == 4
    some = ["--frames", "8-12:4", *SMALL, *GAINS]
    assert run(["decompose", str(folder), "-o", str(tmp_path / "some.npz"), *some]) == 0
    assert sorted(path.name for path in tmp_path.glob("*.npz")) == [
        "some_0008.npz",
        "some_0012.npz",
    ]


def test_sizes_may_be_relative_to_all_frames(tmp_path: Path):
    vertices, faces = frames(1, 0.02, subdivisions=3)[0]
    shapes = [(scale * vertices, faces) for scale in (0.5, 1, 1, 2)]
    folder, results = write_folder(tmp_path / "frames", shapes), tmp_path / "results"
    results.mkdir()
    area = spectral_tv.Mesh(*shapes[1]).area
    for scales, wanted in (("first", expected(shapes)), ("all", expected(shapes, area))):
        options = ["--frames", "all", "--scales", scales, *SMALL, *GAINS]
        assert run(["decompose", str(folder), "-o", str(results), *options]) == 0
        for number, shape in zip(NUMBERS, wanted, strict=True):
            found = vertices_of(results / f"body_{number:04d}.ply")
            np.testing.assert_allclose(found, shape, atol=1e-5)


def test_what_is_no_sequence_is_refused(tmp_path: Path, capfd):
    folder = write_folder(tmp_path / "frames", frames(4, 0.02, subdivisions=1))
    (tmp_path / "results").mkdir()
    (folder / "body13.ply").write_text("no mesh")
    out = ["-o", str(tmp_path / "results")]
    file = str(folder / "body8.ply")
    for arguments, code, message in (
        ([str(folder), "--frames", "all", "-o", str(folder)], 2, "would be among the frames"),
        ([file, "--frames", "all", *out], 2, "takes a folder of numbered files"),
        ([file, "--scales", "all", *out], 2, "--scales goes with --frames"),
        ([str(folder), "--frames", "8-11", *out], 1, "there is no file of frame 11"),
        ([str(folder), "--frames", "12-13", *out], 1, "body13.ply: it cannot be read"),
    ):
        assert run(["decompose", *arguments, *SMALL]) == code
        assert message in capfd.readouterr().err
