"""What the paper says of sets, measured on edges: python -m tools.set_claims [--vertices 10000].

The table is written into docs/sets.md, between its marks. Numbers of figures and sections are
those of Brokman, Burger and Gilboa 2024.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import spectral_tv
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))
import set_meshes  # noqa: E402
from shapes import torus  # noqa: E402

MARKS = "<!-- claims -->\n", "<!-- /claims -->\n"
STEPS = 48
MAJOR, MINOR = 2.0, 0.6


def lattice_torus(vertices: int) -> tuple[spectral_tv.Mesh, NDArray[np.float64]]:
    """A torus, and how far around it each vertex is, from −π to π."""
    around = round(np.sqrt(vertices * MAJOR / MINOR))
    points, triangles = torus(MAJOR, MINOR, around, vertices // around)
    return spectral_tv.Mesh(points, triangles), np.arctan2(points[:, 1], points[:, 0])


def straightness(vertices: int) -> list[float]:
    """R² of the decay of a cap and of its complement."""
    cap = set_meshes.cap(set_meshes.jittered_sphere(vertices), 1.0)
    mesh = spectral_tv.Mesh(*cap.mesh)
    return [
        spectral_tv.eigenset_test(mesh, members).straightness
        for members in (cap.members, ~cap.members)
    ]


def sleeves(vertices: int) -> dict[str, list[float]]:
    """When the jumps of two sleeves of the torus vanish, relative to the theory's time of one.

    The second has the weight of the inverse ratio of areas, or of rates. The set between them
    rises. So the jump of a sleeve C falls at the rate per(C)/|C| + (per(C₁) + per(C₂))/|outside|.
    """
    mesh, angle = lattice_torus(vertices)
    first, second = np.abs(angle) < 0.9, np.abs(angle) > np.pi - 0.45
    outside = ~first & ~second
    areas = [float(mesh.vertex_areas[part].sum()) for part in (first, second, outside)]
    perimeter = 2 * 2 * np.pi * MINOR
    rates = [perimeter / area + 2 * perimeter / areas[2] for area in areas[:2]]
    found = {}
    for name, weight in (("areas", areas[0] / areas[1]), ("rates", rates[1] / rates[0])):
        times = np.linspace(0, 1.3 / rates[0], STEPS + 1)
        states = spectral_tv.flow(mesh, first + weight * second, times, exact=True,
                                  elements="edges").states  # fmt: skip
        ends = []
        for part in (first, second):
            jump = np.median(states[:, part], axis=1) - np.median(states[:, outside], axis=1)
            alive = (jump > 0.1 * jump[0]) & (times < 0.9 / rates[0])
            slope, start = np.polyfit(times[alive], jump[alive], 1)
            ends.append(float(-start / slope * rates[0]))
        found[name] = ends
    return found


def discs(vertices: int) -> list[spectral_tv.EigensetTest]:
    """The tests of a small and a large disc on the outside of the torus."""
    mesh, _ = lattice_torus(vertices)
    distance = np.linalg.norm(mesh.vertices - [MAJOR + MINOR, 0, 0], axis=1)
    return [spectral_tv.eigenset_test(mesh, distance < radius) for radius in (0.4, 1.3)]


def merging(vertices: int) -> list[float]:
    """Errors in % of the two rates of a sleeve of 1 in one of 0.5: alone, then with the other."""
    mesh, angle = lattice_torus(vertices)
    inner, outer = np.abs(angle) < 0.5, (np.abs(angle) >= 0.5) & (np.abs(angle) < 1.3)
    perimeter = 2 * 2 * np.pi * MINOR
    area, merged = (float(mesh.vertex_areas[part].sum()) for part in (inner, inner | outer))
    first, second = perimeter / area, perimeter / merged
    meeting = 0.5 / first
    gain = perimeter / (mesh.area - merged)
    extinction = meeting + (0.5 - gain * meeting) / (second + gain)
    times = np.linspace(0, meeting + 0.9 * (extinction - meeting), STEPS + 1)
    flow = spectral_tv.flow(mesh, inner + 0.5 * outer, times, exact=True, elements="edges")
    values = np.median(flow.states[:, inner], axis=1)
    errors = []
    for when, rate in ((times < 0.95 * meeting, first), (times > 1.05 * meeting, second)):
        slope, _ = np.polyfit(times[when], values[when], 1)
        errors.append(100 * float(-slope / rate - 1))
    return errors


def said(is_so: bool) -> str:
    """In a word."""
    return "yes" if is_so else "no"


def table(vertices: int) -> list[str]:
    """The lines of the table."""
    straight, ends, (small, large), rates = (
        straightness(vertices), sleeves(vertices), discs(vertices), merging(vertices))  # fmt: skip
    both = all(r_squared > 0.999 for r_squared in straight)
    together = {name: abs(first - second) < 0.02 for name, (first, second) in ends.items()}
    rows = [
        (
            "A cap and its complement fade in a straight line (figure 4)",
            f"{said(both)}: R² is {straight[0]:.5f} and {straight[1]:.5f}",
        ),
        (
            "A small disc on the torus is an eigenset (figure 5)",
            f"{said(small.is_eigenset)}: R² is {small.straightness:.5f}, and the least ratio of "
            f"perimeters of larger sets {small.perimeter_ratio:.3f}; of few edges across, its "
            f"perimeter is less sure, its rate {100 * (small.rate / small.eigenvalue - 1):+.1f} "
            "% off per/area",
        ),
        (
            "A large one is none, and becomes a sleeve (figure 5)",
            f"{said(not large.is_eigenset)}: a larger set has "
            f"{100 * (1 - large.perimeter_ratio):.1f} % less perimeter in relation to the area "
            "around it",
        ),
        (
            "Two sleeves, weighted by the inverse ratio of areas, vanish together (figure 5)",
            f"{said(together['areas'])}: the jumps end at {ends['areas'][0]:.3f} and "
            f"{ends['areas'][1]:.3f} of the time at which by the theory the first one ends, as the "
            "set between them rises. Weighted by the inverse ratio of their rates: "
            f"{said(together['rates'])}, at {ends['rates'][0]:.3f} and {ends['rates'][1]:.3f}",
        ),
        (
            "A set that merges with another decays at two rates (Sec. 8)",
            f"{said(max(map(abs, rates)) < 2)}: they are {rates[0]:+.2f} % and {rates[1]:+.2f} % "
            "off per/area, of the set and then of the union",
        ),
    ]
    cells = [f"| {claim} | {found} |" for claim, found in rows]
    return ["| the paper | here |", "| --- | --- |", *cells]


def main() -> None:
    """Make the table, and write it into the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--vertices", type=int, default=10_242, help="of each mesh, about")
    lines = table(parser.parse_args().vertices)
    page = ROOT / "docs" / "sets.md"
    before, rest = page.read_text().split(MARKS[0])
    _, after = rest.split(MARKS[1])
    page.write_text(f"{before}{MARKS[0]}\n" + "\n".join(lines) + f"\n{MARKS[1]}{after}")


if __name__ == "__main__":
    main()
