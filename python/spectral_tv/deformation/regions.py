"""Parts of a shape beyond a percentage of its bounding box, named such as ``z<10%``."""

import re

import numpy as np
from numpy.typing import NDArray

from spectral_tv.dataclass import dataclass

# What is said to who names something else.
EXAMPLES = "regions are such as 'z<10%' or 'x>90%'"
AXES = "xyz"
REGION = re.compile(rf"([{AXES}])\s*([<>])\s*(\d+(?:\.\d*)?)\s*%", re.IGNORECASE)


@dataclass(frozen=True)
class Region:
    """What lies beyond a percentage of a bounding box, along an axis."""

    axis: str
    side: str
    percent: float

    @classmethod
    def read(cls, text: str) -> "Region | None":
        """Read such as ``z<10%``; None if it is something else."""
        found = REGION.fullmatch(text.strip())
        if found is None or float(found[3]) > 100:
            return None
        return cls(found[1].lower(), found[2], float(found[3]))

    @property
    def name(self) -> str:
        """The same for every way to write it."""
        return f"{self.axis}{self.side}{self.percent:g}%"

    @property
    def place(self) -> int:
        """The number of the axis."""
        return AXES.index(self.axis)

    def members(self, along: NDArray[np.float64]) -> NDArray[np.int64]:
        """Indices of the vertices in it, by where they are along the axis, (V,)."""
        low, high = along.min(), along.max()
        edge = low + self.percent / 100 * (high - low)
        return np.flatnonzero(along < edge if self.side == "<" else along > edge)
