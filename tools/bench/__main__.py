"""Measure the library against what one would write without it, as ratios in one run.

Takes up to two hours; on meshes of one's own less.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from . import (
    accuracy,
    batches,
    deformation,
    eigenpairs,
    estimates,
    exact,
    growth,
    interruption,
    live,
    machine,
    posing,
    sliders,
    smoothing,
    steps,
)
from .meshes import Shape, bumpy_sphere, bumpy_torus, pinched_sphere, read
from .page import TABLES, Page

Shapes = list[tuple[str, Shape]]

# Frequencies of spheres with 41 k, 164 k and 1 M vertices, and of small ones for a trial.
FREQUENCIES, SMALL_FREQUENCIES = (64, 128, 316), (8, 16)
SIZES, SMALL_SIZES = (10_000, 40_000, 160_000, 640_000, 1_000_000), (1_000, 4_000)
# Frequencies of spheres with 10 k and 164 k vertices.
GRADED = (32, 128)
# Frequencies of spheres with 7 k and 44 k vertices.
PINCHED, SMALL_PINCHED = (26, 66), (8, 12)
ESTIMATED, SMALL_ESTIMATED = (32, 64, 128, 316), (8, 16)


# Made along with "steps" and "deformation".
ALONG = ("memory", "dragging", "rigid")
NAMES = tuple(name for name in TABLES if name not in ALONG)


def main() -> None:
    """Print the tables, and write them into a page."""
    parser = argparse.ArgumentParser(prog="make bench", description=__doc__)
    parser.add_argument(
        "meshes", type=Path, nargs="*", help="files that Blender reads, such as .ply or .stl"
    )
    parser.add_argument("--page", type=Path, help="a page with markers to write the tables into")
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES, help="these tables only")
    parser.add_argument("--least", action="store_true", help="leave out what takes many minutes")
    parser.add_argument("--small", action="store_true", help="try everything on small meshes")
    arguments = parser.parse_args()
    page = Page(arguments.page)
    tables = planned(arguments)
    for name in arguments.only:
        tables[name](page)


def planned(arguments: argparse.Namespace) -> dict[str, Callable[[Page], None]]:
    """What makes each table, on the meshes of the command line or generated ones."""
    files: Shapes = [(path.stem, read(path)) for path in arguments.meshes]
    small, medium = (8, 12) if arguments.small else (32, 64)
    shapes = files or [
        ("bumpy sphere", bumpy_sphere(n))
        for n in (SMALL_FREQUENCIES if arguments.small else FREQUENCIES)
    ]
    graded = files or [
        ("bumpy sphere", bumpy_sphere(n))
        for n in (SMALL_FREQUENCIES[:1] if arguments.small else GRADED)
    ]
    of_eigenpairs = files[0] if files else ("bumpy torus", bumpy_torus(50 * small**2 // 3))
    pulled = files or [
        ("bumpy sphere", bumpy_sphere(small)),
        *(("pinched sphere", pinched_sphere(n)) for n in (small, medium)),
    ]
    pinched = [
        ("pinched sphere", pinched_sphere(n))
        for n in (SMALL_PINCHED if arguments.small else PINCHED)
    ]
    posed = files or [*pinched, ("bumpy sphere", bumpy_sphere(8 if arguments.small else 26))]
    slid = files or [
        ("bumpy sphere", bumpy_sphere(n))
        for n in (SMALL_FREQUENCIES if arguments.small else sliders.FREQUENCIES)
    ]
    sizes = SMALL_SIZES if arguments.small else SIZES
    estimated = SMALL_ESTIMATED if arguments.small else ESTIMATED
    least = arguments.least
    return {
        "machine": machine.report,
        "steps": lambda page: steps.report(page, shapes, least=least),
        "accuracy": lambda page: accuracy.report(page, graded),
        "exact": lambda page: exact.report(page, (small, medium)),
        "eigenpairs": lambda page: eigenpairs.report(page, *of_eigenpairs, everything=not least),
        "deformation": lambda page: deformation.report(page, pulled),
        "posing": lambda page: posing.report(page, posed),
        "pose_dragging": lambda page: posing.report_dragging(page, files or pinched),
        "live": lambda page: live.report(page, files or pinched),
        "sliders": lambda page: sliders.report(page, slid),
        "smoothing": lambda page: smoothing.report(page, shapes),
        "interruption": lambda page: interruption.report(page, shapes),
        "growth": lambda page: growth.report(page, sizes),
        "estimates": lambda page: estimates.report(page, estimated),
        "batches": lambda page: batches.report(
            page, files=20 if arguments.small else batches.FILES
        ),
    }


if __name__ == "__main__":
    main()
