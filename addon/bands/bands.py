"""A decomposition as the bands of an object: shape keys, and the record that links them."""

import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import bpy
import numpy as np
import spectral_tv

from ..scene.applying import FOLLOWERS
from ..scene.channels import actions_of, key_path
from ..scene.contents import digest, topology_digest
from ..scene.fingerprints import Likeness
from ..scene.notes import note
from ..scene.objects import Refusal
from ..scene.records import (
    SpectralTVRecord,
    band_keys,
    recognise_bands,
    record_of,
    topology_changed,
)
from ..scene.shape_keys import add_displacements, key_shape
from ..scene.surface import Surface, flattened, shape_of
from . import recut
from .methods import METHODS
from .settings import Settings
from .shapes import read_surfaces
from .solo import end_solo


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
# Values nearer than this are the same.
VISIBLE = 1e-6


def base_shape(
    objects: Sequence[bpy.types.Object], settings: Settings, surfaces: Sequence[Surface]
) -> np.ndarray | None:
    """The base of the method as a shape of the surfaces' mesh, (N, 3); None for the smoothed shape,
    or if it has none.

    Raises Refusal if the shape key it should be does not exist, or is not finite.
    """
    if not settings.by.takes_base or settings.base == "FLOW":
        return None
    if settings.base == "FLAT":
        return flattened(surfaces[0])
    return shape_of(surfaces, [_key_shape(obj, settings.base_key) for obj in objects])


def _key_shape(obj: bpy.types.Object, name: str) -> np.ndarray:
    """The shape that is seen of a key by itself, (V, 3) in object space."""
    keys = obj.data.shape_keys
    if keys is None or name not in keys.key_blocks:
        raise Refusal(f"there is no shape key {name!r} to be the base")
    shape = key_shape(keys.key_blocks[name])
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
    if settings.complaint() is not None:
        raise Refusal(settings.complaint())
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
    keys = _add_keys(obj, settings.method, edges, flow)
    for key in keys:
        key.vertex_group = settings.vertex_group
    _record(obj, settings, surface, split)
    _record_bands(obj, [key.name for key in keys], edges)
    identifier = obj.data.shape_keys.spectral_tv.identifier
    _flows[identifier] = flow
    while len({id(kept.split) for kept in _flows.values()}) > MOST_FLOWS:
        del _flows[next(iter(_flows))]
    return [key.name for key in keys]


def cut_again(obj: bpy.types.Object, count: int) -> list[str]:
    """Cut the remembered flow into ``count`` bands that take the place of the present ones.

    What was set of these goes over, see :mod:`recut`; those that were sculpted since stay, muted.
    Raises Refusal if the flow is no longer in memory or the mesh was changed since.
    """
    record = obj.data.shape_keys.spectral_tv
    if record.identifier not in _flows:
        raise Refusal("its flow is no longer in memory; decompose it again")
    if topology_digest(obj.data) != record.topology:
        raise Refusal("its vertices or faces changed since; decompose it again")
    flow = _flows[record.identifier]
    edges = flow.split.band_edges(count)
    keys = _add_keys(obj, record.method, edges, flow)
    end_solo(obj)
    old, kept = [], []
    for name, likeness in recognise_bands(obj):
        old.append(obj.data.shape_keys.key_blocks[name] if name else None)
        kept.append(likeness == Likeness.CHANGED)
        if kept[-1]:
            note(f"{name!r} was sculpted since; it stays, muted, and is no longer a band")
    former = [(band.start, band.end) for band in record.bands]
    overlap = recut.Overlap.of(former, [*pairwise(edges)], flow.split.times[1:-1])
    if not any(old):
        for key in keys:
            key.vertex_group = settings_of(record).vertex_group
    wanted = _names(record.method, count)
    names = recut.take_place(obj, old, kept, keys, wanted, overlap)
    _record_bands(obj, names, edges)
    return names


def settings_of(record: SpectralTVRecord) -> Settings:
    """What the bands were made by."""
    if not record.settings:  # of 0.1.0
        return Settings(method=record.method, bands=len(record.bands))
    return Settings.of_text(record.settings)


def settings_as_taken(record: SpectralTVRecord) -> Settings:
    """The same with the bands and the steps that there are, whatever decided on them.

    Where modifiers were applied, the object that has the bands is what they showed.
    """
    taken = settings_of(record)
    shape = "BASIS" if taken.shape == "APPLIED" else taken.shape
    steps = len(record.spectrum) + 1
    return replace(taken, bands=len(record.bands), steps=steps, accuracy=0.0, shape=shape)


def set_values(obj: bpy.types.Object, values: list[float]) -> None:
    """Set the values of the bands, leaving out those whose key was deleted.

    What keeps them from being seen is noted.
    """
    keys = band_keys(obj)
    pairs = [(key, value) for key, value in zip(keys, values, strict=True) if key is not None]
    _note_unseen(obj, [key for key, value in pairs if value != key.value])
    cut = []
    for key, value in pairs:
        key.value = min(max(value, key.slider_min), key.slider_max)
        if abs(key.value - value) > VISIBLE:
            cut.append(key.name)
    if cut:
        note(f"cut off at the ends of the sliders: {', '.join(cut)}")


def _note_unseen(obj: bpy.types.Object, keys: list[bpy.types.ShapeKey]) -> None:
    """Note what keeps other values of keys from being seen, or from staying."""
    block = obj.data.shape_keys
    drivers = () if block.animation_data is None else block.animation_data.drivers
    driven = {driver.data_path for driver in drivers}
    keyed = {curve.data_path for animated in actions_of(block) for curve in animated.curves or ()}
    for reason, names in (
        ("muted", [key.name for key in keys if key.mute]),
        ("driven, and do what their drivers say", _among(driven, keys)),
        ("keyframed; Keyframe keeps the new values", _among(keyed, keys)),
    ):
        if names:
            note(f"some of these bands are {reason}: {', '.join(names)}")
    if obj.show_only_shape_key and keys:
        note("only the active shape key is shown: turn Shape Key Lock off to see the mix")


def _among(paths: set[str], keys: list[bpy.types.ShapeKey]) -> list[str]:
    return [key.name for key in keys if key_path(key, "value") in paths]


def follow(obj: bpy.types.Object) -> Callable[[], None]:
    """Note which bands are there; the function returned has the record follow them to other
    vertices and faces.

    The flow, which was on those that were there before, is not theirs any more.
    """
    if record_of(obj) is None or topology_changed(obj):
        return lambda: None
    names = [name for name, _ in recognise_bands(obj)]

    def renew() -> None:
        record = obj.data.shape_keys.spectral_tv
        record.identifier = uuid.uuid4().hex
        _record_topology(obj)
        for band, name in zip(record.bands, names, strict=True):
            if name:
                band.take(obj, "KEY", name)

    return renew


FOLLOWERS.append(follow)


def has_flow(identifier: str) -> bool:
    """Whether the flow of a record is still in memory."""
    return identifier in _flows


def forget_flows() -> None:
    """Free all flows."""
    _flows.clear()


def _record(obj, settings, surface, split) -> None:
    record = obj.data.shape_keys.spectral_tv
    record.identifier = uuid.uuid4().hex
    record.method, record.settings = settings.method, settings.text()
    record.solo = 0
    record.area = surface.mesh.area
    _record_topology(obj)
    record.spectrum.clear()
    for time, strength in zip(split.times[1:-1], split.spectrum, strict=True):
        sample = record.spectrum.add()
        sample.time, sample.strength = time, strength


def _record_topology(obj: bpy.types.Object) -> None:
    record = obj.data.shape_keys.spectral_tv
    record.topology = topology_digest(obj.data)
    record.vertex_count = len(obj.data.vertices)
    record.corner_count = len(obj.data.loops)


def _source(surface: Surface, arguments: dict[str, Any]) -> str:
    """Digest of all that a flow depends on."""
    parts = [surface.mesh.vertices, surface.mesh.triangles]
    for name, value in sorted(arguments.items()):
        parts += [np.frombuffer(name.encode(), dtype=np.uint8), np.asarray(value)]
    return digest(*parts)


def _names(method: str, count: int) -> list[str]:
    return [f"{METHODS[method].key_label} Band {band + 1}" for band in range(count)]


def _add_keys(
    obj: bpy.types.Object, method: str, edges: np.ndarray, flow: Flow
) -> list[bpy.types.ShapeKey]:
    """Add the shape keys of the bands between ``edges``."""
    # One by one, as each is as large as the mesh.
    displacements = (
        flow.surface.to_object(flow.split.bands(np.array(pair)))[0] for pair in pairwise(edges)
    )
    return add_displacements(obj, _names(method, len(edges) - 1), displacements)


def _record_bands(obj: bpy.types.Object, names: list[str], edges: np.ndarray) -> None:
    """Link the record to the shape keys of the bands between ``edges``."""
    bands = obj.data.shape_keys.spectral_tv.bands
    bands.clear()
    for name, start, end in zip(names, edges[:-1], edges[1:], strict=True):
        band = bands.add()
        band.take(obj, "KEY", name)
        band.start, band.end = start, end
