"""From a function on an object to its flow, and from the flow to the results that are written."""

import math
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
import spectral_tv
from spectral_tv.refusal import Refusal

from ..bands.filtering import filter_values
from ..scene import mix
from ..scene.surface import Surface
from .outputs import BAND, REST
from .settings import Settings, chosen_elements
from .sources import Source, read

# A flow to one size starts with steps for spots so many times smaller.
FINER = 20


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
    settings.check()
    source = read(obj, settings.kind, settings.source)
    surface = _surface(obj, source)
    values = source.values
    # Displacements count as lengths on the surface, which is in world scale.
    values = surface.merge_vectors(values) if source.kind == "KEY" else surface.merge(values)
    contrast = float(np.linalg.norm(np.ptp(values, axis=0)))
    if contrast <= 1e-6 * np.abs(values).max():
        raise Refusal(f"{source.name!r} is the same everywhere; there is nothing to flow")
    finest, largest = settings.finest, settings.largest
    if settings.result == "FLOW":
        finest, largest = settings.size / FINER, settings.size
    size = math.sqrt(surface.mesh.area) / 100
    ends = [_time(settings.law, percent * size, contrast) for percent in (finest, largest)]
    times = spectral_tv.graded_times(*ends, settings.steps)
    return Prepared(
        source,
        surface,
        {
            "values": values,
            "times": np.linspace(0, ends[1], settings.steps + 1) if is_even else times,
            "operator": settings.law.lower(),
            **_stepping(settings, values),
        },
    )


def results(
    prepared: Prepared, settings: Settings, flow: spectral_tv.Flow
) -> dict[str, np.ndarray]:
    """What is to be written of a flow, (V, C) on the object's vertices, by its label."""
    if settings.result == "FLOW":
        found = {"Flow": flow.states[-1]}
    else:
        bands = flow.bands(flow.band_edges(settings.bands))
        if settings.result == "BANDS":
            found = {f"{BAND} {number}": band for number, band in enumerate(bands, start=1)}
            found[REST] = flow.residual
        else:
            filtered = np.tensordot(1 + np.array(filter_values(settings)), bands, axes=1)
            found = {"Filtered": filtered + settings.keep_rest * flow.residual}
    surface = prepared.surface
    if prepared.source.kind == "KEY":
        return {label: surface.to_object(each[np.newaxis])[0] for label, each in found.items()}
    return {label: surface.to_vertices(each) for label, each in found.items()}


def _stepping(settings: Settings, values: np.ndarray) -> dict[str, Any]:
    if not settings.is_exact:
        # The package would take exact steps for sets by itself.
        return {"scheme": spectral_tv.DEFAULTS["scheme"]}
    return {"scheme": "exact", "elements": chosen_elements(settings.elements, values)}


def _surface(obj: bpy.types.Object, source: Source) -> Surface:
    """What is seen of ``obj``; without the key that is flowed, as it moves from there."""
    is_key = source.kind == "KEY"
    aside = [obj.data.shape_keys.key_blocks[source.name]] if is_key else []
    return Surface.read(obj, mix.shown(obj, aside))


def _time(law: str, length: float, contrast: float) -> float:
    """When a round spot of this width that stands out by ``contrast`` is gone.

    In the plane, by total variation, a disc of the radius r falls at the rate 2/r; by heat
    6 % of it are left in its middle at the square of its width.
    """
    return contrast * length / 4 if law == "TV" else length**2
