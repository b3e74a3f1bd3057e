"""A decomposition as the bands of an object: shape keys, and the record that links them."""

import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import bpy
import numpy as np
import spectral_tv

from ..scene.objects import Refusal
from ..scene.records import band_keys, coordinates, digest, topology_digest
from ..scene.shape_keys import add_displacements
from ..scene.surface import Surface, flattened, shape_of
from .settings import WITH_BASE, Settings, key_label
from .shapes import read_surfaces


@dataclass(frozen=True)
class Flow:
    """A decomposition, and what it was made of."""

    split: spectral_tv.Decomposition
    surface: Surface
    source: str


# Flows of this session, so that bands are cut anew without flowing again; the last few only,
# as each holds all states. Objects that were decomposed as one share theirs.
_flows: dict[str, Flow] = {}
MOST_FLOWS = 4


def base_shape(
    objects: Sequence[bpy.types.Object], settings: Settings, surfaces: Sequence[Surface]
) -> np.ndarray | None:
    """The base of the method as a shape of the surfaces' mesh, (N, 3); None for the smoothed shape,
    or if it has none.

    Raises Refusal if the shape key it should be does not exist, or is not finite.
    """
    if settings.method not in WITH_BASE or settings.base == "FLOW":
        return None
    if settings.base == "FLAT":
        return flattened(surfaces[0])
    return shape_of(surfaces, [_key_shape(obj, settings.base_key) for obj in objects])


def _key_shape(obj: bpy.types.Object, name: str) -> np.ndarray:
    """The shape of a key by itself, (V, 3) in object space."""
    keys = obj.data.shape_keys
    if keys is None or name not in keys.key_blocks:
        raise Refusal(f"there is no shape key {name!r} to be the base")
    shape = coordinates(keys.key_blocks[name].data).reshape(-1, 3).astype(float)
    broken = np.flatnonzero(~np.isfinite(shape).all(axis=1))
    if len(broken):
        raise Refusal(f"the shape key {name!r} is not finite at vertex {broken[0]}", broken)
    return shape


def prepare(obj: bpy.types.Object, settings: Settings) -> tuple[Surface, dict[str, Any]]:
    """The surface of an object, and the keyword arguments of spectral_tv.decompose.

    Raises Refusal or spectral_tv.MeshError if the object and the settings do not go together.
    """
    surfaces, arguments = prepare_together([obj], settings)
    return surfaces[0], arguments


def prepare_together(
    objects: Sequence[bpy.types.Object], settings: Settings
) -> tuple[list[Surface], dict[str, Any]]:
    """The same of objects that are decomposed as one surface."""
    if settings.band_count >= settings.least_steps:
        raise Refusal(f"{settings.bands} bands need more than {settings.least_steps} steps")
    for obj in objects:
        if settings.vertex_group and settings.vertex_group not in obj.vertex_groups:
            raise Refusal(f"there is no vertex group {settings.vertex_group!r}")
    surfaces = read_surfaces(objects, settings)
    return surfaces, settings.arguments(surfaces[0].mesh, base_shape(objects, settings, surfaces))


def recall(surface: Surface, arguments: dict[str, Any]) -> spectral_tv.Decomposition | None:
    """The flow of the same surface with the same arguments, if it is in memory."""
    source = _source(surface, arguments)
    return next((flow.split for flow in _flows.values() if flow.source == source), None)


def add_bands(
    obj: bpy.types.Object,
    settings: Settings,
    surface: Surface,
    arguments: dict[str, Any],
    split: spectral_tv.Decomposition,
) -> list[str]:
    """Write a decomposition as shape keys, remember it, and return the keys' names.

    Keys of an earlier decomposition stay, but are no longer bands.
    """
    edges = split.band_edges(settings.band_count)
    flow = Flow(split, surface, _source(surface, arguments))
    names = _write(obj, settings.method, settings.vertex_group, edges, flow)
    _record(obj, settings, surface, split)
    identifier = obj.data.shape_keys.spectral_tv.identifier
    _flows[identifier] = flow
    while len({id(kept.split) for kept in _flows.values()}) > MOST_FLOWS:
        del _flows[next(iter(_flows))]
    return names


def cut_again(obj: bpy.types.Object, count: int) -> list[str]:
    """Cut the remembered flow into ``count`` bands that replace the present ones.

    Raises Refusal if the flow is no longer in memory or the mesh was changed since.
    """
    record = obj.data.shape_keys.spectral_tv
    if record.identifier not in _flows:
        raise Refusal("its flow is no longer in memory; decompose it again")
    if topology_digest(obj.data) != record.topology:
        raise Refusal("its vertices or faces changed since; decompose it again")
    flow = _flows[record.identifier]
    edges = flow.split.band_edges(count)
    for key in band_keys(obj):
        if key is not None:
            obj.shape_key_remove(key)
    return _write(obj, record.method, record.vertex_group, edges, flow)


def set_values(obj: bpy.types.Object, values: list[float]) -> None:
    """Set the values of the bands, leaving out those whose key was deleted."""
    for key, value in zip(band_keys(obj), values, strict=True):
        if key is not None:
            key.value = min(max(value, key.slider_min), key.slider_max)


def has_flow(identifier: str) -> bool:
    """Whether the flow of a record is still in memory."""
    return identifier in _flows


def forget_flows() -> None:
    """Free all flows."""
    _flows.clear()


def _record(obj, settings, surface, split) -> None:
    record = obj.data.shape_keys.spectral_tv
    record.identifier = uuid.uuid4().hex
    record.method = settings.method
    record.area = surface.mesh.area
    record.topology = topology_digest(obj.data)
    record.vertex_count = len(obj.data.vertices)
    record.corner_count = len(obj.data.loops)
    record.vertex_group = settings.vertex_group
    record.spectrum.clear()
    for time, strength in zip(split.times[1:-1], split.spectrum, strict=True):
        sample = record.spectrum.add()
        sample.time, sample.strength = time, strength


def _source(surface: Surface, arguments: dict[str, Any]) -> str:
    """Digest of all that a flow depends on."""
    parts = [surface.mesh.vertices, surface.mesh.triangles]
    for name, value in sorted(arguments.items()):
        parts += [np.frombuffer(name.encode(), dtype=np.uint8), np.asarray(value)]
    return digest(*parts)


def _write(
    obj: bpy.types.Object,
    method: str,
    vertex_group: str,
    edges: np.ndarray,
    flow: Flow,
) -> list[str]:
    """Add the shape keys of the bands between ``edges`` and link the record to them."""
    names = [f"{key_label(method)} Band {band + 1}" for band in range(len(edges) - 1)]
    # One by one, as each is as large as the mesh.
    displacements = (
        flow.surface.to_object(flow.split.bands(np.array(pair)))[0] for pair in pairwise(edges)
    )
    keys = add_displacements(obj, names, displacements)
    bands = obj.data.shape_keys.spectral_tv.bands
    bands.clear()
    for key, start, end in zip(keys, edges[:-1], edges[1:], strict=True):
        key.vertex_group = vertex_group
        band = bands.add()
        band.key, band.digest = key.name, digest(coordinates(key.data))
        band.start, band.end = start, end
    return [key.name for key in keys]
