"""Make the icon and the pictures of the extension's page.

python -m tools.listing [--output DIRECTORY] [--scale SHARE] [PICTURE…]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import bpy
from PIL import Image
from tqdm import tqdm

from ..demo.studio import temporary_data
from . import pictures
from .icon import icon

ROOT = Path(__file__).resolve().parents[2]
# What the site asks for.
SIZE = 1920, 1080
PICTURES: dict[str, Callable[[tuple[int, int]], Image.Image]] = {
    "featured": pictures.featured,
    "limbs": pictures.limbs,
    "masked": pictures.masked,
    "poses": pictures.poses,
}


def main() -> None:
    """Write what is named, or all of it."""
    parser = argparse.ArgumentParser(prog="make listing", description=__doc__)
    names = ["icon", *PICTURES]
    parser.add_argument("names", nargs="*", metavar="PICTURE", help=", ".join(names))
    parser.add_argument("--output", type=Path, default=ROOT / "dist" / "listing")
    parser.add_argument("--scale", type=float, default=1.0, help="share of the full size, to try")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    size = round(arguments.scale * SIZE[0]), round(arguments.scale * SIZE[1])
    for name in tqdm(arguments.names or names, unit=" pictures"):
        with temporary_data():
            made = icon() if name == "icon" else PICTURES[name](size)
        made.save(arguments.output / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
