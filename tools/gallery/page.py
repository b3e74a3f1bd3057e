"""A page of the gallery: photographs of shapes, images and curves, laid out and saved small."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
import spectral_tv
from PIL import Image, ImageDraw

from ..demo import contact_sheet
from ..demo.contact_sheet import INK, RULE, Sheet, compose
from ..demo.studio import Studio, temporary_data

# Positions, colors of vertices, marked faces.
Shot = tuple[np.ndarray, np.ndarray | None] | tuple[np.ndarray, np.ndarray | None, np.ndarray]

CELL = 170
SAMPLES = 16
SHADES = 192
CURVES = ((46, 88, 148), (214, 120, 52), (70, 150, 90), (190, 70, 90))
OVERSIZE = 3


@dataclass(frozen=True)
class Shape:
    """A triangle mesh, Z up and facing -Y, and from where it is seen, in degrees."""

    vertices: np.ndarray
    triangles: np.ndarray
    azimuth: float = 25.0
    elevation: float = 12.0
    smooth: bool = True

    @property
    def mesh(self) -> spectral_tv.Mesh:
        """The same for the library."""
        return spectral_tv.Mesh(self.vertices, self.triangles)

    def photograph(
        self, shots: Sequence[Shot], cell: int = CELL, *, is_still: bool = False
    ) -> list[Image.Image]:
        """Photographs of (positions, linear colors or None, faces marked, if any), all at the
        scale of the shape; or by a camera that stays where it sees all of them.
        """
        with temporary_data():
            data = bpy.data.meshes.new("Shape")
            data.from_pydata(self.vertices.tolist(), [], self.triangles.tolist())
            studio = Studio(
                bpy.data.objects.new("Shape", data),
                cell,
                margin=0.1,
                azimuth=self.azimuth,
                elevation=self.elevation,
                samples=SAMPLES,
                smooth=self.smooth,
            )
            if is_still:
                studio.hold_still([shot[0] for shot in shots])
            return [studio.shoot(*shot) for shot in shots]

    def positions(self, shapes: Sequence[np.ndarray], cell: int = CELL) -> list[Image.Image]:
        """Photographs of positions in clay."""
        return self.photograph([(shape, None) for shape in shapes], cell)

    def folds(self, shapes: Sequence[np.ndarray], cell: int = CELL) -> list[Image.Image]:
        """Photographs of positions in clay, with faces in red that are folded over."""
        mesh = self.mesh
        folded = [spectral_tv.folds(mesh, shape - self.vertices).flipped for shape in shapes]
        shots = [(shape, None, faces) for shape, faces in zip(shapes, folded, strict=True)]
        return self.photograph(shots, cell)

    def painted(self, colors: Sequence[np.ndarray], cell: int = CELL) -> list[Image.Image]:
        """Photographs of the shape itself in several colorings."""
        return self.photograph([(self.vertices, each) for each in colors], cell)


def picture(values: np.ndarray, cell: int = CELL) -> Image.Image:
    """Grey values (H, W) from 0 to 1, from the bottom up, as a picture that fills a cell."""
    bytes_ = (255 * np.clip(values[::-1], 0, 1)).round().astype(np.uint8)
    border = round(0.03 * cell)
    page = Image.new("RGBA", (cell, cell))
    inside = Image.fromarray(bytes_).resize([cell - 2 * border] * 2, Image.Resampling.LANCZOS)
    page.paste(inside, (border, border))
    return page


def plot(
    times: np.ndarray, curves: Sequence[np.ndarray], low: float, high: float, cell: int = CELL
) -> Image.Image:
    """Curves over time, from ``low`` to ``high``."""
    side, border = OVERSIZE * cell, OVERSIZE * cell // 12
    page = Image.new("RGBA", (side, side))
    pen = ImageDraw.Draw(page)
    inner = side - 2 * border
    for share in (0, 0.5, 1):
        y = border + share * inner
        pen.line([(border, y), (side - border, y)], RULE, OVERSIZE)
    for ink, curve in zip(CURVES, curves, strict=False):
        xs = border + inner * times / times[-1]
        ys = side - border - inner * (curve - low) / (high - low)
        points = list(zip(xs.tolist(), ys.tolist(), strict=True))
        pen.line(points, ink, 2 * OVERSIZE, joint="curve")
    pen.line([(border, border), (border, side - border), (side - border, side - border)], INK, 2)
    return page.resize((cell, cell), Image.Resampling.LANCZOS)


def save(path: Path, sheets: Sequence[Sheet], cell: int = CELL, shades: int = SHADES) -> None:
    """Lay pictures out and write them as a small PNG."""
    page = compose(sheets, cell, lambda shown: shown)
    path.parent.mkdir(parents=True, exist_ok=True)
    contact_sheet.save(page, path, shades)
