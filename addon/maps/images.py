"""Square images of texels: means of samples, and margins."""

from __future__ import annotations

from spectral_tv.later import np


def mean_of_samples(
    values: np.ndarray, texels: np.ndarray, side: int, samples: int
) -> tuple[np.ndarray, np.ndarray]:
    """Values (N, C) of texels (N,) of an image of ``side * samples``, as one of ``side``.

    Returns the means (side * side, C), 0 where there are none, and where there are some.
    """
    if samples == 1:
        found, is_filled = (
            np.zeros((side * side, values.shape[1])),
            np.zeros(side * side, dtype=bool),
        )
        found[texels], is_filled[texels] = values, True
        return found, is_filled
    rows, columns = np.divmod(texels, side * samples)
    coarse = rows // samples * side + columns // samples
    counts = np.bincount(coarse, minlength=side * side)
    sums = [np.bincount(coarse, channel, side * side) for channel in values.T]
    found = np.stack(sums, axis=-1) / np.maximum(counts, 1)[:, np.newaxis]
    return found, counts > 0


def with_margin(values: np.ndarray, is_filled: np.ndarray, side: int, steps: int) -> np.ndarray:
    """Values (side * side, C) with so many pixels more around those that are filled.

    Each ring of pixels takes the means of the neighbours that it grows from.
    """
    width = side + 2
    inside = np.zeros((width, width), dtype=bool)
    inside[1:-1, 1:-1] = True
    filled = np.zeros((width, width), dtype=bool)
    filled[1:-1, 1:-1] = is_filled.reshape(side, side)
    found = np.zeros((width, width, values.shape[1]))
    found[1:-1, 1:-1] = values.reshape(side, side, -1)
    around = np.array([-width - 1, -width, -width + 1, -1, 1, width - 1, width, width + 1])
    inside, filled = inside.ravel(), filled.ravel()
    flat = found.reshape(width * width, -1)
    ring = _next_ring(np.flatnonzero(filled), around, filled, inside)
    for _ in range(steps):
        if len(ring) == 0:
            break
        sums, counts = np.zeros((len(ring), flat.shape[1])), np.zeros(len(ring))
        for step in around:
            near = filled[ring + step]
            sums[near] += flat[ring[near] + step]
            counts += near
        flat[ring] = sums / counts[:, np.newaxis]
        filled[ring] = True
        ring = _next_ring(ring, around, filled, inside)
    return flat.reshape(width, width, -1)[1:-1, 1:-1].reshape(side * side, -1)


def _next_ring(
    ring: np.ndarray, around: np.ndarray, filled: np.ndarray, inside: np.ndarray
) -> np.ndarray:
    """The pixels next to those of a ring that are not filled so far."""
    is_next = np.zeros(len(filled), dtype=bool)
    for step in around:
        is_next[ring + step] = True
    return np.flatnonzero(is_next & ~filled & inside)
