"""The mix of bands without what folds and stretches faces, as a shape key."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

import bpy
from spectral_tv.bands.clamping import Clamped, start_clamping
from spectral_tv.bands.counts import Counts
from spectral_tv.bands.guard import GuardSettings
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.steps import Steps
from spectral_tv.later import np
from spectral_tv.notes import note

from ..scene import mix
from ..scene.records import all_bands_of, bands_of, record_of
from ..scene.shape_keys import add_displacements
from ..scene.surface import Reading, Surface, moves_of
from ..scene.whole import whole
from .bands import settings_of
from .guard import Reference

NAME = "Safe"


@dataclass(frozen=True)
class Mix:
    """What the bands of an object do now, in object space.

    ``shape`` (V, 3) is shown without them; bands below 0 take ``taken`` (V, 3) away, those above 0
    add ``added`` (V, 3).
    """

    shape: np.ndarray
    taken: np.ndarray
    added: np.ndarray

    @classmethod
    def of(cls, obj: bpy.types.Object, every: bool) -> Mix:
        """Read the bands of every decomposition, or of the active one."""
        bands = all_bands_of(obj) if every else [key for key in bands_of(obj) if key is not None]
        shape = mix.shown(obj, without=bands)
        taken, added = np.zeros((2, *shape.shape))
        for part in mix.parts(obj):
            if part.key in bands:
                moved = taken if part.value < 0 else added
                moved += part.displacement(obj)
        return cls(shape, taken, added)


@dataclass(frozen=True)
class Clamping:
    """Objects that are clamped as one surface, in the shape that bands below 0 leave."""

    mixes: list[Mix]
    surfaces: list[Surface]
    stretch: float
    # Displacements of the surface's mesh, (N, 3).
    taken: np.ndarray = field(repr=False)
    added: np.ndarray = field(repr=False)

    @classmethod
    def read(
        cls, objects: Sequence[bpy.types.Object], settings: GuardSettings, every: bool = True
    ) -> Clamping:
        """Read objects with bands, of every decomposition or of the active ones.

        Raises Refusal or spectral_tv.MeshError if one cannot be read.
        """
        mixes = [Mix.of(obj, every) for obj in objects]
        made_by = settings_of(record_of(objects[0]))
        shapes = [each.shape + each.taken for each in mixes]
        reading = Reading(made_by.weld, made_by.leaves_out)
        surfaces = Surface.read_together(objects, shapes, reading)
        taken, added = (
            moves_of(surfaces, [getattr(each, name) for each in mixes])
            for name in ("taken", "added")
        )
        if not added.any():
            note("no band is above 0, so nothing is clamped")
        return cls(mixes, surfaces, settings.stretch, taken, added)

    def start(self) -> Steps[Clamped]:
        """Clamp, and look for triangles that cross."""
        return start_clamping(self.surfaces[0].mesh, self.taken, self.added, self.stretch)

    def write(
        self, objects: Sequence[bpy.types.Object], result: Clamped
    ) -> tuple[list[bpy.types.ShapeKey], str]:
        """Add a shape key to each object, at value 0; return them, and what was done."""
        before, after = Counts(), Counts()
        keys = []
        with whole(*objects):
            for obj, mixed, surface in zip(objects, self.mixes, self.surfaces, strict=True):
                safe = (
                    mixed.taken
                    + least_of_copies(surface, result.shares)[:, np.newaxis] * mixed.added
                )
                keys += add_displacements(obj, [NAME], [safe])
                # Beyond 1 it would fold.
                keys[-1].slider_min, keys[-1].slider_max = 0.0, 1.0
                moves = [mixed.taken + mixed.added, mix.key_displacement(keys[-1])]
                found = Reference().counts_of(obj, mixed.shape, moves, self.stretch)
                before, after = before + found[0], after + found[1]
        names = ", ".join(dict.fromkeys(repr(key.name) for key in keys))
        done = result.told(before, after, names, takes=bool(self.taken.any()))
        return keys, f"{done}; added"


def least_of_copies(surface: Surface, shares: np.ndarray) -> np.ndarray:
    """The share of each vertex of the object, (V,): the least of its copies'."""
    places = surface.copies.places
    return np.where(places >= 0, shares[places], 1.0).min(axis=0)
