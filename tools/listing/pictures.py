"""What the pictures of the page show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
from PIL import Image

from ..gallery.film import HAND, RAISED, SMOOTH
from ..gallery.limb_turns import LimbTurn
from ..gallery.page import Shape
from ..gallery.shapes import creature
from ..gallery.shipped import SHIPPED, mixed
from .equalizer import stamp
from .stage import Color, Figure, View, photograph, place_in_picture

SAMPLES = 16
SAME = np.zeros(5)
# Clay, from where detail is gone to where it is raised, and the same for what is drawn.
COOL, NEUTRAL, WARM = (0.10, 0.27, 0.42), (0.46, 0.40, 0.34), (0.72, 0.22, 0.05)
PAINTS = {COOL: (88, 160, 205), NEUTRAL: (214, 206, 196), WARM: (240, 138, 58)}
ROW = View((0, -14, 1.9), (0, 0, 0.74), 24.5)
# What M2's bands are set to for small limbs, and for large ones.
SMALL, LARGE = np.array([0, 0, -0.45, -0.4, -0.3]), np.array([0, 0, 0.25, 0.38, 0.33])
# Of the turn of a hand.
DRAGS = (-0.9, 0.0, 0.55)
# What has moved so far is wholly colored.
FAR = 0.25


@cache
def bands(method: str) -> np.ndarray:
    """What the extension's bands of the creature add to it, (5, V, 3)."""
    return SHIPPED[method].of(creature().mesh)


def dialled(method: str, values: Sequence[float] | np.ndarray) -> Shape:
    """The creature with so much of each band added."""
    shape = creature()
    return replace(shape, vertices=mixed(shape.mesh, bands(method), values))


def featured(size: tuple[int, int]) -> Image.Image:
    """Detail that is gone, as it was, and raised."""
    captions = ("Detail gone", "As sculpted", "Detail raised")
    return _row(size, "m1", (SMOOTH, SAME, RAISED), captions)


def limbs(size: tuple[int, int]) -> Image.Image:
    """Limbs and head that are small, as they were, and large."""
    captions = ("Small limbs", "As sculpted", "Large limbs")
    return _row(size, "m2", (SMALL, SAME, LARGE), captions)


def masked(size: tuple[int, int]) -> Image.Image:
    """Bands that act on one half each: detail is gone to the left, and raised to the right."""
    view = View((0.3, -9, 1.8), (0, 0, 1.37), 16.9)
    return photograph([Figure(halves(), half_colors(), turn=8)], view, size, SAMPLES)


def poses(size: tuple[int, int]) -> Image.Image:
    """A hand that is dragged down, and up; what follows it has the color of what is changed."""
    shape, turn = creature(), LimbTurn("creature", creature(), HAND)
    figures = _figures([shape] * 3, (NEUTRAL, NEUTRAL, NEUTRAL))
    for number, share in enumerate(DRAGS):
        moved = turn.posed(share).vertices if share else shape.vertices
        way = np.linalg.norm(moved - shape.vertices, axis=1)[:, None]
        mix = np.clip(way / FAR, 0, 1)
        color = (1 - mix) * np.array(NEUTRAL) + mix * np.array(WARM)
        figures[number] = replace(
            figures[number], shape=replace(shape, vertices=moved), color=color
        )
    page = photograph(figures, ROW, size, SAMPLES).convert("RGB")
    for figure, caption in zip(figures, ("Drag a hand down", "As sculpted", "Or up"), strict=True):
        x, _ = place_in_picture(ROW, (figure.x, figure.y, 0.0), size)
        stamp(page, (x, 0.7 * size[1]), (), PAINTS[NEUTRAL], caption)
    return page


def halves() -> Shape:
    """The creature with its detail gone on its right, and raised on its left."""
    left, right = (dialled("m1", values).vertices for values in (SMOOTH, RAISED))
    share = _share_of_left(0.05)[:, None]
    return replace(creature(), vertices=(1 - share) * left + share * right)


def half_colors() -> np.ndarray:
    """Colors of the vertices of the halves, (V, 3)."""
    share = _share_of_left(0.02)[:, None]
    return (1 - share) * np.array(COOL) + share * np.array(WARM)


def _share_of_left(fade: float) -> np.ndarray:
    """From 0 at the right of the creature to 1 at its left, over a distance between."""
    share = np.clip(creature().vertices[:, 0] / fade / 2 + 0.5, 0, 1)
    return share * share * (3 - 2 * share)


def _row(
    size: tuple[int, int], method: str, values: Sequence[np.ndarray], captions: Sequence[str]
) -> Image.Image:
    """Three creatures, with the faders of their bands below."""
    colors = (COOL, NEUTRAL, WARM)
    figures = _figures([dialled(method, each) for each in values], colors)
    page = photograph(figures, ROW, size, SAMPLES).convert("RGB")
    for figure, each, color, caption in zip(figures, values, colors, captions, strict=True):
        x, _ = place_in_picture(ROW, (figure.x, figure.y, 0.0), size)
        stamp(page, (x, 0.77 * size[1]), each, PAINTS[color], caption)
    return page


def _figures(shapes: Sequence[Shape], colors: Sequence[Color]) -> list[Figure]:
    places = ((-1.86, 0.25, 24), (0.0, -0.1, 14), (1.86, 0.25, 4))
    return [
        Figure(shape, color, x, y, turn)
        for shape, color, (x, y, turn) in zip(shapes, colors, places, strict=True)
    ]
