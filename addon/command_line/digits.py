"""Coordinates with more digits than a float of Blender holds, such as those of scans in maps.

PLY files and text files are read relative to a round point near their middle. What is written is
relative to 0 again.
"""

import numpy as np
from spectral_tv.dataclass import dataclass

from ..scene.surface import NOWHERE

# Relative to the size of the shape, the coarsest steps between floats that are good enough.
COARSEST = 1e-5
# What is written where a vertex is nowhere: importers make 0 of what is no number.
FAR = 3e38
# How OBJ files see Blender's axes.
OBJ_AXES = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])


@dataclass(frozen=True)
class Digits:
    """How a file stores coordinates: as text or not, in double precision or not, relative to what.

    ``offset`` (3,), in Blender's axes, is added to Blender's coordinates to get those of the file.
    """

    offset: np.ndarray
    is_text: bool = False
    is_double: bool = False

    @property
    def is_moved(self) -> bool:
        """Whether Blender holds coordinates relative to another point than 0."""
        return bool(self.offset.any())

    def told(self, suffix: str) -> str:
        """The offset in the axes of files of a suffix, as the user reads it."""
        turned = OBJ_AXES @ self.offset if suffix == ".obj" else self.offset
        return "({:.12g}, {:.12g}, {:.12g})".format(*(turned + 0.0))


PLAIN = Digits(np.zeros(3))


def of_points(points: np.ndarray, is_text: bool, is_double: bool = False) -> Digits:
    """How the coordinates (V, 3) of a file are stored, and what they should be read from."""
    return Digits(_offset(points), is_text, is_double)


def are_nowhere(points: np.ndarray) -> np.ndarray:
    """Which vertices (V,) have a coordinate that is no number, or none that a float can be."""
    return ~(np.abs(points) < NOWHERE).all(axis=1)


def are_coarse(points: np.ndarray) -> float | None:
    """The steps between floats at points (V, 3), if these are too coarse for their size."""
    points = points[~are_nowhere(points)]
    if len(points) == 0:
        return None
    low, high = points.min(axis=0), points.max(axis=0)
    size = float(np.linalg.norm(high - low))
    spacing = float(np.spacing(np.float32(np.abs([low, high]).max())))
    return spacing if spacing > COARSEST * size > 0 else None


def _offset(points: np.ndarray) -> np.ndarray:
    """A round point near the middle of points; 0 where floats from there are as good."""
    if are_coarse(points) is None:
        return np.zeros(3)
    points = points[~are_nowhere(points)]
    low, high = points.min(axis=0), points.max(axis=0)
    unit = 10.0 ** np.floor(np.log10(float(np.linalg.norm(high - low))))
    return np.round((low + high) / 2 / unit) * unit


def decimals_of(points: np.ndarray) -> int:
    """How many decimals floats of this size have."""
    largest = max(float(np.abs(points[~are_nowhere(points)]).max(initial=0.0)), 1e-30)
    return int(np.clip(np.ceil(-np.log10(np.spacing(np.float32(largest)))), 0, 17))


def fine_decimals(points: np.ndarray) -> int:
    """How many decimals tell details apart of a shape that is far from 0."""
    points = points[~are_nowhere(points)]
    return decimals_of(points - points.mean(axis=0)) if len(points) else 0
