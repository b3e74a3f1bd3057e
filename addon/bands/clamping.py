"""The mix of bands without what folds and stretches faces, as a shape key."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

import bpy
import numpy as np
import spectral_tv
from spectral_tv.bands.counts import Counts
from spectral_tv.notes import note
from spectral_tv.options.declaring import number

from ..job.steps import Steps, in_turn
from ..scene import mix
from ..scene.records import all_bands_of, bands_of, record_of
from ..scene.shape_keys import add_displacements
from ..scene.surface import Reading, Surface, moves_of
from ..scene.whole import whole
from .bands import settings_of
from .guard import STRETCH, Reference

NAME = "Safe"


@dataclass(frozen=True)
class GuardSettings:
    """What counts as too much."""

    stretch: float = number(
        "Stretch", "How many times its length an edge may become", STRETCH, 1.01, 100,
        soft_most=10, digits=2, place="guard"
    )  # fmt: skip


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
    def of(cls, obj: bpy.types.Object, every: bool) -> "Mix":
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
class Clamped:
    """What became of the surface: the share (N,) of what is added that its vertices keep, and how
    much that is of the whole; how many of its triangles cross others without bands, with the mix,
    and with the clamped one.
    """

    shares: np.ndarray
    kept: float
    crossing: tuple[int, int, int]


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
    ) -> "Clamping":
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
        mesh = self.surfaces[0].mesh
        cross = partial(spectral_tv.start_self_intersections, mesh)
        safe = partial(spectral_tv.start_safe_displacement, mesh, self.added, self.stretch)

        def steps():
            found = yield from in_turn(
                [safe, partial(cross, -self.taken), partial(cross, self.added)], 0.75
            )
            clamped = found[0]
            after = yield cross(clamped.displacement), 1.0
            counts = tuple(len(each) for each in (*found[1:], after))
            return Clamped(clamped.shares, clamped.kept, counts)

        return Steps(steps())

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
        self._note_left(after, result.crossing)
        names = ", ".join(dict.fromkeys(repr(key.name) for key in keys))
        done = (
            f"{before.told()} in the mix; {after.told()} in {names}, which keeps "
            f"{_percent(result.kept)} of what the bands add"
        )
        without, crossing, still = result.crossing
        if max(crossing, still) > without:
            done += (
                f"; {crossing} triangles cross others in the mix, {still} in {names}, {without} "
                "without the bands"
            )
        return keys, f"{done}; added"

    def _note_left(self, after: Counts, crossing: tuple[int, int, int]) -> None:
        """Note what clamping did not mend."""
        if after and self.taken.any():
            note(f"what bands below 0 take away is not clamped: with it {after.told()}")
        elif after:
            note(f"{after.told()} all the same, by rounding or as faces bend")
        without, _, still = crossing
        if still > without:
            note(
                "parts meet that lie apart, which clamping does not prevent: "
                f"{still} triangles cross"
            )


def least_of_copies(surface: Surface, shares: np.ndarray) -> np.ndarray:
    """The share of each vertex of the object, (V,): the least of its copies'."""
    places = surface.copies.places
    return np.where(places >= 0, shares[places], 1.0).min(axis=0)


def _percent(share: float) -> str:
    # Never all, unless it is all.
    return "all" if share == 1 else f"{np.floor(1000 * share) / 10:g} %"
