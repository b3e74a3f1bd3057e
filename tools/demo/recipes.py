"""The picture of the recipes, from the .blend that the demo leaves.

python -m tools.demo.recipes CREATURE.blend PICTURE.png
"""

from __future__ import annotations

import sys
from pathlib import Path

from .__main__ import install_extension  # before bpy, whose settings it keeps apart

# isort: split
import bpy
import numpy as np

from .contact_sheet import render
from .shapes import opened

CELL = 280
# In two rows after the creature itself: recipe and strength.
LOOKS = (
    ("Exaggerate Skin", 1.0),
    ("Exaggerate Skin", 2.0),
    ("Caricature", 1.0),
    ("Flatten Plates", 1.0),
    ("Stylize", 1.0),
)


def main(blend: Path, path: Path) -> None:
    """Render the creature, and it by recipes."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    install_extension()
    obj, basis, _ = opened(blend)
    cells = [("Before", basis)]
    for recipe, strength in LOOKS:
        label = recipe if strength == 1 else f"{recipe}, strength {strength:g}"
        cells.append((label, look(obj, recipe, strength)))
    render(obj, [("Recipes", [cells[:3], cells[3:]])], path, cell=CELL, shades=64)


def look(obj: bpy.types.Object, recipe: str, strength: float) -> np.ndarray:
    """The shape that a recipe makes of an object without bands, (V, 3)."""
    obj.shape_key_clear()
    obj.vertex_groups.clear()
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.recipe(recipe=recipe, strength=strength)
    graph = bpy.context.evaluated_depsgraph_get()
    vertices = obj.evaluated_get(graph).data.vertices
    flat = np.empty(3 * len(vertices), dtype=np.float32)
    vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(np.float64)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
    sys.stdout.flush()
