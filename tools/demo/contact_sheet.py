"""One picture of many versions of a mesh: headed sheets of labelled cells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from .studio import Studio, temporary_data

# A label and what is shown: the positions of a version of a mesh, or a finished picture.
Shown = np.ndarray | Image.Image
Cell = tuple[str, Shown | None]
Sheet = tuple[str, Sequence[Sequence[Cell]]]

PAPER = (244, 244, 242)
INK = (53, 53, 57)
RULE = (199, 199, 196)
OVERSIZE = 4
# Of the letters: the optical size with the tightest spacing, and a little more than regular.
OPTICAL_SIZE, WEIGHT = 32, 450


@dataclass(frozen=True)
class Label:
    """A line of text: its baseline starts at, or is centred on, pixel (x, y) from the top left."""

    text: str
    x: float
    y: float
    size: float
    centred: bool = False


class Layout:
    """Where everything lies on the page, in pixels from the top left."""

    def __init__(self, sheets: Sequence[Sheet], cell: int) -> None:
        """Lay out the sheets one below the other."""
        self.cell = cell
        self.pad = cell // 10
        self.caption = cell // 8
        self.heading = cell // 4
        columns = max(len(row) for _, rows in sheets for row in rows)
        self.width = columns * cell + 2 * self.pad
        self.height = self.pad + sum(
            self.heading + len(rows) * (cell + self.caption) for _, rows in sheets
        )
        self.labels: list[Label] = []
        self.rules: list[int] = []
        self.shots: list[tuple[int, int, Shown]] = []
        top = 0
        for title, rows in sheets:
            top = self._place(title, rows, top)

    def _place(self, title: str, rows: Sequence[Sequence[Cell]], top: int) -> int:
        """Place one sheet from the height `top` on and return the height at which it ends."""
        top += self.heading
        self.labels.append(Label(title, self.pad, top - 0.36 * self.heading, 0.078 * self.cell))
        self.rules.append(top - self.heading // 6)
        for row in rows:
            for column, (text, shown) in enumerate(row):
                left = self.pad + column * self.cell
                middle, baseline = left + self.cell / 2, top + self.cell + 0.6 * self.caption
                self.labels.append(Label(text, middle, baseline, 0.058 * self.cell, centred=True))
                if shown is not None:
                    self.shots.append((left, top, shown))
            top += self.cell + self.caption
        return top


def render(
    obj: bpy.types.Object,
    sheets: Sequence[Sheet],
    path: str | Path,
    *,
    cell: int = 280,
    azimuth: float = 25.0,
    margin: float = 0.18,
    shades: int = 256,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Render versions of a mesh to one PNG, all at the same scale, each centred in its cell.

    The object, the caller's scene and all other data stay as they are.

    Parameters
    ----------
    obj : bpy.types.Object
        Mesh object, Z up, facing -Y. It supplies the faces, the placement in the world and, by
        its own shape, the scale.
    sheets : sequence of (title, rows)
        `rows` is a list of rows of cells (label, vertices), where `vertices` is a (V, 3) array of
        positions in the object's space, or None for an empty cell.
    path : str or Path
        PNG file to write.
    cell : int
        Width and height of a cell in pixels, without its label.
    azimuth : float
        Degrees by which the view is turned from the front to the object's left.
    margin : float
        Space around the object's own shape as a share of its larger extent in the picture.
        A version that would not fit is shown smaller.
    shades : int
        Size of the picture's palette: fewer make a smaller file.
    progress : callable, optional
        Called after each cell with the share of cells done, in (0, 1].
    """
    with temporary_data():
        studio = Studio(obj, cell, margin=margin, azimuth=azimuth)
        page = compose(sheets, cell, studio.shoot, progress)
    save(page, path, shades)


def save(page: Image.Image, path: str | Path, shades: int) -> None:
    """Write a small PNG, with a palette of so many shades."""
    page.quantize(shades, Image.Quantize.MAXCOVERAGE, kmeans=1).save(path, optimize=True)


def compose(
    sheets: Sequence[Sheet],
    cell: int,
    shoot: Callable[[Shown], Image.Image],
    progress: Callable[[float], None] | None = None,
) -> Image.Image:
    """Lay out headed sheets of labelled cells; ``shoot`` makes the picture of what one shows."""
    layout = Layout(sheets, cell)
    page = Image.new("RGB", (layout.width, layout.height), PAPER)
    pen = ImageDraw.Draw(page)
    for y in layout.rules:
        pen.line([(layout.pad, y), (layout.width - layout.pad - 1, y)], RULE)
    for done, (left, top, shown) in enumerate(layout.shots, start=1):
        shot = shoot(shown).convert("RGBA")
        page.paste(shot, (left, top), shot)
        if progress is not None:
            progress(done / len(layout.shots))
    page.paste(INK, mask=_typeset(layout))
    return page


def letters(size: float, weight: int) -> ImageFont.FreeTypeFont:
    """Blender's own letters, so many pixels high."""
    path = Path(bpy.utils.system_resource("DATAFILES", path="fonts")) / "Inter.woff2"
    font = ImageFont.truetype(path, size)
    font.set_variation_by_axes([OPTICAL_SIZE, weight])
    return font


def _typeset(layout: Layout) -> Image.Image:
    """The labels of a page as a mask, drawn larger and reduced to space the letters evenly."""
    mask = Image.new("L", (OVERSIZE * layout.width, OVERSIZE * layout.height))
    pen = ImageDraw.Draw(mask)
    for label in layout.labels:
        font = letters(OVERSIZE * label.size, WEIGHT)
        at, anchor = (OVERSIZE * label.x, OVERSIZE * label.y), "ms" if label.centred else "ls"
        # The font's common hyphen is as wide as a minus sign.
        pen.text(at, label.text.replace("-", "\N{HYPHEN}"), 255, font, anchor)
    return mask.reduce(OVERSIZE)
