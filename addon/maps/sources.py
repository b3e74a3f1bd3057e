"""What maps show of an object: how its bands move the surface, or the surface that is seen."""

from __future__ import annotations

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..bands.apply_look import note_unsettled, pinned_refusal
from ..bands.set_bands import bands_refusal
from ..scene import applied, mix
from ..scene.mix import Part
from ..scene.places import is_kept_up
from ..scene.records import all_bands_of, band_of, bands_of, keeping_of, record_of
from ..scene.temporary import Temporary
from .settings import NORMAL, MapSettings
from .triangles import Triangles, shaped


@dataclass(frozen=True)
class Moved:
    """A shape (V, 3) in object space, and how far it moves, (V, 3)."""

    original: np.ndarray
    moved: np.ndarray

    @classmethod
    def of(cls, obj: bpy.types.Object, asked: MapSettings) -> Moved:
        """What is asked for, before modifiers; raises Refusal if there is none."""
        _ensure_bands(obj)
        every = all_bands_of(obj)
        original = mix.shown(obj, without=every)
        if asked.source == "BAND":
            return cls(original, Part(band_of(obj, asked.band), 1.0).displacement(obj))
        note_unsettled(obj, every, "baked as they are on this frame")
        parts = [part for part in mix.parts(obj) if part.key in every]
        if not parts:
            raise Refusal("the bands change nothing at their present values")
        return cls(original, mix.Moves().of(obj, parts))


@dataclass(frozen=True)
class Seen:
    """A surface in object space, and how far its vertices move (V, 3); None if they show the look
    by themselves."""

    triangles: Triangles
    moved: np.ndarray | None

    @classmethod
    def of(cls, obj: bpy.types.Object, asked: MapSettings) -> Seen:
        """What rays from another mesh meet; raises Refusal if it cannot be seen."""
        with Temporary() as now:
            if asked.source == "LOOK":
                return cls(Triangles.of(now.made(mesh_seen(obj))), None)
            if asked.kind == NORMAL:
                _ensure_bands(obj)
                return cls(Triangles.of(now.made(shaped(obj, _alone(obj, asked.band)))), None)
            found = Moved.of(obj, asked)
            return cls(Triangles.of(now.made(shaped(obj, found.original))), found.moved)


def mesh_seen(obj: bpy.types.Object) -> bpy.types.Mesh:
    """A new mesh of what is seen of an object, its modifiers applied; raises Refusal."""
    if not is_kept_up(obj):
        raise Refusal(
            f"{obj.name!r} is hidden, so that Blender does not work out its modifiers; show it"
        )
    return applied.mesh_of(obj)


def _ensure_bands(obj: bpy.types.Object) -> None:
    reason = bands_refusal(obj, override=False) or pinned_refusal(obj)
    if reason is not None:
        raise Refusal(reason)


def _alone(obj: bpy.types.Object, number: int) -> np.ndarray:
    """The shape (V, 3) without the bands of the active decomposition but for one."""
    bands, own = [band for band in bands_of(obj) if band is not None], band_of(obj, number)
    displacement = keeping_of(record_of(obj)).displacement
    others = [displacement(band) for band in bands if band != own]
    return mix.shown(obj, without=bands) - sum(others, np.zeros(3))
