"""The flow of the visible part of a picture, as if there were nothing else."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Still:
    """The flow of what does not move: there is one value, or nothing that can be seen."""


STILL = Still()


@dataclass(frozen=True)
class Request:
    """What is to flow, and how."""

    # (H, W, C).
    values: NDArray[np.float64]
    # The pixels that can be seen, (H, W); the others take no part.
    visible: NDArray[np.bool_]
    times: NDArray[np.float64]
    # "flat" or "surface".
    metric: str
    # Of the relief of "surface", in pixels.
    height: float
    # "extrapolated" or "exact".
    scheme: Any

    @cached_property
    def contrast(self) -> float:
        """How far the values that can be seen are apart, over all channels together."""
        return contrast_of(self.values, self.visible)

    @property
    def is_still(self) -> bool:
        """Whether nothing would flow."""
        return self.contrast == 0 or (not self.visible.all() and not len(self._triangles))

    def run(self, progress: Callable[[float], None]) -> spectral_tv.Flow | Still:
        """Run the flow."""
        return STILL if self.is_still else self.start().result(progress)

    def start(self) -> spectral_tv.Job[spectral_tv.Flow]:
        """Start it in a thread."""
        if self.visible.all():
            how: Any = {"metric": self.metric, "height": self.height, "scheme": self.scheme}
            return spectral_tv.start_decompose_image(self.values, times=self.times, **how)
        return spectral_tv.start_flow(*self._of_mesh(), scheme=self.scheme)

    def bands(self, flow: spectral_tv.Flow | Still, count: int) -> NDArray[np.float64]:
        """The bands of its flow, (count, H, W, C); 0 where nothing is seen."""
        if isinstance(flow, Still):
            return np.zeros((count, *self.values.shape))
        found = flow.bands(flow.band_edges(count))
        if self.visible.all():
            return found
        bands = np.zeros((count, *self.values.shape))
        bands[:, self.visible] = found
        return bands

    def _of_mesh(self) -> tuple[spectral_tv.Mesh, NDArray[np.float64], NDArray[np.float64]]:
        """The grid of an image as a mesh, without the pixels that are not visible.

        The height of a relief is one channel. Several channels are projected on their principal
        axis, along which they differ most.
        """
        values = self.values[self.visible]
        rows, columns = np.nonzero(self.visible)
        heights = np.zeros(len(values))
        if self.metric == "surface":
            spread = values - values.mean(axis=0)
            _, axes = np.linalg.eigh(spread.T @ spread)
            heights = self.height / self.contrast * (spread @ axes[:, -1])
        places = np.stack([columns, rows, heights], axis=1).astype(np.float64)
        return spectral_tv.Mesh(places, self._triangles), values, self.times

    @cached_property
    def _triangles(self) -> NDArray[np.int64]:
        """Both pairs of triangles of every square of pixels, as far as they are seen, (F, 3)."""
        number = np.full(self.visible.shape, -1)
        number[self.visible] = np.arange(self.visible.sum())
        a, b, d, c = number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]
        corners = (a, b, c), (a, c, d), (a, b, d), (b, c, d)
        triangles = np.concatenate([np.stack(each, axis=-1).reshape(-1, 3) for each in corners])
        return triangles[(triangles >= 0).all(axis=1)]


def contrast_of(values: NDArray[np.float64], visible: NDArray[np.bool_]) -> float:
    """How far values (H, W, C) are apart where they can be seen, over all channels together."""
    seen = values[visible]
    return float(np.linalg.norm(np.ptp(seen, axis=0))) if len(seen) else 0.0
