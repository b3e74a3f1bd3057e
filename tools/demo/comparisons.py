"""The picture of the comparison of methods: the creature smoothed and exaggerated by several.

python -m tools.demo.comparisons CREATURE.blend PICTURE.png
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import spectral_tv
from PIL import Image

from .contact_sheet import PAPER, save
from .methods import CHEST
from .shapes import opened
from .studio import Studio, temporary_data

SIDE = 300
# Gains of M3's five bands: its detail flattened, and raised without most of the finest.
SMOOTHED, RAISED = (0, 0, 0.3, 1, 1), (0.2, 2.2, 2.2, 1, 1)
EXAGGERATION = 0.6
HALVINGS = 30


def main(blend: Path, path: Path) -> None:
    """Render two rows: low-passes by M3, heat, eigenfunctions; before, M3, displacement."""
    obj, basis, mesh = opened(blend)
    m3, displacement = (spectral_tv.decompose(mesh, method) for method in ("m3", "displacement"))
    rows = [
        smoothed(mesh, by_bands(m3, SMOOTHED)),
        [basis, by_bands(m3, RAISED), displacement.filter([1 + EXAGGERATION])],
    ]
    left, top, width = CHEST
    size = round(SIDE / width)
    corner = round(left * size), round(top * size)
    page = Image.new("RGB", (3 * SIDE, 2 * SIDE), PAPER)
    with temporary_data():
        studio = Studio(obj, size)
        for y, row in enumerate(rows):
            for x, vertices in enumerate(row):
                cut = studio.shoot(vertices).crop((*corner, corner[0] + SIDE, corner[1] + SIDE))
                page.paste(cut, (x * SIDE, y * SIDE), cut)
    save(page, path, shades=64)


def smoothed(mesh: spectral_tv.Mesh, m3: np.ndarray) -> list[np.ndarray]:
    """M3's low-pass, that of heat which moves the surface as far, and that of eigenfunctions."""
    heat = low_pass(spectral_tv.decompose(mesh, "heat"))
    waves = spectral_tv.decompose(mesh, "lb")
    # The first component is what the eigenfunctions do not hold.
    held = waves.filter(np.r_[0, np.ones(len(waves.spectrum) - 1)])
    return [m3, matched(mesh, heat, moved(mesh, m3)), held]


def by_bands(split: spectral_tv.Decomposition, gains: tuple[float, ...]) -> np.ndarray:
    """The shape with each band times its gain, (V, 3)."""
    bands = split.bands(split.band_edges(len(gains)))
    return split.residual + np.tensordot(gains, bands, axes=1)


def low_pass(split: spectral_tv.Decomposition) -> Callable[[float], np.ndarray]:
    """The shape without its components up to a share of their number."""
    count = len(split.spectrum)
    return lambda share: split.filter(np.clip(np.arange(count) + 1 - share * count, 0, 1))


def moved(mesh: spectral_tv.Mesh, shape: np.ndarray) -> float:
    """How far a shape is from the mesh in the mean."""
    return float(np.sqrt(mesh.vertex_areas @ ((shape - mesh.vertices) ** 2).sum(axis=1)))


def matched(
    mesh: spectral_tv.Mesh, way: Callable[[float], np.ndarray], distance: float
) -> np.ndarray:
    """The shape of the amount in [0, 1] that moves the vertices that far, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if moved(mesh, way(middle)) < distance else (low, middle)
    return way(low)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
