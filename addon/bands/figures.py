"""The deviation of a look in figures, for reports.

Means, root mean squares and percentiles are over the surface of the original, by its area.
"""

from __future__ import annotations

import json
from collections.abc import Collection
from typing import Any

import bpy
import spectral_tv
from spectral_tv.later import np
from spectral_tv.notes import listed, note

from ..scene import lengths, mix
from ..scene.keeping import Band
from ..scene.modifiers import between
from ..scene.records import bands_of, records_of
from .bands import settings_as_taken
from .deviation import Deviation
from .limiting import held_back

PERCENTILE = 0.99


def figures(obj: bpy.types.Object, bands: Collection[Band], limit: float = 0.0) -> dict[str, Any]:
    """What bands do to an object now, in the unit of the scene.

    Without a ``limit`` the largest of those that they were held within counts. Modifiers do not
    count, which is noted.
    """
    names = between(obj)
    if names:
        note(f"measured before {listed(names)}")
    found = Deviation.of(obj, bands)
    before = _size(found.original, found.faces)
    after = _size(found.original + found.moved, found.faces)
    limits = [record.limit for record in records_of(obj)]
    limit = _short(limit or max(limits, default=0.0))
    count = len(found.lengths)
    # What rounding leaves beyond a limit is not over it.
    over = int(np.count_nonzero(found.lengths > limit * (1 + 1e-6))) if limit else None
    held = held_back(obj, bands)
    return {
        "object": obj.name,
        "unit": lengths.unit(),
        "vertices": count,
        "deviation": _summary(found),
        "limit": limit or None,
        "over_limit": None if over is None else _part(over, count),
        "held_back": _part(held, count),
        "before": before,
        "after": after,
        "decompositions": [_described(obj, record) for record in records_of(obj)],
        "shape_keys": mix.told(obj, bands) or None,
        "versions": {"spectral_tv": spectral_tv.__version__, "blender": bpy.app.version_string},
    }


def text_of(found: dict[str, Any]) -> str:
    """Figures as JSON."""
    return json.dumps(found, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def told(found: dict[str, Any]) -> str:
    """Say the main ones."""
    deviation = found["deviation"]
    names = ("largest", "mean", "root_mean_square", "percentile_99")
    values = [lengths.told(deviation[name]) for name in names]
    text = f"{values[0]} at most, {values[1]} in the mean, {values[2]} RMS, 99 % within {values[3]}"
    if found["over_limit"] is not None:
        over, limit = found["over_limit"]["vertices"], lengths.told(found["limit"])
        text += f"; {over or 'no'} {'vertex is' if over == 1 else 'vertices are'} over {limit}"
    return text


def _summary(found: Deviation) -> dict[str, float]:
    areas = _areas(found.original, found.faces)
    weights = np.zeros(len(found.lengths))
    for corner in found.faces.T:
        weights += np.bincount(corner, areas / 3, len(weights))
    total = weights.sum()
    weights = weights / total if total > 0 else np.full(len(weights), 1 / len(weights))
    order = np.argsort(found.lengths)
    reached = np.cumsum(weights[order])
    place = min(int(np.searchsorted(reached, PERCENTILE)), len(order) - 1)
    return {
        "largest": float(found.lengths.max()),
        "mean": float(found.lengths @ weights),
        "root_mean_square": float(np.sqrt(found.lengths**2 @ weights)),
        "percentile_99": float(found.lengths[order[place]]),
        "farthest_outwards": float(max(found.signed.max(), 0)),
        "farthest_inwards": float(max(-found.signed.min(), 0)),
    }


def _size(vertices: np.ndarray, faces: np.ndarray) -> dict[str, float | None]:
    """The area and the volume of a surface; an open one has no volume."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    # A closed surface has each side once in either direction.
    forth, back = (np.sort(each @ [len(vertices), 1]) for each in (sides, sides[:, ::-1]))
    volume = None
    if np.array_equal(forth, back):
        middle = vertices[faces].mean(axis=(0, 1))
        one, two, three = (vertices[corner] - middle for corner in faces.T)
        volume = abs(float(np.einsum("ij,ij->", one, np.cross(two, three)))) / 6
    return {"area": float(_areas(vertices, faces).sum()), "volume": volume}


def _areas(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    one, two, three = (vertices[corner] for corner in faces.T)
    return np.linalg.norm(np.cross(two - one, three - one), axis=1) / 2


def _part(some: int, count: int) -> dict[str, float]:
    return {"vertices": some, "share": some / count}


def _short(value: float) -> float:
    """A value of single precision: 0.3, and not 0.30000001."""
    return float(str(np.float32(value)))


def _described(obj: bpy.types.Object, record: Any) -> dict[str, Any]:
    return {
        "name": record.name,
        "recipe": record.recipe or None,
        "settings": json.loads(settings_as_taken(record).text()),
        "limit": _short(record.limit) or None,
        "bands": [
            {
                "name": band.name,
                "value": _short(band.value),
                "muted": band.mute,
                "mask": band.vertex_group or None,
            }
            for band in bands_of(obj, record)
            if band is not None
        ],
    }
