"""Work objects: the top level of a Multiresolution sculpt as an object of its own.

A work object remembers its source. So its shape can be put back, whatever either is called today.
"""

import bpy
from bpy.props import FloatVectorProperty, IntProperty, PointerProperty, StringProperty
from spectral_tv.later import np
from spectral_tv.notes import note

from . import applied, multires
from .coordinates import points
from .fingerprints import CHANGE, ROUNDING, SUMS, sketch
from .masks import sculpt_mask
from .objects import refusal
from .places import is_in_a_scene


class SpectralTVWork(bpy.types.PropertyGroup):
    """What a work object remembers of its source."""

    owner = bpy.types.Object, "spectral_tv_work"

    source: PointerProperty(
        name="Source", description="The object whose top level it is", type=bpy.types.Object
    )
    called: StringProperty(name="Called", description="The source, when it was last seen")
    levels: IntProperty(name="Levels", description="How many the source had")
    sketch: FloatVectorProperty(
        name="Sketch", description="Of the top level of the source when it was last seen", size=SUMS
    )


def is_work(obj: bpy.types.Object | None) -> bool:
    """Whether ``obj`` was made as a work object."""
    return obj is not None and obj.type == "MESH" and bool(obj.spectral_tv_work.called)


def make(source: bpy.types.Object, mesh: bpy.types.Mesh) -> bpy.types.Object:
    """A new work object of ``source``, whose mesh is the top level; it is in no render.

    Blender gives out no masks of levels, so those of Sculpt Mode are noted.
    """
    found = sculpt_mask(mesh)
    if multires.is_masked(source) and (found is None or not found.any()):
        note(f"what is masked in Sculpt Mode stays with {source.name!r}: {mesh.name!r} has no mask")
    work = applied.object_of(mesh, source, "Work")
    work.hide_render = True
    remember(work, source, points(mesh.vertices))
    return work


def remember(work: bpy.types.Object, source: bpy.types.Object, places: "np.ndarray") -> None:
    """Have a work object remember where the top level of its source has its vertices, (V, 3)."""
    memory = work.spectral_tv_work
    memory.source, memory.called = source, source.name
    memory.levels = multires.modifier_of(source).total_levels
    memory.sketch = sketch(places)


def works_of(source: bpy.types.Object) -> list[bpy.types.Object]:
    """The work objects of ``source`` that are in a scene."""
    return [
        obj
        for obj in bpy.data.objects
        if is_work(obj) and obj.spectral_tv_work.source == source and is_in_a_scene(obj)
    ]


def is_as_seen(work: bpy.types.Object, places: "np.ndarray") -> bool:
    """Whether the top level of the source has its vertices, (V, 3), where the work object remembers
    them.
    """
    unit = CHANGE * ROUNDING * np.abs(places).max(initial=0.0) * np.sqrt(3 * len(places) / SUMS)
    return bool(np.abs(sketch(places) - work.spectral_tv_work.sketch).max() <= unit)


def source_refusal(work: bpy.types.Object) -> str | None:
    """Why the source cannot be written to, in a sentence for the user; None if it can."""
    memory = work.spectral_tv_work
    source = memory.source
    if source is None or not is_in_a_scene(source):
        return f"Its source {memory.called!r} was deleted"
    reason = refusal(source) or multires.levels_refusal(source)
    if reason is not None:
        return f"{source.name}: {reason}"
    levels = multires.modifier_of(source).total_levels
    if levels != memory.levels:
        return (
            f"{source.name} has {_levels(levels)} now, and had {_levels(memory.levels)} when this "
            "was made"
        )
    return None


def _levels(count: int) -> str:
    return "1 level" if count == 1 else f"{count} levels"
