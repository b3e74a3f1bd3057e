"""What is held and what is pulled of an object, as triangles to draw over what is shown of it."""

from __future__ import annotations

import time
from collections.abc import Iterator

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from ..scene import mix
from ..scene.coordinates import coordinates, triangles
from ..scene.mirroring import mirrored
from ..scene.modifiers import symmetries
from .constraints import deformation_of
from .handles import group_weights

# Seconds between two readings of weights, and the least in terms of what a reading takes.
LOOK = 0.25
LOOK_SHARE = 20


@dataclass(frozen=True)
class Picked:
    """Vertices that are held and pulled beside those of constraints, of an object of ``count``."""

    held: np.ndarray
    pulled: np.ndarray
    count: int


@dataclass(frozen=True)
class Layer:
    """Triangles to draw: ``positions`` (P, 3) in object space, ``corners`` (T, 3) among them.

    ``strengths`` (P, 2) in [0, 1] tell how firmly they are held, and pulled. ``is_exact`` tells
    whether the positions are those that are shown.
    """

    positions: np.ndarray
    corners: np.ndarray
    strengths: np.ndarray
    is_exact: bool


class Held:
    """The layer of one object, worked out anew only where something has changed."""

    def __init__(self) -> None:
        """Know nothing yet."""
        self._question: tuple | None = None
        self._triangles = np.zeros((0, 3), dtype=np.int32)
        self._strengths = np.zeros((0, 2), dtype=np.float32)
        self._next_look = 0.0
        self._picked: Picked | None = None
        self._patch: _Patch | None = None
        self._is_outdated = self._is_moved = True
        self._layer: Layer | None = None

    def notice(self) -> None:
        """Take note that Blender updated the object's mesh, which may mean shape or weights."""
        self._is_outdated = self._is_moved = True

    @property
    def wait(self) -> float | None:
        """Seconds until weights that may have changed are read; None if there are none."""
        return max(self._next_look - time.monotonic(), 0.0) if self._is_outdated else None

    def layer(
        self, obj: bpy.types.Object, graph: bpy.types.Depsgraph, picked: Picked | None = None
    ) -> Layer:
        """The layer of ``obj``, the same one as before if nothing has changed."""
        question = _question(obj)
        if question != self._question or (
            self._is_outdated and time.monotonic() >= self._next_look
        ):
            self._read(obj)
            self._question, self._patch = question, None
        if self._patch is None or picked is not self._picked:
            self._patch = _Patch.of(self._triangles, _with(self._strengths, picked))
            self._picked, self._is_moved = picked, True
        if self._is_moved:
            self._layer, self._is_moved = self._patch.layer(obj, graph), False
        return self._layer

    def _read(self, obj: bpy.types.Object) -> None:
        started = time.monotonic()
        self._triangles, self._strengths = triangles(obj.data), strengths(obj)
        ended = time.monotonic()
        self._next_look = ended + max(LOOK, LOOK_SHARE * (ended - started))
        self._is_outdated = False


@dataclass(frozen=True)
class _Patch:
    """The constrained ``vertices`` of an object and their neighbors, (P,); the rest is as a Layer's
    of the object alone.
    """

    vertices: np.ndarray
    corners: np.ndarray
    strengths: np.ndarray

    @classmethod
    def of(cls, every: np.ndarray, firm: np.ndarray) -> _Patch:
        """The part of ``every`` triangle (F, 3) with a corner that is held or pulled, (V, 2)."""
        corners = every[firm.any(axis=1)[every].any(axis=1)]
        is_used = np.zeros(len(firm), dtype=bool)
        is_used[corners] = True
        place = np.cumsum(is_used, dtype=np.int32) - 1
        return cls(np.flatnonzero(is_used), place[corners], firm[is_used])

    def layer(self, obj: bpy.types.Object, graph: bpy.types.Depsgraph) -> Layer:
        """The same where it is shown."""
        shown, count = obj.evaluated_get(graph).data, len(self.vertices)
        if len(shown.vertices) == len(obj.data.vertices):
            positions = coordinates(shown.vertices).reshape(-1, 3)[self.vertices]
            return Layer(positions, self.corners, self.strengths, True)
        # The other half is held likewise.
        copies = mirrored(obj, mix.shown(obj), symmetries(obj))
        places = copies.places[:, self.vertices]
        corners = [self.corners + number * count for number in range(len(places))]
        return Layer(
            copies.positions[places.ravel()].astype(np.float32),
            np.concatenate(corners),
            np.tile(self.strengths, (len(places), 1)),
            False,
        )


def strengths(obj: bpy.types.Object) -> np.ndarray:
    """How firmly constraints hold and pull the vertices of ``obj``, (V, 2) in [0, 1]."""
    found = np.zeros((len(obj.data.vertices), 2), dtype=np.float32)
    named = dict(_constrained(obj))
    weights = group_weights(obj, named.keys() & {*obj.vertex_groups.keys()})
    for name, (vertices, values) in weights.items():
        for column in named[name]:
            np.maximum.at(found[:, column], vertices, values)
    return found


def _constrained(obj: bpy.types.Object) -> Iterator[tuple[str, set[int]]]:
    """The vertex groups of constraints, and whether they are held, 0, or pulled, 1."""
    found: dict[str, set[int]] = {}
    for each in deformation_of(obj).constraints:
        found.setdefault(each.vertex_group, set()).add(int(each.kind != "PIN"))
    yield from found.items()


def _question(obj: bpy.types.Object) -> tuple:
    """What weights are read by; Blender tells of no change of some of it."""
    return (
        obj.data.session_uid,
        len(obj.data.vertices),
        len(obj.data.loops),
        *((name, *sorted(of), obj.vertex_groups.find(name)) for name, of in _constrained(obj)),
    )


def _with(found: np.ndarray, picked: Picked | None) -> np.ndarray:
    if picked is None or picked.count != len(found):
        return found
    found = found.copy()
    found[picked.held, 0] = found[picked.pulled, 1] = 1
    return found
