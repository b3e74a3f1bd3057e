"""The notebooks of docs/ run as they stand, on small meshes."""

from __future__ import annotations

import json
import re
from pathlib import Path

import IPython.display  # noqa: F401  # tools/release/lacking.py then tells that it is not there
import pytest
from own_process import output

NOTEBOOKS = Path(__file__).resolve().parents[2] / "docs" / "notebooks"


# What a process does with a notebook: it tells what was displayed after what was printed.
RUN = """
import json, os, sys
import IPython.display
import matplotlib

folder, name, line, other = json.loads({arguments!r})
os.chdir(folder)
matplotlib.use("Agg")
shown = []
IPython.display.display = lambda page: shown.append(page.data)
names = {{}}
for cell in json.load(open(name, encoding="utf-8"))["cells"]:
    if cell["cell_type"] == "code":
        exec("".join(cell["source"]).replace(line, other), names)
print({end!r} + json.dumps(shown), flush=True)
os._exit(0)  # whatever serves its views
"""
END = "what was displayed: "


def run(name: str, line: str, other: str) -> tuple[str, list[str]]:
    """What the cells of a notebook print and display, with one line of theirs replaced.

    In a process of its own, as PyVista's views change how a process takes signals.
    """
    cells = json.loads((NOTEBOOKS / name).read_text(encoding="utf-8"))["cells"]
    assert not any(cell.get("outputs") for cell in cells)
    sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    assert sum(line in source for source in sources) == 1
    arguments = json.dumps([str(NOTEBOOKS), name, line, other])
    told, shown = output(RUN.format(arguments=arguments, end=END), 600).split(END)
    return told, json.loads(shown)


def test_the_notebook_on_sets_runs():
    told, _ = run("sets.ipynb", "VERTICES = 10_242", "VERTICES = 2_562")
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


def test_the_notebook_of_figures_shows_what_the_paper_says():
    told, seen = run("figures.ipynb", "DETAIL = 5", "DETAIL = 4")

    peak, theory = map(
        float, re.findall(r"vanishes at t = ([.\d]+), in theory at ([.\d]+)", told)[0]
    )
    assert peak == pytest.approx(theory, abs=0.03)
    rates = re.findall(r"\w+: rate ([.\d]+), in theory ([.\d]+)", told)
    assert len(rates) == 2
    assert all(float(rate) == pytest.approx(float(right), rel=0.04) for rate, right in rates)
    counts = [int(count) for count in re.findall(r"(\d+) values, to a tenth", told)]
    assert counts == sorted(counts, reverse=True)
    assert counts[2] <= 4
    assert counts[3] == 1
    found = re.findall(r"(\w+): TV ([.\d]+), (\d+)% of", told)
    (_, stretched, few), (_, least, most) = found
    assert float(least) < 0.6 * float(stretched)
    assert int(most) > 3 * int(few)
    corner, middle = map(float, re.findall(r"t = 5: corner ([.\d]+), middle ([.\d]+)", told)[0])
    assert corner < 0.7 * middle

    assert [page.count("<iframe title=") for page in seen] == [1, 1, 1]
    assert all("OfflineLocalView.load" in page for page in seen)
