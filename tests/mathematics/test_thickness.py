"""How thick a shape is, against shapes whose thickness is known."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import cylinder_open, dumbbell, grid, icosphere, torus

Mesh = tuple[np.ndarray, np.ndarray]


def thickness(mesh: Mesh) -> np.ndarray:
    return spectral_tv.thickness(spectral_tv.Mesh(*mesh))


def two_layers(mesh: Mesh, gap: float) -> Mesh:
    """An open tube about z as a closed shell: a second layer inside, joined at both borders."""
    vertices, triangles = mesh
    inner = vertices * [1 - gap, 1 - gap, 1]
    count = len(vertices)
    edges = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    known = {tuple(edge) for edge in edges.tolist()}
    border = np.array([edge for edge in known if edge[::-1] not in known])
    i, j = border.T
    rim = np.vstack(
        [np.column_stack([j, i, i + count]), np.column_stack([j, i + count, j + count])]
    )
    return np.vstack([vertices, inner]), np.vstack([triangles, triangles[:, ::-1] + count, rim])


def box(lines: np.ndarray) -> Mesh:
    """The surface of [−1, 1]³, every face divided by the same lines both ways."""
    count = len(lines)
    i, j = np.indices((count, count)).reshape(2, -1)
    first = (count * np.arange(count - 1)[:, None] + np.arange(count - 1)).reshape(-1, 1)
    halves = [first + np.array(corners) for corners in ((0, count, count + 1), (0, count + 1, 1))]
    vertices, triangles = [], []
    for axis in range(3):
        for side in (-1, 1):
            face = np.empty((count**2, 3))
            face[:, axis], face[:, axis - 2], face[:, axis - 1] = side, lines[i], lines[j]
            triangles.append(np.vstack(halves)[:, ::side] + len(vertices) * count**2)
            vertices.append(face)
    merged, index = np.unique(np.vstack(vertices), axis=0, return_inverse=True)
    return merged, index.ravel()[np.vstack(triangles)]


def machined_box(knob: float) -> Mesh:
    """A box with a ring of grooves and a raised panel on every face, and a knob on one."""
    half = np.array([0.15, 0.2, 0.25, 0.55, 0.6, 0.75, 0.8, 0.85, 1.0])
    flat, triangles = box(np.concatenate([-half[::-1], half]))
    vertices = flat.copy()
    for axis in range(3):
        beside = np.abs(np.delete(flat, axis, axis=1)).max(axis=1)
        on_face = np.abs(flat[:, axis]) == 1
        out = np.where(beside == 0.8, -0.05, np.where(beside < 0.6, 0.08, 0.0))
        vertices[:, axis] += np.where(on_face, out, 0) * flat[:, axis]
    vertices[(flat[:, 2] == 1) & (np.abs(flat[:, :2]).max(axis=1) < 0.2), 2] += knob
    return vertices, triangles


@pytest.mark.parametrize("subdivisions", [1, 3, 5])
def test_a_ball_is_as_thick_as_its_radius(subdivisions):
    radii = thickness(icosphere(subdivisions, radius=3.0))
    assert np.abs(radii / 3 - 1).max() < (0.25 if subdivisions == 1 else 0.04)


def test_a_torus_is_as_thick_as_its_tube():
    radii = thickness(torus(2.0, 0.5, 60, 24))
    assert np.abs(radii / 0.5 - 1).max() < 0.1


def test_a_neck_is_thin_between_thick_ends_and_thickness_grows_slowly_from_it():
    vertices, triangles = dumbbell()
    radii = thickness((vertices, triangles))
    radius = np.linalg.norm(vertices[:, :2], axis=1)
    neck = np.abs(vertices[:, 2]) < 0.05 * np.ptp(vertices[:, 2])
    middle = np.median(radii[neck]) / np.median(radius[neck])
    assert 0.8 < middle < 1.3
    assert radii.max() > 0.8 * radius.max()
    edges = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]]])
    lengths = np.linalg.norm(np.diff(vertices[edges], axis=1)[:, 0], axis=1)
    growth = np.abs(np.diff(radii[edges], axis=1)[:, 0]) / lengths
    assert growth.max() < 0.45


@pytest.mark.parametrize("kind", ["sheet", "turned", "mixed", "shell"])
def test_a_sleeve_is_as_thick_as_an_arm(kind):
    """Whatever the winding of its triangles, and in one layer or two."""
    vertices, triangles = cylinder_open(0.5, 6.0, 40, 80)
    if kind == "turned":
        triangles = triangles[:, ::-1]
    elif kind == "mixed":
        turned = np.arange(len(triangles)) % 3 == 0
        triangles = np.where(turned[:, None], triangles[:, ::-1], triangles)
    mesh = two_layers((vertices, triangles), 0.01) if kind == "shell" else (vertices, triangles)
    assert np.abs(thickness(mesh) / 0.5 - 1).max() < 0.15


def test_a_plane_is_as_thick_as_the_ball_of_its_area():
    radii = thickness(grid(20, 20))
    assert np.abs(radii / np.sqrt(1 / (4 * np.pi)) - 1).max() < 1e-6


def test_a_cube_of_few_triangles_has_the_thickness_of_one_of_many():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = np.array([[q[a], q[b], q[c]] for q in quads for a, b, c in ((0, 1, 2), (0, 2, 3))])
    assert np.abs(thickness((corners, triangles)) / 0.5 - 1).max() < 0.08


def test_a_box_with_grooves_and_panels_is_as_thick_as_the_box():
    """On its faces, its edges and its corners, and in the grooves."""
    assert np.abs(thickness(machined_box(knob=0)) - 1).max() < 0.1


@pytest.mark.parametrize("copies", [1, 2, 3, 4])
def test_a_knob_has_its_own_thickness_and_lowers_only_what_is_near(copies):
    """However many samples fall on it: parts of the same size share them."""
    vertices, triangles = machined_box(knob=0.5)
    shape = (
        np.vstack([np.add(vertices, [3 * copy, 0, 0]) for copy in range(copies)]),
        np.vstack([triangles + copy * len(vertices) for copy in range(copies)]),
    )
    radii = thickness(shape)[: len(vertices)]
    top = vertices[:, 2] > 1.2
    assert np.abs(radii[top] / 0.175 - 1).max() < 0.15
    distance = np.linalg.norm(vertices[~top] - [0, 0, 1.08], axis=1)
    assert (radii[~top] > np.minimum(0.9, 0.17 + 0.3 * distance)).all()
    assert radii.max() < 1.1


def test_parts_are_as_thick_alone_as_beside_others():
    """A thing inside another, or near it, is not thinner for that."""
    vertices, triangles = icosphere(3)
    both = np.vstack([vertices, 0.9 * vertices]), np.vstack([triangles, triangles + len(vertices)])
    radii = thickness(both)
    assert np.abs(radii[: len(vertices)] - 1).max() < 0.05
    assert np.abs(radii[len(vertices) :] - 0.9).max() < 0.05


def test_thickness_follows_size_and_place():
    vertices, triangles = dumbbell()
    radii = thickness((vertices, triangles))
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    moved = 1e6 * vertices @ turn.T + [3e7, 0, 0]
    assert np.allclose(thickness((moved, triangles)), 1e6 * radii, rtol=1e-3)


def test_vertices_in_no_triangle_have_none():
    vertices, triangles = icosphere(2)
    with_loose = np.vstack([vertices, [[5.0, 5, 5]]])
    radii = thickness((with_loose, triangles))
    assert radii[-1] == 0
    assert (radii[:-1] > 0).all()
