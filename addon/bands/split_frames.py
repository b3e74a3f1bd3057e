"""Frames on the command line: each decomposed by itself, by scales that are fixed once."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import bpy
import numpy as np
import spectral_tv
from spectral_tv.bands.fixed_scales import FixedScales
from spectral_tv.bands.settings import Settings

from ..scene.surface import Surface
from .bands import prepare_together

Progress = Callable[[float], None]


class SplitFrames:
    """What the frames of objects have in common, by the names of objects that are one surface."""

    def __init__(self, settings: Settings) -> None:
        """Know no frame so far."""
        self._settings = replace(settings, into="ADD")
        self._areas: dict[tuple[str, ...], list[float]] = {}
        self._fixed: dict[tuple[str, ...], FixedScales] = {}

    def measure(self, objects: Sequence[bpy.types.Object]) -> None:
        """Have sizes be relative to the median over this frame and others."""
        surfaces, _ = prepare_together(objects, self._settings)
        self._areas.setdefault(_names(objects), []).append(surfaces[0].mesh.area)

    def area(self, objects: Sequence[bpy.types.Object]) -> float | None:
        """The area that sizes are relative to; None for that of the first frame."""
        measured = self._areas.get(_names(objects))
        return None if measured is None else float(np.median(measured))

    def split(
        self,
        objects: Sequence[bpy.types.Object],
        surfaces: Sequence[Surface],
        arguments: dict[str, Any],
        show: Progress,
    ) -> tuple[list[Surface], spectral_tv.Decomposition]:
        """Decompose the next frame of objects, by the arguments of the first one; returns it with
        their surfaces. ``show`` takes the fraction done."""
        names = _names(objects)
        if names not in self._fixed:
            keeps = bool(self._settings.limbs_kept)
            self._fixed[names] = FixedScales(arguments, self.area(objects), keeps_limbs=keeps)
        base = arguments.get("base")
        own = base if isinstance(base, np.ndarray) else None
        mesh, split = self._fixed[names].decompose(surfaces[0].mesh, own, show)
        return [replace(surface, mesh=mesh) for surface in surfaces], split


def _names(objects: Sequence[bpy.types.Object]) -> tuple[str, ...]:
    return tuple(obj.name for obj in objects)
