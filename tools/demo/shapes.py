"""Reading the shapes of a mesh."""

from __future__ import annotations

import bpy
import numpy as np


def coordinates(obj: bpy.types.Object, key: str) -> np.ndarray:
    """Positions of a shape key, (V, 3)."""
    data = obj.data.shape_keys.key_blocks[key].data
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(np.float64)
