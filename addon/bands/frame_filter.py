"""One filter for all frames of an object: fixed scales, each frame decomposed by itself."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

import spectral_tv
from spectral_tv.bands.fixed_scales import THICKNESS, FixedScales
from spectral_tv.bands.settings import Settings
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.steps import Step, Steps
from spectral_tv.later import np
from spectral_tv.notes import gathered, note
from spectral_tv.refusal import Refusal

from ..scene.surface import Reading, flattened
from . import frame_shapes

SCALES = (
    ("FIRST", "First Frame", "Sizes of bands are relative to the size of the first frame"),
    ("ALL", "All Frames", "Sizes of bands are relative to the median of the sizes of all frames"),
)


@dataclass(frozen=True)
class Filtered:
    """How far the filter moves the vertices on every frame, (V, 3) each in object space, and what
    is to be told of it."""

    moves: list[np.ndarray]
    notes: list[str]


def start(
    shapes: Sequence[frame_shapes.FrameShape], settings: Settings, scales: str
) -> Steps[Filtered]:
    """Start to filter frames by the values of their bands; raises Refusal if none has faces."""
    if not any(shape.has_faces for shape in shapes):
        raise Refusal("there are no faces on any of the frames")
    area = None
    if scales == "ALL":
        area = float(np.median([shape.area for shape in shapes if shape.has_faces]))
    return Steps(_filtered(shapes, settings, area))


def _filtered(
    shapes: Sequence[frame_shapes.FrameShape], settings: Settings, area: float | None
) -> Generator[Step, Any, Filtered]:
    fixed: FixedScales | None = None
    reading = Reading(settings.weld, settings.leaves_out)
    moves: list[np.ndarray] = []
    told: list[str] = []
    for number, shape in enumerate(shapes):
        if not shape.has_faces:
            moves.append(np.zeros_like(shape.vertices))
            continue
        with gathered() as notes:
            surface = shape.surface(reading)
        told += [text for text in notes if text not in told]
        base = flattened(surface) if settings.base == "FLAT" and settings.by.takes("base") else None
        if fixed is None:
            arguments = settings.arguments(surface.mesh, base, area)
            fixed = FixedScales(arguments, area, keeps_limbs=bool(settings.limbs_kept))
        mesh, thickness = surface.mesh, fixed.start_thickness(surface.mesh)
        if thickness is not None:
            mesh = fixed.taken(mesh, (yield thickness, (number + THICKNESS) / len(shapes)))
        split = yield fixed.start(mesh, base), (number + 1) / len(shapes)
        fixed.learn(split)
        moves.append(_move(shape, surface.to_object(_bands(split, settings))))
    empty = [shape.frame for shape in shapes if not shape.has_faces]
    if empty:
        told.append(f"nothing is seen on {len(empty)} of the frames, such as {empty[0]}")
    return Filtered(moves, told)


def _bands(split: spectral_tv.Decomposition, settings: Settings) -> np.ndarray:
    edges = split.band_edges(settings.band_count)
    return split.bands(edges, settings.limbs_kept)


def _move(shape: frame_shapes.FrameShape, bands: np.ndarray) -> np.ndarray:
    """What bands (K, V, 3) move together at their values."""
    moved = np.zeros(shape.vertices.shape)
    for band, value, mask in zip(bands, shape.values, shape.masks, strict=True):
        moved += value * (band if mask is None else mask[:, np.newaxis] * band)
    return moved.astype(np.float32)


def note_all(filtered: Filtered) -> None:
    """Tell what was found on the way."""
    for text in filtered.notes:
        note(text)
