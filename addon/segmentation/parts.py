"""Labels of vertices in connected parts."""

from __future__ import annotations

from spectral_tv.later import np


def connected_parts(
    labels: np.ndarray, faces: np.ndarray, areas: np.ndarray, least: float
) -> tuple[np.ndarray, np.ndarray, int]:
    """The connected parts of vertices with the same label.

    A part of less area than ``least`` is joined to the one that it has most edges with, unless it
    has none with others.

    Parameters
    ----------
    labels : (V,) array
        Integers.
    faces : (F, 3) array
        The vertices of triangles, which connect them.
    areas : (V,) array
        Of the vertices.
    least : float
        In the unit of the areas.

    Returns
    -------
    parts : (V,) array
        The part of every vertex, from 0.
    labels : (P,) array
        The label of every part.
    joined : int
        How many parts were joined to others.
    """
    edges = _edges(faces)
    labels, joined = labels.copy(), 0
    while True:
        parts = _components(len(labels), edges[labels[edges[:, 0]] == labels[edges[:, 1]]])
        count = int(parts.max(initial=-1)) + 1
        sizes = np.bincount(parts, areas, count)
        own = np.empty(count, dtype=labels.dtype)
        own[parts] = labels
        heirs = _heirs(parts[edges], sizes, least)
        taken = np.flatnonzero(heirs != np.arange(count))
        if not len(taken):
            return parts, own, joined
        joined += len(taken)
        labels = own[heirs[parts]]


def _edges(faces: np.ndarray) -> np.ndarray:
    """The edges of triangles, each once, (E, 2)."""
    both = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return np.unique(both, axis=0)


def _components(count: int, edges: np.ndarray) -> np.ndarray:
    """The connected component of every vertex, (V,), from 0."""
    places = np.arange(count)
    while True:
        least = np.minimum(places[edges[:, 0]], places[edges[:, 1]])
        after = places.copy()
        for ends in edges.T:
            np.minimum.at(after, places[ends], least)
            np.minimum.at(after, ends, least)
        after = after[after]
        if np.array_equal(after, places):
            return np.unique(places, return_inverse=True)[1].reshape(-1)
        places = after


def _heirs(ends: np.ndarray, sizes: np.ndarray, least: float) -> np.ndarray:
    """The part that each small one is joined to now, (P,), itself if it stays so far.

    ``ends`` (E, 2) are the parts of the ends of edges. Only larger parts are heirs, so that no two
    take each other.
    """
    heirs = np.arange(len(sizes))
    ranks = np.empty(len(sizes), dtype=np.int64)
    ranks[np.lexsort((np.arange(len(sizes)), sizes))] = np.arange(len(sizes))
    both = np.concatenate([ends, ends[:, ::-1]])
    both = both[(sizes[both[:, 0]] < least) & (ranks[both[:, 1]] > ranks[both[:, 0]])]
    if not len(both):
        return heirs
    pairs, counts = np.unique(both, axis=0, return_counts=True)
    order = np.lexsort((ranks[pairs[:, 1]], counts))  # the last one of a part is its heir
    heirs[pairs[order, 0]] = pairs[order, 1]
    while not np.array_equal(heirs, heirs[heirs]):  # an heir may be joined to another one
        heirs = heirs[heirs]
    return heirs
