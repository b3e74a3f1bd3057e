"""Distances along a surface from one place on it, worked out as far as they are asked for."""

from __future__ import annotations

from spectral_tv.dataclass import dataclass
from spectral_tv.later import np


@dataclass(frozen=True)
class Links:
    """Straight ways on a mesh of N vertices: its edges, and ways across an edge of two triangles.

    Those of vertex v lead to ``ends[starts[v]:starts[v + 1]]``; ``lengths`` are as the ends.
    """

    starts: np.ndarray
    ends: np.ndarray
    lengths: np.ndarray

    @classmethod
    def of(cls, vertices: np.ndarray, triangles: np.ndarray) -> Links:
        """The ways of a mesh: ``vertices`` (N, 3), ``triangles`` (F, 3)."""
        count = len(vertices)
        corners = np.concatenate([triangles[:, [0, 1, 2]], triangles[:, [1, 2, 0]],
                                  triangles[:, [2, 0, 1]]]).astype(np.int64)  # fmt: skip
        corners[:, :2].sort(axis=1)
        corners = corners[np.argsort(corners[:, 0] * count + corners[:, 1], kind="stable")]
        is_same = (corners[1:, :2] == corners[:-1, :2]).all(axis=1)
        edges = corners[np.concatenate([[True], ~is_same]), :2]
        pairs, lengths = _across(vertices, corners[:-1][is_same], corners[1:][is_same, 2])
        pairs = np.concatenate([edges, pairs])
        reach = vertices[edges[:, 1]] - vertices[edges[:, 0]]
        lengths = np.concatenate([np.linalg.norm(reach, axis=1), lengths])
        begins = np.concatenate([pairs[:, 0], pairs[:, 1]])
        order = np.argsort(begins, kind="stable")
        starts = np.concatenate([[0], np.cumsum(np.bincount(begins, minlength=count))])
        ends = np.concatenate([pairs[:, 1], pairs[:, 0]])[order]
        return cls(starts, ends, np.concatenate([lengths, lengths])[order])

    def leaving(self, vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """All ways from some vertices: places in ``ends``, and which of these each one leaves."""
        counts = self.starts[vertices + 1] - self.starts[vertices]
        owners = np.repeat(np.arange(len(vertices)), counts)
        firsts = np.cumsum(counts) - counts
        return self.starts[vertices][owners] + np.arange(len(owners)) - firsts[owners], owners


def _across(
    vertices: np.ndarray, corners: np.ndarray, others: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Ways from corner to corner of two triangles laid flat, where they cross the common edge.

    ``corners`` (K, 3) are the edges' ends and one triangle's third corner, ``others`` (K,) those of
    the other triangle.
    """
    along = vertices[corners[:, 1]] - vertices[corners[:, 0]]
    width = np.linalg.norm(along, axis=1)
    along = along / np.where(width > 0, width, 1)[:, np.newaxis]
    places, heights = [], []
    for tips in (corners[:, 2], others):
        reach = vertices[tips] - vertices[corners[:, 0]]
        place = np.einsum("ij,ij->i", reach, along)
        places.append(place)
        heights.append(np.linalg.norm(reach - place[:, np.newaxis] * along, axis=1))
    apart = heights[0] + heights[1]
    share = heights[0] / np.where(apart > 0, apart, 1)
    crossing = places[0] + share * (places[1] - places[0])
    is_inside = (apart > 0) & (crossing > 0) & (crossing < width)
    pairs = np.column_stack([corners[:, 2], others])[is_inside]
    return pairs, np.hypot(places[1] - places[0], apart)[is_inside]


class Spread:
    """The vertices around a place, in a disc that can grow."""

    def __init__(self, links: Links, seeds: np.ndarray, distances: np.ndarray) -> None:
        """Begin at the vertices ``seeds`` (K,), at their ``distances`` (K,) from the place."""
        self._links = links
        self._distance = np.full(len(links.starts) - 1, np.inf)
        np.minimum.at(self._distance, seeds, distances)
        self._least = float(distances.min())
        # Vertices whose ways were not followed since their distance became less.
        self._pending = np.unique(seeds)

    def within(self, radius: float) -> np.ndarray:
        """Which vertices are no farther than ``radius``, (N,); the nearest always is."""
        radius = max(radius, self._least)
        while True:
            is_near = self._distance[self._pending] <= radius
            if not is_near.any():
                return self._distance <= radius
            near, far = self._pending[is_near], self._pending[~is_near]
            ways, owners = self._links.leaving(near)
            ends = self._links.ends[ways]
            reach = self._distance[near][owners] + self._links.lengths[ways]
            is_less = reach < self._distance[ends]
            np.minimum.at(self._distance, ends[is_less], reach[is_less])
            self._pending = np.unique(np.concatenate([far, ends[is_less]]))
