"""Decompositions as bands of objects: prepared, started, remembered, set."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import bpy
import spectral_tv
from spectral_tv.bands.settings import BEFORE, ON_NEW_OBJECT, SMOOTHED, Settings
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.together import Together
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene import keeping, shape_keys
from ..scene.applying import FOLLOWERS
from ..scene.contents import digest, topology_digest
from ..scene.decomposition import SpectralTVRecord
from ..scene.objects import user_of
from ..scene.records import (
    bands_of,
    keeping_of,
    new_identity,
    recognise_all,
    record_of,
    records_of,
    topology_changed,
)
from ..scene.surface import Surface, flattened, shape_of
from ..scene.weights import group_named
from . import replacing, shapes


@dataclass(frozen=True)
class Flow:
    """A decomposition, and what it was made of."""

    split: spectral_tv.Decomposition
    surface: Surface
    source: str


# Flows of this session, so that bands are cut anew without flowing again; the last few only,
# as each holds all states. Objects that were decomposed as one share theirs.
flows: dict[str, Flow] = {}
MOST_FLOWS = 4
# Vertices of bands that are held at once.
MOST_VALUES = 10_000_000
# Values nearer than this are the same.
VISIBLE = 1e-6


def base_shape(
    objects: Sequence[bpy.types.Object], settings: Settings, surfaces: Sequence[Surface]
) -> np.ndarray | None:
    """The base of the method as a shape of the surfaces' mesh, (N, 3); None for the smoothed shape,
    or if it has none.

    Raises Refusal if the shape key it should be does not exist, or is not finite.
    """
    if not settings.by.takes("base") or settings.base in SMOOTHED:
        return None
    if settings.base == "FLAT":
        return flattened(surfaces[0])
    name = settings.base_key
    given = [shape_keys.key_shape(obj.data, name, "to be the base") for obj in objects]
    for shape in given:
        broken = np.flatnonzero(~np.isfinite(shape).all(axis=1))
        if len(broken):
            raise Refusal(f"the shape key {name!r} is not finite at vertex {broken[0]}", broken)
    return shape_of(surfaces, given)


def prepare(obj: bpy.types.Object, settings: Settings) -> tuple[Surface, dict[str, Any]]:
    """The surface of an object, and the keyword arguments of spectral_tv.decompose.

    Raises Refusal or spectral_tv.MeshError if the object and the settings do not go together.
    """
    surfaces, arguments = prepare_together([obj], settings)
    return surfaces[0], arguments


def prepare_together(
    objects: Sequence[bpy.types.Object], settings: Settings, area: float | None = None
) -> tuple[list[Surface], dict[str, Any]]:
    """The same of objects that are decomposed as one surface; sizes are relative to its area, or to
    another one."""
    if settings.complaint() is not None:
        raise Refusal(settings.complaint())
    for obj in objects if settings.vertex_group else ():
        group_named(obj, settings.vertex_group)
    for obj in objects:
        reason = place_refusal(obj, settings)
        if reason is not None:
            raise Refusal(reason[0].lower() + reason[1:])
    surfaces = shapes.read_surfaces(objects, settings)
    base = base_shape(objects, settings, surfaces)
    return surfaces, settings.arguments(surfaces[0].mesh, base, area)


def place_refusal(obj: bpy.types.Object, settings: Settings) -> str | None:
    """Why bands of an object cannot be kept as asked, in a sentence; None if they can."""
    if settings.shape in ON_NEW_OBJECT:
        return None
    record = replacing.replaced(obj, settings)
    former = None if record is None else keeping_of(record).refusal(obj)
    return former or keeping.PLACES[settings.bands_as].refusal(obj)


def recall(surface: Surface, arguments: dict[str, Any]) -> spectral_tv.Decomposition | None:
    """The flow of the same surface with the same arguments, if it is in memory."""
    source = source_of(surface, arguments)
    return next((flow.split for flow in flows.values() if flow.source == source), None)


def start_split(
    mesh: spectral_tv.Mesh, settings: Settings, arguments: dict[str, Any]
) -> spectral_tv.Job | Together:
    """Start to decompose a mesh, and to measure what its bands are cut by."""
    decomposing = spectral_tv.start_decompose(mesh, **arguments)
    # A base that keeps limbs measures the thickness itself.
    if not settings.limbs_kept or arguments.get("base") == "limbs":
        return decomposing
    return Together(decomposing, spectral_tv.start_thickness(mesh))


def keep_flow(identifier: str, flow: Flow) -> None:
    """Remember a flow, and let go of the oldest one if there are too many."""
    flows[identifier] = flow
    while len({id(kept.split) for kept in flows.values()}) > MOST_FLOWS:
        del flows[next(iter(flows))]


def parts_of(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """An object and those that were decomposed with it as one surface, as far as their flows are in
    memory: one for each mesh, copies are none."""
    identifier = record_of(obj).identifier
    own, found = flows.get(identifier), [obj]
    if own is None:
        return found
    for mesh in {each.data for each in bpy.data.objects if record_of(each) is not None}:
        other = user_of(mesh)
        theirs = record_of(other).identifier
        is_other = theirs != identifier and theirs in flows
        if is_other and flows[theirs].surface.mesh is own.surface.mesh:
            found.append(other)
    return found


def flow_of(obj: bpy.types.Object) -> Flow:
    """The flow that the bands of an object are cut from.

    Raises Refusal if it is no longer in memory or the mesh was changed since.
    """
    record = record_of(obj)
    if record.identifier not in flows:
        raise Refusal("its flow is no longer in memory; decompose it again")
    if topology_digest(obj.data) != record.topology:
        raise Refusal("its vertices or faces changed since; decompose it again")
    return flows[record.identifier]


def settings_of(record: SpectralTVRecord) -> Settings:
    """What the bands were made by."""
    if not record.settings:  # of 0.1.0
        return Settings(method=record.method, bands=len(record.bands), **BEFORE)
    return Settings.of_text(record.settings)


def settings_as_taken(record: SpectralTVRecord) -> Settings:
    """The settings of a record, with the numbers of bands and steps that were in fact taken.

    If the bands were made on a new object, that is the shape that was decomposed.
    """
    taken = settings_of(record)
    shape = "BASIS" if taken.shape in ON_NEW_OBJECT else taken.shape
    steps = len(record.kept_spectrum) + 1
    return replace(taken, bands=len(record.bands), steps=steps, accuracy=0.0, shape=shape)


def set_values(
    obj: bpy.types.Object, values: list[float], record: SpectralTVRecord | None = None
) -> None:
    """Set the values of the bands of a decomposition, except of those whose key was deleted.

    That is the active one if none is named. What keeps the bands from being seen is noted.
    """
    bands = bands_of(obj, record)
    pairs = [(key, value) for key, value in zip(bands, values, strict=True) if key is not None]
    _note_unseen(obj, [key for key, value in pairs if value != key.value])
    cut = []
    for key, value in pairs:
        shape_keys.make_room(key, value)
        key.value = min(max(value, key.slider_min), key.slider_max)
        if abs(key.value - value) > VISIBLE:
            cut.append(key.name)
    if cut:
        note(f"cut off at the ends of the sliders: {', '.join(cut)}")


def _note_unseen(obj: bpy.types.Object, bands: list[keeping.Band]) -> None:
    """Note what keeps other values of bands from being seen, or from staying."""
    for reason, is_so in (
        ("muted", lambda band: band.mute),
        (
            "driven, and do what their drivers say",
            lambda band: keeping.place_of(band).animation_of(band, "value") == "driven",
        ),
        (
            "keyframed; Keyframe keeps the new values",
            lambda band: keeping.place_of(band).animation_of(band, "value") == "keyed",
        ),
    ):
        names = [band.name for band in bands if is_so(band)]
        if names:
            note(f"some of these bands are {reason}: {', '.join(names)}")
    if obj.show_only_shape_key and any(keeping.place_of(band).written == "KEY" for band in bands):
        note("only the active shape key is shown: turn Shape Key Lock off to see the mix")


def follow(obj: bpy.types.Object) -> Callable[[], None]:
    """Note which bands there are; calling the result has the records follow them to a new topology.

    Flows belong to the former vertices and faces, so the records lose them.
    """
    followed = [
        [name for name, _ in likes] if not topology_changed(obj, record) else None
        for record, likes in recognise_all(obj)
    ]

    def renew() -> None:
        for record, names in zip(records_of(obj), followed, strict=True):
            if names is None:
                continue
            new_identity(obj, record)
            for band, name in zip(record.bands, names, strict=True):
                if name:
                    band.take(obj, keeping_of(record).written, name)

    return renew


FOLLOWERS.append(follow)


def source_of(surface: Surface, arguments: dict[str, Any]) -> str:
    """Digest of all that a flow depends on."""
    parts = [surface.mesh.vertices, surface.mesh.triangles]
    for name, value in sorted(arguments.items()):
        parts += [np.frombuffer(name.encode(), dtype=np.uint8), np.asarray(value)]
    return digest(*parts)


def displacements(flow: Flow, edges: np.ndarray, keep_limbs: float) -> Iterator[np.ndarray]:
    """What each band between ``edges`` adds to an object, (V, 3) each."""
    # One by one where they are large. Together they take less time, as they share their ends.
    is_large = (len(edges) - 1) * len(flow.surface.place) > MOST_VALUES
    for some in pairwise(edges) if is_large else (edges,):
        for band in flow.split.bands(np.array(some), keep_limbs):
            yield flow.surface.to_object(band[np.newaxis])[0]
