"""Maps over the UVs of a mesh: of what its bands do, or of the surface of another mesh."""

from __future__ import annotations

import bpy
from spectral_tv.batches.options import free_memory
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from .frames import Frames, unit
from .images import mean_of_samples, with_margin
from .settings import DISPLACEMENT, NORMAL, TANGENT, MapSettings
from .surfaces import Show, Surface, other_surface, own_surface

# Texels that are worked out at once.
AT_ONCE = 1 << 19
# Memory of a sample, at most.
BYTES = 250
# A share of the movement that is worth telling.
SIDEWAYS = 0.05


@dataclass(frozen=True)
class Map:
    """Values (side, side, 3), from the bottom: lengths in object space, or normals as colors from 0
    to 1. ``uv_map`` is the one it is for; ``farthest`` is the largest displacement, 0 of normals.
    """

    values: np.ndarray
    kind: str
    uv_map: str
    farthest: float


def bake(
    obj: bpy.types.Object, target: bpy.types.Object | None, asked: MapSettings, show: Show
) -> Map:
    """Bake a map of an object over its own UVs, or over those of another one.

    ``show`` takes the fraction done. Raises Refusal if it cannot be done.
    """
    _ensure_fits(asked)
    if target is None:
        surface = own_surface(obj, asked, show)
    else:
        surface = other_surface(obj, target, asked, show)
    show(0.6)
    values, farthest = _values(surface, asked.kind)
    show(0.8)
    side, texels = asked.size, surface.places.texels
    values, is_filled = mean_of_samples(values, texels, side, asked.samples)
    values = with_margin(values, is_filled, side, asked.margin)
    if asked.kind == NORMAL:
        is_empty = ~values.any(axis=1)
        values[is_empty] = (0, 0, 1)
        values = unit(values) / 2 + 0.5
    elif asked.kind == DISPLACEMENT:
        values = np.repeat(values, 3, axis=1)
    return Map(values.reshape(side, side, 3), asked.kind, surface.uv_map, farthest)


def _ensure_fits(asked: MapSettings) -> None:
    """Raise Refusal if Blender could run out of memory, which would end it."""
    side = asked.size * asked.samples
    needed, free = BYTES * side**2, free_memory()
    if free is not None and needed > free:
        raise Refusal(
            f"a map of {side} × {side} samples takes about {needed / 1e9:.1f} GB of memory, but "
            f"{free / 1e9:.1f} GB are free: take a smaller size, or fewer samples"
        )


def _values(surface: Surface, kind: str) -> tuple[np.ndarray, float]:
    """What the map has at texels, (N, 3) or (N, 1), and the largest displacement."""
    frames = Frames.of(surface.triangles) if kind in (TANGENT, NORMAL) else None
    places, count = surface.places, len(surface.places.texels)
    found = np.empty((count, 1 if kind == DISPLACEMENT else 3))
    sideways = total = farthest = 0.0
    for first in range(0, count, AT_ONCE):
        chosen = slice(first, first + AT_ONCE)
        shown = surface.shown(chosen)
        if kind == NORMAL:
            found[chosen] = frames.normal(shown, places, chosen)
            continue
        squares = np.einsum("nc,nc->n", shown, shown)
        farthest = max(farthest, float(np.sqrt(squares.max(initial=0))))
        if kind == TANGENT:
            found[chosen] = frames.displacement(shown, places, chosen)
        elif kind == DISPLACEMENT:
            normals = unit(places.values(surface.triangles.normals, chosen))
            along = np.einsum("nc,nc->n", shown, normals)
            found[chosen, 0] = along
            total += squares.sum()
            sideways += max(squares.sum() - np.square(along).sum(), 0)
        else:
            found[chosen] = shown
    share = np.sqrt(sideways / total) if total else 0
    if share > SIDEWAYS:
        note(
            f"{share:.0%} of the movement is sideways, which a map of displacements along normals "
            "does not hold; vector displacements do"
        )
    return found, farthest
