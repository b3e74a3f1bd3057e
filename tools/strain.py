"""How far a surface that has moved is from rigid pieces: its strain, its flips."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# Up to these strains a face is said to be unstrained, and to have stayed rigid.
UNSTRAINED, RIGID = 1.01, 1.05
QUANTILE = 0.99
# A face that is lower than this part of its longest side takes no part.
LEAST_HEIGHT = 1e-5
COLUMNS = "largest stretch | 99 % strain | flipped | area to 1 % | area to 5 %"


@dataclass(frozen=True)
class Strain:
    """What a movement does to the faces of a surface that have an area at rest.

    Attributes
    ----------
    stretch : float
        The largest length of an edge relative to its length at rest.
    strain : float
        What 99 % of the area are strained by at most; see `strains`.
    flipped : int
        The number of faces that fold over; see `flips`.
    unstrained : float
        The share of the area that is strained by `UNSTRAINED` at most.
    rigid : float
        The share of the area that is strained by `RIGID` at most.
    """

    stretch: float
    strain: float
    flipped: int
    unstrained: float
    rigid: float

    def cells(self) -> list[str]:
        """They as text, for a table with `COLUMNS`."""
        shares = [f"{share:.0%}" for share in (self.unstrained, self.rigid)]
        return [f"{self.stretch:.2f}", f"{self.strain:.2f}", str(self.flipped), *shares]


def measured(vertices: np.ndarray, triangles: np.ndarray, moved: np.ndarray) -> Strain:
    """Measure a movement of vertices (V, 3) of triangles (F, 3) to `moved` (V, 3)."""
    triangles = triangles[_has_area(vertices, triangles)]
    areas = _doubled_areas(vertices, triangles)
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    before, after = (np.linalg.norm(p[edges[:, 1]] - p[edges[:, 0]], axis=1)
                     for p in (vertices, moved))  # fmt: skip
    strain = strains(vertices, triangles, moved)
    order = strain.argsort()
    share = areas[order].cumsum() / areas.sum()
    return Strain(
        stretch=float((after / before).max()),
        strain=float(strain[order[min(share.searchsorted(QUANTILE), len(order) - 1)]]),
        flipped=int(flips(vertices, triangles, moved).sum()),
        unstrained=float(areas[strain <= UNSTRAINED].sum() / areas.sum()),
        rigid=float(areas[strain <= RIGID].sum() / areas.sum()),
    )


def strains(vertices: np.ndarray, triangles: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """How many times longer or shorter the worst direction in each face becomes, (F,).

    It is σ₁ or 1/σ₂ of the face's deformation gradient, whichever is more: 1 if it moves rigidly.
    No face may be without area at rest.
    """
    rest, now = (_gram(points, triangles) for points in (vertices, moved))
    squares = np.linalg.solve(rest, now)  # its eigenvalues are σ²
    half, product = np.trace(squares, axis1=1, axis2=2) / 2, np.linalg.det(squares)
    largest = half + np.sqrt(np.maximum(half**2 - product, 0))
    with np.errstate(divide="ignore"):
        return np.sqrt(np.maximum(largest, largest / np.maximum(product, 0)))


def flips(vertices: np.ndarray, triangles: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Whether each face folds over, (F,).

    It does where its normal is over 90° from where the surface around it would turn it: by the
    rotation nearest to the mean deformation gradient of the faces at its corners.
    """
    before, after = (_frames(points, triangles) for points in (vertices, moved))
    lift = np.linalg.pinv(before[:, :, :2])
    areas = _doubled_areas(vertices, triangles)
    gradients = areas[:, None, None] * (after[:, :, :2] @ lift)
    around = np.zeros((len(vertices), 3, 3))
    for corner in triangles.T:
        np.add.at(around, corner, gradients)
    left, _, right = np.linalg.svd(around[triangles].sum(axis=1))
    left[:, :, 2] *= np.linalg.det(left @ right)[:, None]
    expected = np.einsum("fij,fjk,fk->fi", left, right, before[:, :, 2])
    return np.einsum("fi,fi->f", expected, after[:, :, 2]) < 0


def _has_area(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    corners = vertices[triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    return _doubled_areas(vertices, triangles) > LEAST_HEIGHT * longest**2


def _doubled_areas(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    first, second = _sides(vertices, triangles)
    return np.linalg.norm(np.cross(first, second), axis=1)


def _sides(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    corners = points[triangles]
    return corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]


def _gram(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    sides = np.stack(_sides(points, triangles), axis=1)
    return sides @ sides.transpose(0, 2, 1)


def _frames(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Two sides and the normal, as columns, (F, 3, 3)."""
    first, second = _sides(points, triangles)
    return np.stack([first, second, np.cross(first, second)], axis=2)
