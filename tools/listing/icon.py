"""The icon: the head of the creature, half without its detail, half with more."""

from __future__ import annotations

from PIL import Image, ImageDraw

from ..demo.contact_sheet import OVERSIZE
from .pictures import half_colors, halves
from .stage import Figure, View, photograph

SIDE, SAMPLES = 256, 32
# Of the tile behind the head.
CORNER, TOP, BOTTOM = 48, (58, 74, 98), (20, 26, 38)
HEAD = View((0.0, -8, 1.91), (0.0, 0, 1.66), 7.5)


def icon() -> Image.Image:
    """The head on a tile, 256 pixels wide."""
    figure = Figure(halves(), half_colors(), turn=8)
    head = photograph([figure], HEAD, (2 * SIDE, 2 * SIDE), SAMPLES, has_floor=False)
    tile = _tile()
    tile.alpha_composite(head.resize((SIDE, SIDE), Image.Resampling.LANCZOS))
    tile.putalpha(_corners())
    return tile


def _tile() -> Image.Image:
    """Light above, dark below."""
    fade = Image.linear_gradient("L").resize((SIDE, SIDE))
    top, bottom = (Image.new("RGBA", (SIDE, SIDE), color) for color in (TOP, BOTTOM))
    return Image.composite(bottom, top, fade)


def _corners() -> Image.Image:
    mask = Image.new("L", (OVERSIZE * SIDE, OVERSIZE * SIDE))
    box = [0, 0, OVERSIZE * SIDE - 1, OVERSIZE * SIDE - 1]
    ImageDraw.Draw(mask).rounded_rectangle(box, OVERSIZE * CORNER, 255)
    return mask.reduce(OVERSIZE)
