"""Whether a map can be baked over the UVs of a mesh, and what of them is told."""

from __future__ import annotations

import bpy
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from .texels import Places
from .triangles import Triangles

# So far beyond 0 and 1 is rounding, and triangles have no area.
ROUNDING, NO_AREA = 1e-4, 1e-14
# A share of overlap that is worth telling.
OVERLAP = 0.01


def uv_map_of(mesh: bpy.types.Mesh) -> str:
    """The name of the UV map that renders use; raises Refusal if there is none."""
    for layer in mesh.uv_layers:
        if layer.active_render:
            return layer.name
    raise Refusal("it has no UV map; unwrap it first")


def ensure_usable(triangles: Triangles) -> None:
    """Raise Refusal if UVs leave the square from 0 to 1, or have no area; note what has none."""
    uvs, count = triangles.uvs, len(triangles.uvs)
    is_inside = ((uvs >= -ROUNDING) & (uvs <= 1 + ROUNDING)).all(axis=(1, 2))
    outside = count - np.count_nonzero(is_inside)
    if outside:
        raise Refusal(
            f"{outside} of {count} triangles have UVs outside 0 to 1; maps are of that square "
            "alone, not of other UDIM tiles. Pack the islands into it first"
        )
    empty = np.count_nonzero(_areas(triangles) < NO_AREA)
    if empty == count:
        raise Refusal("its UV map has no area; unwrap it first")
    if empty:
        note(f"{empty} of {count} triangles have no area in the UV map, and no part in the map")


def tell_overlap(triangles: Triangles, places: Places) -> None:
    """Note how much of the UV map overlaps: there a texel is of one of several places."""
    expected = _areas(triangles).sum() * places.side**2
    share = 1 - len(places.texels) / max(expected, 1)
    if share > OVERLAP + 2 / np.sqrt(max(expected, 1)):  # the borders of islands are by chance
        note(
            f"about {share:.0%} of the area of the UV map overlaps; there the map has one of the "
            "places that share a texel, and the others show it too"
        )


def _areas(triangles: Triangles) -> np.ndarray:
    one, two, three = np.moveaxis(triangles.uvs.astype(np.float64), 1, 0)
    (a, b), (c, d) = (two - one).T, (three - one).T
    return np.abs(a * d - b * c) / 2
