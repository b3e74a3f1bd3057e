"""The constraints of an object at the vertices of its surface.

Several vertices of an object may be one vertex of its surface. A mirrored object has another half,
which is held and moved likewise.
"""

from __future__ import annotations

from functools import cached_property

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.deformation.held import Held
from spectral_tv.later import np
from spectral_tv.means import means
from spectral_tv.refusal import Refusal

from ..scene.surface import Surface
from .constraints import identified
from .handles import Handles

# Of the size of what is constrained, targets this far apart are the same.
SAME_PLACE = 1e-6


@dataclass(frozen=True)
class Grips:
    """Constrained vertices: ``indices`` (K,) in the surface's mesh, ``weights`` (K,) in (0, 1].

    ``owners`` (K,) are the identifiers of their constraints, ``is_own`` (K,) tells which are in
    the object's own half, and not on a plane of symmetry. ``entries`` (E, 3) say which vertex of
    the handles, in which copy of the object, goes to which of the K.
    """

    surface: Surface
    handles: Handles
    indices: np.ndarray
    weights: np.ndarray
    owners: np.ndarray
    is_own: np.ndarray
    entries: np.ndarray

    @classmethod
    def read(cls, obj: bpy.types.Object) -> Grips:
        """Read the constraints and the surface of ``obj``.

        Raises Refusal or spectral_tv.MeshError if one of them cannot be used.
        """
        handles, surface = Handles.read(obj), Surface.read(obj)
        places = surface.copies.places[:, handles.indices]
        copies, vertices = np.nonzero(places >= 0)
        for owner, constraint in identified(obj).items():
            if not (handles.owners[vertices] == owner).any():
                raise Refusal(f"the vertices of {constraint.vertex_group!r} have no finite place")
        pairs = np.column_stack([handles.owners[vertices], places[copies, vertices]])
        found, which = np.unique(pairs, axis=0, return_inverse=True)
        which = which.ravel()
        weights, is_own = np.zeros(len(found)), np.zeros(len(found), dtype=bool)
        np.maximum.at(weights, which, handles.weights[vertices])
        is_own[which[copies == 0]] = True
        is_own[which[copies > 0]] = False
        entries = np.column_stack([vertices, copies, which])
        return cls(surface, handles, found[:, 1], weights, found[:, 0], is_own, entries)

    @property
    def rest(self) -> np.ndarray:
        """Where they are, in the space of the surface, (K, 3)."""
        return self.surface.mesh.vertices[self.indices]

    def held(self, obj: bpy.types.Object) -> Held:
        """The same for a solver."""
        return Held(self.surface.mesh, self.indices, self.weights, lambda: self.bodies(obj))

    def targets(self, obj: bpy.types.Object) -> np.ndarray:
        """Where they go now, in the space of the surface, (K, 3).

        Raises Refusal as `Handles.targets` does, or if two constraints send a vertex to different
        places.
        """
        shifts = self.handles.targets(obj) - self.handles.positions
        vertices, copies, which = self.entries.T
        turned = self.surface.copies.turned(shifts)[copies, vertices] @ self.surface.matrix.T
        targets = self.rest + means(which, turned, len(self.indices))
        self._check_overlaps(obj, targets)
        return targets

    def bodies(self, obj: bpy.types.Object) -> np.ndarray:
        """Numbers of the bodies that turn freely, (K,); −1 for vertices that go to their targets.

        The copies of a mirrored object have a body each, or one where they meet. Raises Refusal if
        a vertex is in the free bodies of two constraints.
        """
        constraints = identified(obj)
        free = [owner for owner, each in constraints.items() if each.is_free]
        is_free = np.isin(self.owners, free)
        vertices, counts = np.unique(self.indices[is_free], return_counts=True)
        if (counts > 1).any():
            shared = vertices[counts > 1]
            owners = self.owners[is_free & (self.indices == shared[0])]
            one, two = (constraints[owner].vertex_group for owner in owners[:2])
            raise Refusal(
                f"{len(shared)} vertices are in both {one!r} and {two!r}, which are free to turn: "
                "have one of them turn with its handle, or leave them out of one"
            )
        return np.where(is_free, self._parts, -1)

    @cached_property
    def _parts(self) -> np.ndarray:
        """Numbers of the parts, (K,): all that a constraint holds of copies that meet."""
        _, copies, which = self.entries.T
        first = np.full(len(self.indices), len(self.surface.copies.places))
        np.minimum.at(first, which, copies)
        numbers = np.full(len(self.indices), -1)
        count = 0
        for owner in np.unique(self.owners):
            mine = self.owners[which] == owner
            root = {copy: copy for copy in np.unique(copies[mine]).tolist()}
            met = np.unique(np.column_stack([first[which], copies])[mine], axis=0)
            for one, other in met.tolist():
                low, high = sorted((root[one], root[other]))
                root = {copy: low if each == high else each for copy, each in root.items()}
            for copy, part in root.items():
                numbers[(self.owners == owner) & (first == copy)] = count + part
            count += len(self.surface.copies.places)
        return numbers

    def _check_overlaps(self, obj: bpy.types.Object, targets: np.ndarray) -> None:
        exact = np.flatnonzero(self.weights == 1)
        vertices, first, inverse = np.unique(
            self.indices[exact], return_index=True, return_inverse=True
        )
        if len(vertices) == len(exact):
            return
        other = exact[first][inverse.ravel()]
        scale = np.ptp(self.rest, axis=0).max()
        apart = np.abs(targets[exact] - targets[other]).max(axis=1) > SAME_PLACE * scale
        if not apart.any():
            return
        entry = int(np.argmax(apart))
        constraints = identified(obj)
        one, two = (
            constraints[self.owners[index]].vertex_group for index in (other[entry], exact[entry])
        )
        sent = self.entries[np.isin(self.entries[:, 2], exact[apart]), 0]
        vertices = np.unique(self.handles.indices[sent])
        raise Refusal(
            f"{len(vertices)} vertices, such as {vertices[0]}, are in both {one!r} and {two!r}, "
            "which go to different places",
            vertices,
        )
