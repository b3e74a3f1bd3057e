"""Which shape of an object is decomposed, and what the user is told about it."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from spectral_tv.bands.settings import ON_NEW_OBJECT, SHAPES, Settings
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene import mix, multires
from ..scene.modifiers import between, symmetries
from ..scene.records import bands_of, record_of
from ..scene.surface import Reading, Surface
from ..scene.touching import touching
from . import original, shown_shape
from .replacing import replaced_bands


def read_surfaces(
    objects: Sequence[bpy.types.Object], settings: Settings, *, without_bands: bool = False
) -> list[Surface]:
    """The surfaces of objects that are decomposed as one, in the chosen shape.

    ``without_bands`` takes the active bands for 0, which gives the shape that they are of; so are
    bands taken whose place new ones shall take. Raises Refusal or spectral_tv.MeshError if the
    objects cannot be read.
    """
    for obj in objects:
        if original.is_shown(obj) and settings.shape != "BASIS":
            raise Refusal(original.REASON)
    if settings.shape in ON_NEW_OBJECT:
        if len(objects) > 1:
            raise Refusal(f"only one object at a time is decomposed as {_label(settings.shape)!r}")
        if _base(objects[0], settings):
            raise Refusal("a shape key as the base has other vertices than what is decomposed")
        for text in remarks(objects[0], settings):
            note(text)
        return [shown_shape.read(objects[0], settings.shape, _reading(settings))]
    aside = [_base(obj, settings) for obj in objects]
    for obj, keys in zip(objects, aside, strict=True):
        if without_bands and record_of(obj) is not None:
            keys.extend(bands_of(obj))
        elif not without_bands:
            keys.extend(replaced_bands(obj, settings))
            for text in remarks(obj, settings, keys):
                note(text)
    shapes = [_shape(obj, settings, keys) for obj, keys in zip(objects, aside, strict=True)]
    return Surface.read_together(objects, shapes, _reading(settings))


def groups(objects: Sequence[bpy.types.Object], settings: Settings) -> list[list[bpy.types.Object]]:
    """The objects in groups that are one surface, as their open edges meet."""
    if settings.shape in ON_NEW_OBJECT:
        return [[obj] for obj in objects]
    shapes = [_shape(obj, settings, _base(obj, settings)) for obj in objects]
    found = touching(objects, shapes, _reading(settings))
    return [[objects[index] for index in indices] for indices in found]


def told_groups(
    objects: Sequence[bpy.types.Object], settings: Settings, hint: str = ""
) -> list[list[bpy.types.Object]]:
    """The same, with a note on each group of several, which ends with a ``hint``."""
    found = groups(objects, settings)
    for group in found:
        if len(group) > 1:
            names = ", ".join(obj.name for obj in group)
            note(f"{names} are split as one, as their open edges meet{hint}")
    return found


def vertex_count(obj: bpy.types.Object, settings: Settings) -> int:
    """How many vertices are decomposed; for panels, which ask at every redraw."""
    is_own = settings.shape not in ON_NEW_OBJECT
    return len(obj.data.vertices) if is_own else shown_shape.count(obj, settings.shape)


def remarks(
    obj: bpy.types.Object, settings: Settings, aside: Sequence[bpy.types.ShapeKey] = ()
) -> list[str]:
    """What of ``obj`` is seen but not decomposed, or decomposed but not its Basis.

    The keys ``aside`` take no part in either.
    """
    if settings.shape in ON_NEW_OBJECT:
        return shown_shape.remarks(obj, settings.shape)
    found: list[str] = []
    keys = mix.told(obj, aside)
    if keys and settings.shape == "SHOWN":
        found.append(f"it is decomposed as shown, with {keys}")
    elif keys:
        found.append(f"its Basis is decomposed, not what is shown with {keys}")
    mirrors = [modifier.name for modifier in symmetries(obj)]
    if mirrors:
        found.append(f"the other half of {', '.join(mirrors)} takes part, and stays joined")
    names = [name for name in between(obj) if name not in mirrors]
    if names:
        has_levels = multires.levels_refusal(obj) is None
        label = _label("MULTIRES" if has_levels else "APPLIED")
        found.append(
            f"the bands are of the mesh before {', '.join(names)}, and act through "
            f"{'it' if len(names) == 1 else 'them'}; the shape {label!r} has what is added there"
        )
    return found


def _label(shape: str) -> str:
    return next(label for name, label, _ in SHAPES if name == shape)


def _reading(settings: Settings) -> Reading:
    return Reading(settings.weld, settings.leaves_out)


def _shape(
    obj: bpy.types.Object, settings: Settings, aside: Sequence[bpy.types.ShapeKey]
) -> np.ndarray | None:
    """What is decomposed of an object without some keys, (V, 3); None for its Basis."""
    return mix.shown(obj, aside) if settings.shape == "SHOWN" else None


def _base(obj: bpy.types.Object, settings: Settings) -> list[bpy.types.ShapeKey]:
    """The key that detail is measured from, if one is: it is no part of what has the detail."""
    is_key = settings.by.takes("base") and settings.base == "KEY"
    key = mix.keys_of(obj.data).get(settings.base_key) if is_key else None
    return [] if key is None else [key]
