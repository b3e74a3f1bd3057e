"""Which shape of an object is decomposed, and what the user is told of it."""

from collections.abc import Sequence

import bpy
import numpy as np

from ..scene import mix
from ..scene.modifiers import passed_over, symmetries
from ..scene.notes import note
from ..scene.objects import Refusal
from ..scene.records import band_keys, record_of
from ..scene.surface import Reading, Surface
from ..scene.touching import touching
from .settings import SHAPES, Settings


def read_surfaces(
    objects: Sequence[bpy.types.Object], settings: Settings, *, without_bands: bool = False
) -> list[Surface]:
    """The surfaces of objects that are decomposed as one, in the chosen shape.

    ``without_bands`` takes the present bands for 0, which gives the shape that they are of. Raises
    Refusal or spectral_tv.MeshError if the objects cannot be read.
    """
    reading = Reading(settings.weld, settings.leaves_out)
    if settings.shape == "APPLIED":
        if len(objects) > 1:
            raise Refusal("only one object at a time is decomposed with its modifiers applied")
        return [Surface.read_applied(objects[0], reading)]
    shapes = [_shape(obj, settings, without_bands) for obj in objects]
    if not without_bands:
        for obj in objects:
            for text in remarks(obj, settings.shape):
                note(text)
    return Surface.read_together(objects, shapes, reading)


def groups(objects: Sequence[bpy.types.Object], settings: Settings) -> list[list[bpy.types.Object]]:
    """The objects in groups that are one surface, as their open edges meet."""
    if settings.shape == "APPLIED":
        return [[obj] for obj in objects]
    reading = Reading(settings.weld, settings.leaves_out)
    found = touching(objects, [_shape(obj, settings, False) for obj in objects], reading)
    return [[objects[index] for index in indices] for indices in found]


def remarks(obj: bpy.types.Object, shape: str) -> list[str]:
    """What of ``obj`` is seen but not decomposed, or decomposed but not its Basis."""
    found = []
    if shape == "APPLIED":
        return found
    keys = mix.told(obj)
    if keys and shape == "SHOWN":
        found.append(f"it is decomposed as shown, with {keys}")
    elif keys:
        found.append(f"its Basis is decomposed, not what is shown with {keys}")
    mirrors = [modifier.name for modifier in symmetries(obj)]
    if mirrors:
        found.append(f"the other half of {', '.join(mirrors)} takes part, and stays joined")
    names = [modifier.name for modifier in passed_over(obj)]
    if names:
        label = next(label for name, label, _ in SHAPES if name == "APPLIED")
        found.append(
            f"what {', '.join(names)} {'changes' if len(names) == 1 else 'change'} is not "
            f"decomposed, but the mesh before; the shape {label!r} takes part in it"
        )
    return found


def _shape(obj: bpy.types.Object, settings: Settings, without_bands: bool) -> np.ndarray | None:
    if settings.shape != "SHOWN":
        return None
    has_bands = without_bands and record_of(obj) is not None
    return mix.shown(obj, [key for key in band_keys(obj) if key] if has_bands else ())
