"""How true the rates of sets are, as a table: python -m tools.set_rates [--largest 41000].

The table is written into docs/sets.md, between its marks, and the picture of the convergence
beside the others. Sets and meshes are those of the tests.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import spectral_tv
from tqdm import tqdm

from .set_rates_picture import parsed, picture

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))
import set_meshes  # noqa: E402

if TYPE_CHECKING:
    from set_meshes import KnownSet

SIZES = (2_562, 10_242, 40_962)
STEPS = 24
MARKS = "<!-- rates -->\n", "<!-- /rates -->\n"


def extinction_error(known: KnownSet, elements: Literal["vertices", "edges"]) -> float:
    """How much too fast a set fades: the theory's time of extinction over that of its flow, less 1.

    Flowed is ψ, 1 on the set C and −|C|/|M∖C| off it; it is extinct at |C|/per(C).
    """
    mesh = spectral_tv.Mesh(*known.mesh)
    inside = mesh.vertex_areas[known.members].sum()
    psi = np.where(known.members, 1.0, -inside / (mesh.area - inside))
    expected = inside / known.perimeter
    times = np.linspace(0, 1.2 * expected, STEPS + 1)
    flow = spectral_tv.flow(mesh, psi, times, exact=True, elements=elements)
    values = np.median(flow.states[:, known.members], axis=1)
    alive = values > 0.1
    slope, start = np.polyfit(times[alive], values[alive], 1)
    return float(expected * -slope / start - 1)


def row(name: str, size: int) -> str:
    """The row of one set on a mesh of about so many vertices."""
    make_set, make_mesh = set_meshes.SETS[name]
    known = make_set(make_mesh(size))
    test = spectral_tv.eigenset_test(spectral_tv.Mesh(*known.mesh), known.members)
    errors = [
        extinction_error(known, "vertices"),
        extinction_error(known, "edges"),
        test.perimeter / known.perimeter - 1,
    ]
    cells = [name, str(len(known.mesh[0])), *(f"{100 * error:+.2f}" for error in errors)]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Make the table, and write it into the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--largest", type=int, default=SIZES[-1], help="vertices of a mesh, at most"
    )
    largest = parser.parse_args().largest
    lines = ["| set | vertices | rate on vertices, % | rate on edges, % | perimeter, % |",
             "| --- | --- | --- | --- | --- |"]  # fmt: skip
    works = [(name, size) for name in set_meshes.SETS for size in SIZES if size <= largest]
    for name, size in tqdm(works):
        lines.append(row(name, size))
    page = ROOT / "docs" / "sets.md"
    before, rest = page.read_text().split(MARKS[0])
    _, after = rest.split(MARKS[1])
    page.write_text(f"{before}{MARKS[0]}\n" + "\n".join(lines) + f"\n{MARKS[1]}{after}")
    (ROOT / "docs" / "pictures" / "set_rates.svg").write_text(picture(parsed(lines)))


if __name__ == "__main__":
    main()
