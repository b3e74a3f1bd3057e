"""What the bands of a figure are set to, drawn as the faders of an equalizer."""

from __future__ import annotations

from collections.abc import Sequence

from PIL import Image, ImageDraw

from ..demo.contact_sheet import OVERSIZE, letters

# What is drawn is this high and wide where a picture is 1080 pixels high, and letters are so high.
WIDTH, HEIGHT, LETTERS = 330, 160, 31
RANGE = -1.0, 2.0
GROOVE, INK = (96, 106, 122), (226, 229, 234)
WEIGHT = 520


def stamp(
    page: Image.Image,
    place: tuple[float, float],
    values: Sequence[float],
    color: tuple[int, int, int],
    caption: str,
) -> None:
    """Draw faders for the bands, the finest at the left, and a caption below, around a place."""
    unit = OVERSIZE * page.height / 1080
    side = round(unit * WIDTH), round(unit * (HEIGHT + 2 * LETTERS))
    drawn = Image.new("RGBA", side)
    pen = ImageDraw.Draw(drawn)
    step = WIDTH / (len(values) + 1)
    zero = _height(0.0)
    for number, value in enumerate(values, 1):
        x, y = number * step, _height(value)
        _bar(pen, unit, (x - 3, 10, x + 3, HEIGHT - 10), GROOVE)
        _bar(pen, unit, (x - 3, min(y, zero), x + 3, max(y, zero)), color)
        _bar(pen, unit, (x - 15, y - 7, x + 15, y + 7), color)
    pen.text(
        (side[0] / 2, unit * (HEIGHT + 1.3 * LETTERS)),
        caption,
        INK,
        letters(unit * LETTERS, WEIGHT),
        "ms",
    )
    small = drawn.reduce(OVERSIZE)
    page.paste(small, (round(place[0] - small.width / 2), round(place[1])), small)


def _height(value: float) -> float:
    low, high = RANGE
    return HEIGHT - 17 - (HEIGHT - 34) * (value - low) / (high - low)


def _bar(
    pen: ImageDraw.ImageDraw,
    unit: float,
    box: tuple[float, float, float, float],
    color: tuple[int, int, int],
) -> None:
    radius = unit * min(box[2] - box[0], box[3] - box[1]) / 2
    pen.rounded_rectangle([unit * each for each in box], radius, color)
