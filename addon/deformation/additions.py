"""What is added to a deformation before it is seen: other shape keys, modifiers."""

from collections.abc import Sequence

import bpy
import numpy as np

from ..scene.notes import note
from ..scene.records import coordinates
from .handles import group_weights
from .results import baked_keys, result_key, told

# Modifiers that leave the shape as it is, or refine it.
HARMLESS = {
    "SUBSURF",
    "MULTIRES",
    "TRIANGULATE",
    "EDGE_SPLIT",
    "WEIGHTED_NORMAL",
    "NORMAL_EDIT",
    "UV_PROJECT",
    "UV_WARP",
    "DATA_TRANSFER",
    "VERTEX_WEIGHT_EDIT",
    "VERTEX_WEIGHT_MIX",
    "VERTEX_WEIGHT_PROXIMITY",
}
# Of the object's size, what moves a vertex unnoticed.
NOTICED = 1e-3


def note_additions(obj: bpy.types.Object, constrained: np.ndarray) -> None:
    """Note what else moves the ``constrained`` vertices of ``obj``, or all that is seen of it."""
    others = _acting_keys(obj)
    if others:
        moved = np.linalg.norm(sum(_offsets(obj, key) for key in others)[constrained], axis=1)
        size = np.linalg.norm(np.ptp(_points(obj.data.shape_keys.reference_key), axis=0))
        if moved.max() > NOTICED * size:
            note(
                f"other shape keys are added, {told([key.name for key in others])}: they move "
                f"constrained vertices by up to {moved.max():.3g}"
            )
    modifiers = [
        modifier.name
        for modifier in obj.modifiers
        if modifier.show_viewport and modifier.type not in HARMLESS
    ]
    if modifiers:
        note(f"modifiers act on what is deformed, {told(modifiers)}: what is seen is theirs")


def _acting_keys(obj: bpy.types.Object) -> Sequence[bpy.types.ShapeKey]:
    """The keys that are seen and hold no deformation."""
    keys = obj.data.shape_keys
    if keys is None or obj.show_only_shape_key:
        return []
    mine = [keys.reference_key, result_key(obj), *baked_keys(obj)]
    return [key for key in keys.key_blocks if key not in mine and not key.mute and key.value != 0]


def _offsets(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> np.ndarray:
    """What a key adds to every vertex, (V, 3)."""
    offsets = key.value * (_points(key) - _points(key.relative_key))
    group = obj.vertex_groups.get(key.vertex_group)
    if group is None:
        return offsets
    weights = np.zeros(len(offsets))
    members, values = group_weights(obj, {group.index})[group.index]
    weights[members] = values
    return weights[:, np.newaxis] * offsets


def _points(key: bpy.types.ShapeKey) -> np.ndarray:
    return coordinates(key.data).reshape(-1, 3).astype(np.float64)
