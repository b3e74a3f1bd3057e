"""The notebook of docs/ runs as it stands, on a small mesh."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOK = ROOT / "docs" / "notebooks" / "sets.ipynb"


def test_the_notebook_on_sets_runs(capsys, monkeypatch):
    monkeypatch.chdir(NOTEBOOK.parent)
    monkeypatch.setattr(sys, "path", list(sys.path))
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    assert sum("VERTICES = 10_242" in source for source in sources) == 1
    names: dict[str, object] = {}
    for source in sources:
        exec(source.replace("VERTICES = 10_242", "VERTICES = 2_562"), names)
    told = capsys.readouterr().out
    errors = {
        (kind, elements): float(error)
        for kind, elements, error in re.findall(r"(\w+), on (\w+): ([-+.\d]+) %", told)
    }
    assert all(abs(errors[kind, "edges"]) < 1 for kind in ("regular", "jittered"))
    assert all(errors[kind, "vertices"] > 3 for kind in ("regular", "jittered"))
    assert "[1, 1, 1] 4.85" in told
    perimeter, circle = map(float, re.findall(r"([.\d]+), where the circle has ([.\d]+)", told)[0])
    assert perimeter == pytest.approx(circle, rel=0.02)
    assert len(re.findall(r"\| (?:yes|no): ", told)) == 5
