"""From a function on an object to its flow, and from the flow to the results that are written."""

from __future__ import annotations

from typing import Any

import bpy
import spectral_tv
from spectral_tv.attributes.flows import arguments, functions
from spectral_tv.bands.filtering import FILTERED, filter_values
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from ..bands import filter_curve
from ..scene import mix
from ..scene.surface import Surface
from .settings import Settings
from .sources import Source, read


@dataclass(frozen=True)
class Prepared:
    """A function, the surface it is on, and the arguments of spectral_tv.flow after the mesh."""

    source: Source
    surface: Surface
    arguments: dict[str, Any]


def prepare(obj: bpy.types.Object, settings: Settings, is_even: bool = False) -> Prepared:
    """Read what is to be flowed, in even steps or in steps that grow with the time.

    Raises Refusal or spectral_tv.MeshError if the object and the choice do not go together.
    """
    settings.check(filter_curve.current())
    source = read(obj, settings.kind, settings.source)
    surface = _surface(obj, source)
    values = source.values
    # Displacements count as lengths on the surface, which is in world scale.
    values = surface.merge_vectors(values) if source.kind == "KEY" else surface.merge(values)
    found = arguments(source.name, values, surface.mesh.area, settings, is_even=is_even)
    return Prepared(source, surface, found)


def results(
    prepared: Prepared, settings: Settings, flow: spectral_tv.Flow
) -> dict[str, np.ndarray]:
    """What is to be written of a flow, (V, C) on the object's vertices, by its label."""
    is_filtered = FILTERED.holds(settings)
    values = filter_values(settings, filter_curve.current()) if is_filtered else []
    found, surface = functions(flow, settings, values), prepared.surface
    if prepared.source.kind == "KEY":
        return {label: surface.to_object(each[np.newaxis])[0] for label, each in found.items()}
    return {label: surface.to_vertices(each) for label, each in found.items()}


def _surface(obj: bpy.types.Object, source: Source) -> Surface:
    """What is seen of ``obj``; without the key that is flowed, as it moves from there."""
    is_key = source.kind == "KEY"
    aside = [obj.data.shape_keys.key_blocks[source.name]] if is_key else []
    return Surface.read(obj, mix.shown(obj, aside))
