"""Values over time as a table, and as a picture of curves."""

from __future__ import annotations

from itertools import pairwise

import bpy
import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..drawing.ink import HEIGHT, color, mask
from ..scene.arrays import numbers
from ..scene.documents import keep_image, keep_text
from ..scene.results import written_names
from ..scene.whole import whole
from .flows import Prepared
from .sources import read

MOST_VERTICES = 16
CHANNELS = ("X", "Y", "Z")
COLORS = ("R", "G", "B")
WIDTH, HEIGHT_OF_PICTURE, PIXEL = 960, 600, 3
LEFT, BOTTOM, MARGIN = 150, 50, 24
GROUND, GRID, INK = (0.16, 0.16, 0.16, 1), (0.25, 0.25, 0.25, 1), (0.75, 0.75, 0.75, 1)
GRID_LINES = 4
# So much smaller is the picture in the sidebar.
REDUCTION = 4


@dataclass(frozen=True)
class Table:
    """``values`` (N, K) at ``times`` (N,), a column for each of ``names``."""

    names: list[str]
    times: np.ndarray
    values: np.ndarray

    def text(self) -> str:
        """As comma-separated values."""
        quoted = ['"' + name.replace('"', '""') + '"' for name in self.names]
        rows = np.column_stack([self.times, self.values])
        lines = [",".join(["time", *quoted])]
        lines += [",".join(f"{value:.9g}" for value in row) for row in rows]
        return "\n".join(lines) + "\n"


def parts(obj: bpy.types.Object, kind: str, chosen: str) -> dict[str, np.ndarray]:
    """Weights (V,) of what is measured, by name; ``chosen`` groups have commas between.

    Raises Refusal if there is none.
    """
    if kind == "VERTICES":
        selected = numbers(obj.data.vertices, "select", dtype=bool)
        vertices = np.flatnonzero(selected)
        if not 0 < len(vertices) <= MOST_VERTICES:
            raise Refusal(f"select 1 to {MOST_VERTICES} vertices, not {len(vertices)}")
        return {f"Vertex {v}": np.arange(len(selected)) == v for v in vertices}
    if chosen in obj.vertex_groups:  # a name may have commas itself
        names = [chosen]
    else:
        names = [name.strip() for name in chosen.split(",") if name.strip()]
    written = written_names(obj, "GROUP")
    names = names or [group.name for group in obj.vertex_groups if group.name not in written]
    if not names:
        raise Refusal("it has no vertex groups whose values could be told")
    found = {name: read(obj, "GROUP", name).values[:, 0] for name in names}
    empty = [name for name, weights in found.items() if not weights.any()]
    if empty:
        raise Refusal(f"the vertex group {empty[0]!r} is empty")
    return found


def table(prepared: Prepared, parts: dict[str, np.ndarray], flow: spectral_tv.Flow) -> Table:
    """Mean values of parts (V,) of the object; a column per part and channel."""
    channels = COLORS if prepared.source.alpha is not None else CHANNELS
    names, columns = [], []
    for name, weights in parts.items():
        means = flow.mean(prepared.surface.merge(weights[:, np.newaxis].astype(float))[:, 0])
        for channel, column in zip(channels, means.T, strict=False):
            names.append(name if means.shape[1] == 1 else f"{name} {channel}")
            columns.append(column)
    return Table(names, flow.times, np.column_stack(columns))


def picture(table: Table, thickness: int = 3) -> np.ndarray:
    """The curves as RGBA from the bottom up, with a legend and the ends of both axes."""
    image = np.empty((HEIGHT_OF_PICTURE, WIDTH, 4), dtype=np.float32)
    image[:] = GROUND
    top, right = HEIGHT_OF_PICTURE - MARGIN, WIDTH - MARGIN
    low, high = table.values.min(), table.values.max()
    for line in range(GRID_LINES + 1):
        y = BOTTOM + line * (top - BOTTOM) // GRID_LINES
        image[y, LEFT:right] = GRID
        value = low + (high - low) * line / GRID_LINES
        label = mask(f"{value:.3g}", PIXEL)
        _ink(image, label, y - HEIGHT * PIXEL // 2, LEFT - MARGIN // 2 - label.shape[1], INK)
        x = LEFT + line * (right - 1 - LEFT) // GRID_LINES
        image[BOTTOM:top, x] = GRID
        label = mask(f"{table.times[-1] * line / GRID_LINES:.3g}", PIXEL)
        _ink(image, label, BOTTOM - 2 * HEIGHT * PIXEL, min(x, right - label.shape[1]), INK)
    across = np.linspace(0, table.times[-1], right - LEFT)
    for number, column in enumerate(table.values.T):
        ink = color(number, len(table.names))
        share = (np.interp(across, table.times, column) - low) / max(high - low, 1e-300)
        heights = np.rint(BOTTOM + share * (top - 1 - BOTTOM)).astype(int)
        for x, (one, two) in enumerate(pairwise(heights), start=LEFT):
            low_end, high_end = min(one, two) - thickness // 2, max(one, two) + thickness // 2 + 1
            image[max(low_end, 0) : high_end, x : x + 2] = ink
        label = mask(table.names[number][:32], PIXEL)
        y = top - (number + 1) * 2 * HEIGHT * PIXEL
        if y > BOTTOM:
            _ink(image, label, y, right - MARGIN - label.shape[1], ink)
    return image


def write(obj: bpy.types.Object, name: str, table: Table) -> None:
    """Keep a table as a text and its picture as an image, in place of those of the last time."""
    drawn, thick = picture(table), picture(table, 3 * REDUCTION)
    with whole(obj):
        keep_text(obj.data, "table", f"{name}.csv", table.text())
        kept = keep_image(obj.data, "picture", name, drawn)
        preview = kept.preview_ensure()
    small = _reduced(thick)
    preview.image_size = small.shape[1::-1]
    preview.image_pixels_float = small.ravel()


def _reduced(image: np.ndarray) -> np.ndarray:
    """Means of blocks: Blender picks single pixels of what it shows smaller, and loses lines."""
    height, width, channels = image.shape
    blocks = image.reshape(height // REDUCTION, REDUCTION, width // REDUCTION, REDUCTION, channels)
    return blocks.mean(axis=(1, 3))


def _ink(image: np.ndarray, label: np.ndarray, y: int, x: int, ink: tuple[float, ...]) -> None:
    x = max(x, 0)
    image[y : y + label.shape[0], x : x + label.shape[1]][label] = ink
