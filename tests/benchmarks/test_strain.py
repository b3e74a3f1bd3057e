"""The measures of strain: what is rigid, stretched, squeezed and folded."""

from __future__ import annotations

import numpy as np
import pytest

from tools.bench.meshes import bumpy_sphere
from tools.strain import flips, measured, strains


def grid(count: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """A flat square of count² vertices."""
    x, y = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    vertices = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3).astype(float)
    index = np.arange(count**2).reshape(count, count)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[:-1, 1:], index[1:, 1:]
    triangles = np.concatenate([np.stack([a, b, d], -1), np.stack([a, d, c], -1)])
    return vertices, triangles.reshape(-1, 3)


def turned(vertices: np.ndarray, degrees: float) -> np.ndarray:
    angle = np.radians(degrees)
    turn = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    return vertices @ np.transpose(turn) + [3, -1, 2]


@pytest.mark.parametrize("degrees", [0, 60, 180])
@pytest.mark.parametrize("shape", [grid(), bumpy_sphere(6)])
def test_rigid_motions_strain_and_flip_nothing(shape, degrees):
    vertices, triangles = shape
    found = measured(vertices, triangles, turned(vertices, degrees))
    assert found.stretch == pytest.approx(1) and found.strain == pytest.approx(1, abs=1e-6)
    assert found.flipped == 0
    assert (found.unstrained, found.rigid) == pytest.approx((1, 1))


@pytest.mark.parametrize(("factors", "stretch", "strain"), [
    ((2, 2, 2), 2, 2), ((0.5, 1, 1), 1, 2), ((3, 0.5, 1), 3, 3), ((1.2, 0.5, 1), 1.2, 2),
])  # fmt: skip
def test_strain_counts_what_is_squeezed_as_what_is_stretched(factors, stretch, strain):
    vertices, triangles = grid()
    found = measured(vertices, triangles, turned(vertices * factors, 40))
    assert found.stretch == pytest.approx(stretch)
    assert found.strain == pytest.approx(strain)
    assert (found.flipped, found.unstrained, found.rigid) == (0, 0, 0)


def test_faces_count_by_their_area():
    vertices, triangles = grid(11)
    moved = vertices.copy()
    moved[vertices[:, 0] > 8, 0] += 0.03  # the last of ten columns but one is 3 % wider,
    moved[vertices[:, 0] > 9, 0] += 1  # and the last twice as wide
    found = measured(vertices, triangles, moved)
    assert (found.unstrained, found.rigid) == pytest.approx((0.8, 0.9))
    assert found.strain == pytest.approx(strains(vertices, triangles, moved).max())


def test_a_vertex_pulled_over_its_neighbours_folds_their_faces():
    vertices, triangles = grid()
    moved = vertices.copy()
    moved[14] += [1.5, 0.2, 0]
    before, after = (
        np.cross(p[triangles[:, 1]] - p[triangles[:, 0]], p[triangles[:, 2]] - p[triangles[:, 0]])
        for p in (vertices, moved)
    )
    folded = before[:, 2] * after[:, 2] < 0
    assert folded.any()
    np.testing.assert_array_equal(flips(vertices, triangles, turned(moved, 130)), folded)


def test_a_face_that_collapses_is_strained_without_bound_and_one_without_area_takes_no_part():
    vertices, triangles = grid()
    moved = vertices.copy()
    moved[vertices[:, 0] == 1, 0] = 0
    assert np.isinf(strains(vertices, triangles, moved).max())
    with_empty = np.vstack([triangles, [[0, 6, 12], [3, 3, 4]]])
    assert measured(vertices, with_empty, vertices) == measured(vertices, triangles, vertices)
