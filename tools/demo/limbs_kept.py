"""The picture of the bands with limbs kept, from the .blend that the demo leaves.

python -m tools.demo.limbs_kept CREATURE.blend PICTURE.png
"""

from __future__ import annotations

import sys
from pathlib import Path

import spectral_tv
from PIL import Image

from .comparisons import by_bands
from .contact_sheet import PAPER, save
from .methods import filtered
from .shapes import opened
from .studio import Studio, temporary_data

SIDE = 225
METHODS = ("M1", "M3")
# Every band removed; the largest doubled.
FILTERS = ((0, 0, 0, 0, 0), (1, 1, 1, 1, 2))


def main(blend: Path, path: Path) -> None:
    """Render two rows, the paper's bands and those of the file."""
    obj, _, mesh = opened(blend)
    splits = [spectral_tv.decompose(mesh, method.lower()) for method in METHODS]
    rows = [
        [by_bands(split, gains) for split in splits for gains in FILTERS],
        [filtered(obj, method, gains) for method in METHODS for gains in FILTERS],
    ]
    page = Image.new("RGB", (4 * SIDE, 2 * SIDE), PAPER)
    with temporary_data():
        studio = Studio(obj, SIDE)
        for y, row in enumerate(rows):
            for x, vertices in enumerate(row):
                shot = studio.shoot(vertices)
                page.paste(shot, (x * SIDE, y * SIDE), shot)
    save(page, path, shades=64)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
