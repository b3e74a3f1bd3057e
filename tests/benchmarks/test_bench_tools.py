"""The benchmark's tools: what goes into the page, and what counts as slower."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import reference

from tools.bench.instructions import STORED, TOLERANCE, differences
from tools.bench.meshes import bumpy_sphere, sphere
from tools.bench.operators import gradient_and_areas
from tools.bench.page import TABLES, Page

ROOT = Path(__file__).resolve().parents[2]


def test_the_page_of_the_docs_has_a_place_for_every_table():
    Page(ROOT / "docs" / "benchmarks.md")


def test_a_table_replaces_what_is_between_its_markers(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    path = tmp_path / "page.md"
    places = {name: f"<!-- {name} -->\nold\n<!-- /{name} -->" for name in TABLES}
    path.write_text("\n\n".join(places.values()), encoding="utf-8")
    for value in (1, 2):
        with Page(path).table("growth", "Caption", "a | b") as row:
            row(value, "x")
    page = path.read_text(encoding="utf-8")
    assert page.count("old") == len(TABLES) - 1
    assert page.count("| a | b |\n| --- | --- |\n| 2 | x |\n\nCaption") == 1
    assert "| 1 | x |" not in page


def test_a_page_without_the_markers_is_refused(tmp_path):
    path = tmp_path / "page.md"
    path.write_text("# Nothing", encoding="utf-8")
    with pytest.raises(SystemExit, match="lacks the markers of machine, steps"):
        Page(path)


def test_slower_works_are_named_and_faster_ones_are_not():
    before = {"a": 1000, "b": 1000, "c": 1000}
    within = int(1000 * (1 + TOLERANCE))
    assert differences({"a": within, "b": 500, "c": 1000}, before) == []
    (problem,) = differences({"a": within + 1, "b": 500, "c": 1000}, before)
    assert problem.startswith("a: +2.10% instructions")


def test_works_that_are_in_one_run_only_are_named():
    assert differences({"new": 1}, {"old": 1}) == [
        "new: not stored; use --store",
        "old: stored, but no longer a work",
    ]
    assert differences({"a": 1}, {"a": 1, "b": 1}, is_complete=False) == []


def test_the_stored_run_has_all_works():
    source = (ROOT / "rust" / "spectral_tv" / "benches" / "works.rs").read_text(encoding="utf-8")
    stored = json.loads(STORED.read_text(encoding="utf-8"))["instructions"]
    assert f"[Work; {len(stored)}]" in source
    assert all(f'("{name}", ' in source for name in stored)


@pytest.mark.parametrize("frequency", [1, 2, 7, 20])
def test_spheres_are_closed_and_face_outwards(frequency):
    vertices, triangles = sphere(frequency)
    assert len(vertices) == 10 * frequency**2 + 2
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    assert (counts == 2).all()
    assert (np.linalg.det(vertices[triangles]) > 0).all()


def test_the_gradient_that_is_measured_against_is_the_reference():
    vertices, triangles = bumpy_sphere(8)
    gradient, areas = gradient_and_areas(vertices, triangles)
    ops = reference.Operators(vertices, triangles)
    np.testing.assert_allclose(areas, ops.face_areas, rtol=1e-12)
    np.testing.assert_allclose(gradient @ vertices, ops.gradient @ vertices, atol=1e-10)
