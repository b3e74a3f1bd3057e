"""Pictures of what each method is for, from the .blend that the demo leaves.

python -m tools.demo.methods CREATURE.blend DIRECTORY
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

from .contact_sheet import PAPER, save
from .shapes import band, coordinates
from .studio import Studio, temporary_data

SIDE = 300
# Method: the gains of its five bands in the second and third picture, what part of the whole is
# shown (left, top, width) and from where.
WHOLE, CHEST = (0.0, 0.0, 1.0), (0.24, 0.2, 0.5)
PICTURES = {
    "M1": (((0, 0, 0.3, 1, 1), (2.2, 2.6, 2, 1, 1)), CHEST),
    "M2": (((1, 1, 0.7, 0.5, 0.6), (1, 1, 1.2, 1.35, 1.4)), WHOLE),
    "M3": (((0, 0, 0.3, 1, 1), (2.5, 2.5, 2, 1, 1)), CHEST),
}


def main(blend: Path, directory: Path) -> None:
    """Write method_*.png: the shape, and two filters of it."""
    bpy.ops.wm.open_mainfile(filepath=str(blend.resolve()))
    obj = next(obj for obj in bpy.data.objects if obj.type == "MESH")
    for method, (filters, (left, top, width)) in PICTURES.items():
        size = round(SIDE / width)
        page = Image.new("RGB", (3 * SIDE, SIDE), PAPER)
        with temporary_data():
            studio = Studio(obj, size)
            for place, gains in enumerate(((1,) * 5, *filters)):
                shot = studio.shoot(filtered(obj, method, gains))
                corner = round(left * size), round(top * size)
                cut = shot.crop((*corner, corner[0] + SIDE, corner[1] + SIDE))
                page.paste(cut, (place * SIDE, 0), cut)
        path = directory / f"method_{method.lower()}.png"
        save(page, path, shades=64)


def filtered(obj: bpy.types.Object, method: str, gains: tuple[float, ...]) -> np.ndarray:
    """The shape with each band of a method times its gain, (V, 3)."""
    basis = coordinates(obj, "Basis")
    return basis + sum(
        (gain - 1) * (band(obj, method, number) - basis)
        for number, gain in enumerate(gains, start=1)
    )


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
