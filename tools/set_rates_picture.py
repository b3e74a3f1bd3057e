"""The convergence of the rates of sets, drawn from the table of docs/sets.md."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 420, 70, 250, 24, 48
# Vertices and errors in % at the ends of the axes.
ACROSS, UP = (2_000, 50_000), (0.01, 10.0)
KINDS = {
    "regular": "#4c78a8", "jittered": "#f58518", "Delaunay": "#54a24b", "decimated": "#b279a2",
    "cells of 8:1": "#e45756", "half sphere": "#72b7b2", "squeezed": "#9d755d",
}  # fmt: skip
DASHES = {"vertices": "5 3", "edges": ""}


@dataclass(frozen=True)
class Row:
    """A row of the table: a set on a mesh, and errors in %."""

    name: str
    vertices: int
    errors: dict[str, float]

    @property
    def kind(self) -> str:
        """The kind of the triangles."""
        return self.name.rsplit(", ", 1)[-1]


def parsed(lines: Iterable[str]) -> list[Row]:
    """The rows of the table."""
    rows = []
    for line in lines:
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) == 5 and cells[1].isdigit():
            errors = {"vertices": float(cells[2]), "edges": float(cells[3])}
            rows.append(Row(cells[0], int(cells[1]), errors))
    return rows


def picture(rows: list[Row]) -> str:
    """The largest error of each kind of triangles by the number of vertices, as SVG."""
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
    ]
    for error in (0.01, 0.1, 1.0, 10.0):
        parts.append(_line([(ACROSS[0], error), (ACROSS[1], error)], "#ddd"))
        parts.append(_text(LEFT - 8, _y(error) + 4, f"{error:g} %", "end"))
    for vertices in (2_500, 10_000, 41_000):
        parts.append(_line([(vertices, UP[0]), (vertices, UP[1])], "#ddd"))
        parts.append(_text(_x(vertices), HEIGHT - BOTTOM + 18, f"{vertices:,}".replace(",", " ")))
    parts.append(_text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, "vertices"))
    parts.append(_text(LEFT, 15, "largest error of the rate of a set", "start"))
    for number, (kind, color) in enumerate(KINDS.items()):
        y = TOP + 14 + 44 * number
        for lower, (elements, dash) in enumerate(DASHES.items()):
            points = _largest(rows, kind, elements)
            parts.append(_line(points, color, dash, 2))
            parts += [f'<circle cx="{_x(x):.1f}" cy="{_y(e):.1f}" r="3" fill="{color}"/>'
                      for x, e in points]  # fmt: skip
            at = y + 16 * lower
            parts.append(
                f'<path d="M{WIDTH - RIGHT + 20} {at - 4}h30" stroke="{color}" '
                f'stroke-width="2" stroke-dasharray="{dash}"/>'
            )
            parts.append(_text(WIDTH - RIGHT + 58, at, f"{kind}, on {elements}", "start"))
    return "\n".join([*parts, "</svg>\n"])


def _largest(rows: list[Row], kind: str, elements: str) -> list[tuple[int, float]]:
    """The largest error at each size; sizes are those of spheres, about."""
    by_size: dict[int, list[Row]] = {}
    for row in rows:
        if row.kind == kind:
            by_size.setdefault(round(math.log(row.vertices / 2_562, 4)), []).append(row)
    return [
        (round(sum(row.vertices for row in group) / len(group)),
         max(abs(row.errors[elements]) for row in group))
        for _, group in sorted(by_size.items())
    ]  # fmt: skip


def _x(vertices: float) -> float:
    share = math.log(vertices / ACROSS[0]) / math.log(ACROSS[1] / ACROSS[0])
    return LEFT + share * (WIDTH - LEFT - RIGHT)


def _y(error: float) -> float:
    share = math.log(max(error, UP[0]) / UP[0]) / math.log(UP[1] / UP[0])
    return HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM)


def _line(
    points: list[tuple[int, float]] | list[tuple[float, float]],
    color: str,
    dash: str = "",
    width: int = 1,
) -> str:
    places = " ".join(f"{_x(x):.1f},{_y(y):.1f}" for x, y in points)
    return (
        f'<polyline points="{places}" fill="none" stroke="{color}" stroke-width="{width}" '
        f'stroke-dasharray="{dash}"/>'
    )


def _text(x: float, y: float, text: str, anchor: str = "middle") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'
