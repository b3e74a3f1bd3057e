"""The noise of a scan: how strong it is, which bands hold it, and where sharp edges are."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from ..scene.normals import vertex_normals

# Below this share of the edge length noise cannot be told from the curvature of a shape.
LEAST = 0.02
# A filter that took all noise would take the shape along, so that much of it is taken.
TAKEN = 0.9
# What is taken and does not vanish in the mean around a vertex is shape. Relative to the noise:
# below the first the mean is due to chance, beyond the second none is.
CHANCE, SHAPE = 0.3, 0.7
# Such a part of all vertices is away from edges even on machines. Of normal values of size 1 that
# part is below the second.
SMALLEST, SMALL = 0.25, 0.31864
# The smallest and the largest features of the bands, relative to the edge length.
FINEST, LARGEST = 0.4, 4.0
# Half the halvings of the search for a band's value.
HALVINGS = 12


@dataclass(frozen=True)
class Neighbours:
    """The vertices that edges join, of so many."""

    ends: np.ndarray
    count: int

    @classmethod
    def of(cls, triangles: np.ndarray, count: int) -> Neighbours:
        """Those of a mesh."""
        sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        sides = np.sort(sides.astype(np.int64), axis=1)
        keys = np.unique(sides[:, 0] * count + sides[:, 1])
        return cls(np.column_stack(np.divmod(keys, count)), count)

    @cached_property
    def numbers(self) -> np.ndarray:
        """How many there are of each vertex, (N,), at least 1."""
        return np.maximum(np.bincount(self.ends.ravel(), minlength=self.count), 1)

    def sums(self, values: np.ndarray) -> np.ndarray:
        """The sums of values (N,) of the neighbours of each vertex, (N,)."""
        one, other = self.ends.T
        found = np.bincount(one, values[other], self.count)
        return found + np.bincount(other, values[one], self.count)

    def smoothed(self, values: np.ndarray) -> np.ndarray:
        """The means of values (N,) of each vertex with its neighbours, (N,)."""
        return (values + self.sums(values)) / (self.numbers + 1)

    def bilaplacian(self, values: np.ndarray) -> np.ndarray:
        """How far values (N,) are from what their neighbourhood lets expect, (N,)."""
        once = values - self.sums(values) / self.numbers
        return once - self.sums(once) / self.numbers


@dataclass(frozen=True)
class Noise:
    """What is known of the noise of a mesh: its standard deviation along the normals and the
    median length of edges, lengths; the neighbours and the normals (N, 3) of its vertices.
    """

    size: float
    edge: float
    neighbours: Neighbours
    normals: np.ndarray

    @classmethod
    def of(cls, mesh: spectral_tv.Mesh) -> Noise:
        """Estimate it.

        Where the surface is smooth, twice the Laplacian leaves of its normal component the noise
        alone. The smallest values of that do not see edges. They are measured against those of
        noise of size 1. The estimate is too small by up to a tenth where the noise is half an edge.
        """
        vertices, triangles = mesh.vertices, mesh.triangles
        neighbours = Neighbours.of(triangles, len(vertices))
        normals = vertex_normals(vertices, triangles)
        left = sum(
            neighbours.bilaplacian(axis) * normal
            for axis, normal in zip(vertices.T, normals.T, strict=True)
        )
        unit = neighbours.bilaplacian(np.random.default_rng(0).standard_normal(len(vertices)))
        one, other = neighbours.ends.T
        edges = np.linalg.norm(vertices[one] - vertices[other], axis=1)
        size = _spread(left) / max(_spread(unit), np.finfo(float).tiny)
        return cls(float(size), float(np.median(edges)), neighbours, normals)

    @property
    def share(self) -> float:
        """Its size, relative to the length of edges."""
        return self.size / self.edge if self.edge else 0.0

    def values(self, bands: np.ndarray, strength: float) -> list[float]:
        """Values of bands (K, N, 3) that take so many times the noise, finest first.

        By Morozov's principle what is taken is as large as the noise. Its size is told where it is
        small, which is not at edges.
        """
        target = TAKEN * strength * self.size
        values = [0.0] * len(bands)
        taken = np.zeros(len(self.normals))
        for band, moves in enumerate(bands):
            part = self._along(moves)
            if _spread(taken + part) <= target:
                values[band] = -1.0
                taken += part
                continue
            low, high = 0.0, 1.0
            for _ in range(HALVINGS):
                middle = (low + high) / 2
                is_low = _spread(taken + middle * part) <= target
                low, high = (middle, high) if is_low else (low, middle)
            values[band] = -low
            break
        return values

    def mask(self, bands: np.ndarray, values: Sequence[float], strength: float) -> np.ndarray:
        """How much of what is taken is noise, (N,) from 0 to 1: none of it at sharp edges."""
        taken = self._along(np.tensordot(np.asarray(values), bands, 1))
        mean = self.neighbours.smoothed(self.neighbours.smoothed(taken))
        scale = max(strength * self.size, np.finfo(float).tiny)
        x = np.clip((np.abs(mean) / scale - CHANCE) / (SHAPE - CHANCE), 0, 1)
        return 1 - x * x * (3 - 2 * x)

    def _along(self, moves: np.ndarray) -> np.ndarray:
        """Displacements (N, 3) along the normals, (N,)."""
        return np.einsum("ij,ij->i", moves, self.normals)


def _spread(values: np.ndarray) -> float:
    """The standard deviation of normal values of mean 0, by the smallest of them."""
    return float(np.quantile(np.abs(values), SMALLEST)) / SMALL
