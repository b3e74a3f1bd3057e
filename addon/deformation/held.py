"""What is held and what is pulled of an object, as triangles to draw over what is shown of it."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import bpy
import numpy as np

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
        self._picked: Picked | None = None
        self._strengths = np.zeros((0, 2), dtype=np.float32)
        self._next_look = 0.0
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
        is_new = question != self._question
        if is_new or (self._is_outdated and time.monotonic() >= self._next_look):
            self._read(obj)
        elif picked is self._picked and not self._is_moved and self._layer is not None:
            return self._layer
        self._question, self._picked, self._is_moved = question, picked, False
        self._layer = _layer(obj, graph, _with(self._strengths, picked))
        return self._layer

    def _read(self, obj: bpy.types.Object) -> None:
        started = time.monotonic()
        self._strengths = strengths(obj)
        ended = time.monotonic()
        self._next_look = ended + max(LOOK, LOOK_SHARE * (ended - started))
        self._is_outdated = False


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


def _layer(obj: bpy.types.Object, graph: bpy.types.Depsgraph, firm: np.ndarray) -> Layer:
    corners = triangles(obj.data)
    corners = corners[(firm > 0).any(axis=1)[corners].any(axis=1)]
    used, corners = np.unique(corners, return_inverse=True)
    corners = corners.reshape(-1, 3).astype(np.int32)
    shown = obj.evaluated_get(graph).data
    is_exact = len(shown.vertices) == len(obj.data.vertices)
    if is_exact:
        places = [used]
        positions = coordinates(shown.vertices).reshape(-1, 3)
    else:  # where the other half is held likewise
        copies = mirrored(obj, mix.shown(obj), symmetries(obj))
        places, positions = copies.places[:, used], copies.positions
    return Layer(
        np.concatenate([positions[each] for each in places]).astype(np.float32),
        np.concatenate([corners + number * len(used) for number in range(len(places))]),
        np.tile(firm[used], (len(places), 1)),
        is_exact,
    )
