"""Fields of one surface on another one that is in about the same place."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_tv._fitting import fitted
from spectral_tv._frames import Links, turns, vertex_normals
from spectral_tv._native import Mesh, MeshError, Nearest
from spectral_tv._results import Numbers, _Result

#: How far a surface may be, relative to the size of the other one, where nothing else is asked for.
FARTHEST = 0.05
#: Edges over which a field falls to 1/e where no surface was near enough.
FADING = 3.0
#: A field that changes less from one round to the next, relative to its largest value, is settled.
SETTLED = 1e-6

Fit = Literal["none", "rigid", "similar"]


@dataclass(frozen=True, eq=False)
class Transfer(_Result):
    """Where each of N vertices of a target is on a source of V vertices, found by `transfer`.

    Attributes
    ----------
    corners : int64 array
        The three vertices of the source's triangle that a vertex is on, (N, 3); 0 if it is missed.
    weights : array
        The shares of these, (N, 3), of sum 1; 0 if it is missed.
    turns : array
        How the target is turned there against the source, without the fit, (N, 3, 3): rotations.
    missed : bool array
        Whether no surface of the source that faces the same way is near enough, (N,).
    distances : array
        How far the source is after the fit, (N,), length; infinity if it is missed.
    fit : array
        What takes the source to where it was looked for, (4, 4); the identity without a fit.
    deviation : float
        The median distance of the samples that were fitted, length; 0 without a fit.
    """

    corners: NDArray[np.int64] = field(repr=False)
    weights: Numbers = field(repr=False)
    turns: Numbers = field(repr=False)
    missed: NDArray[np.bool_] = field(repr=False)
    distances: Numbers = field(repr=False)
    fit: Numbers
    deviation: float
    _links: Links = field(repr=False)
    _count: int = field(repr=False)

    @property
    def scale(self) -> float:
        """How much larger the fit makes the source."""
        return float(np.cbrt(np.linalg.det(self.fit[:3, :3])))

    def values(self, values: ArrayLike) -> Numbers:
        """Values of the source's vertices, (V,) or (V, C), at those of the target, (N, …).

        Vertices that were missed have those of their neighbours, which fade over some three edges.
        Raises MeshError if the values are not of the source.
        """
        given = np.asarray(values, dtype=np.float64)
        if given.ndim not in (1, 2) or len(given) != self._count:
            raise MeshError(
                f"values must have {self._count} rows, one for each vertex, not {given.shape}"
            )
        return self._faded(self._at(given.reshape(len(given), -1))).reshape(-1, *given.shape[1:])

    def vectors(self, vectors: ArrayLike) -> Numbers:
        """Displacements of the source's vertices, (V, 3) or (K, V, 3), as those of the target's.

        They are turned as the target is and as large as the fit makes them. Vertices that were
        missed move as `values` says. Raises MeshError if the displacements are not of the source.
        """
        given = np.asarray(vectors, dtype=np.float64)
        if given.ndim not in (2, 3) or given.shape[-2:] != (self._count, 3):
            raise MeshError(
                f"vectors must have the shape ({self._count}, 3), or several of them, "
                f"not {given.shape}"
            )
        turned = self.turns @ self.fit[:3, :3]
        each = [
            np.einsum("nij,nj->ni", turned, self._at(one))
            for one in given.reshape(-1, *given.shape[-2:])
        ]
        found = [self._faded(one) for one in each]
        return found[0] if given.ndim == 2 else np.array(found).reshape(len(given), -1, 3)

    def _at(self, values: Numbers) -> Numbers:
        """Values (V, C) at the places, (N, C); 0 where there is none."""
        # One corner after the other: three of all would take three times the memory.
        weights, corners = self.weights, self.corners
        return sum(weights[:, k, np.newaxis] * values[corners[:, k]] for k in range(3))

    def _faded(self, values: Numbers) -> Numbers:
        """Values (N, C) with those that were missed as the others around fade."""
        missed = np.flatnonzero(self.missed)
        if not len(missed):
            return values
        ways, owners = self._links.leaving(missed)
        ends = self._links.ends[ways]
        counts = np.maximum(np.bincount(owners, minlength=len(missed)), 1)
        share = 1.0 / (counts * np.cosh(1.0 / FADING))
        largest = np.abs(values).max(initial=0.0)
        while True:  # each round brings it nearer by a twentieth at least
            around = np.column_stack(
                [np.bincount(owners, column[ends], len(missed)) for column in values.T]
            )
            around *= share[:, np.newaxis]
            change = np.abs(around - values[missed]).max(initial=0.0)
            values[missed] = around
            if change <= SETTLED * largest:
                return values


def transfer(
    source: Mesh, target: Mesh, farthest: float | None = None, fit: Fit = "none"
) -> Transfer:
    """Find where the vertices of one surface are on another one, to take fields from it.

    A vertex goes to the nearest point of the source whose triangle faces as the target does there,
    to within 90°. The rotation of the target against the source is that which takes the places
    of the vertices around to these vertices: normal to normal, and then in the plane across it by
    least squares, both over some three edges. So bumps finer than the target's edges do not count.

    >>> taken = spectral_tv.transfer(scan, retopology)
    >>> bands = taken.vectors(split.bands(split.band_edges(5)))   # (5, N, 3)

    Parameters
    ----------
    source : Mesh
        The surface that has the fields.
    target : Mesh
        The surface that takes them, in about the same place.
    farthest : float, optional
        The length within which the source is looked for. By default 5 % of the root of the target's
        area.
    fit : {"none", "rigid", "similar"}
        Whether the source is first taken to the target as a whole: turned and moved, or scaled as
        well. It is found by iterated closest points (Besl and McKay 1992) from several beginnings:
        the four fifths of some thousand samples count that fit best.

    Returns
    -------
    Transfer

    Raises
    ------
    MeshError
        If `farthest` is negative, or there is no such fit.
    MemoryError
        If the work does not fit into what is available.
    """
    if fit not in ("none", "rigid", "similar"):
        raise MeshError(f'fit must be "none", "rigid" or "similar", not {fit!r}')
    length = FARTHEST * np.sqrt(target.area) if farthest is None else farthest
    nearest = Nearest(source)
    points, triangles = target.vertices, target.triangles
    normals = vertex_normals(points, triangles)
    motion, deviation = np.eye(4), 0.0
    if fit != "none":
        motion, deviation = fitted(nearest, source, target, normals, fit == "similar")
    # The source stays where it is, and the target is taken to it.
    back = np.linalg.inv(motion)
    scale = np.cbrt(np.linalg.det(motion[:3, :3]))
    there = points @ back[:3, :3].T + back[:3, 3]
    reach = length if fit == "none" else length / scale
    faces, weights, distances = nearest.find(there, normals @ motion[:3, :3], reach)
    missed = faces < 0
    corners = source.triangles[np.maximum(faces, 0)]
    corners[missed] = 0
    places = np.einsum("nk,nkj->nj", weights, source.vertices[corners])
    places = places @ motion[:3, :3].T + motion[:3, 3]
    links = Links.of(triangles, len(points))
    turned = turns(links, triangles, places, points, ~missed)
    return Transfer(
        corners, weights, turned, missed, scale * distances, motion, deviation, links,
        len(source.vertices)
    )  # fmt: skip
