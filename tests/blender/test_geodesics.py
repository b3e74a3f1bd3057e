"""Distances along a surface: never too short, and at most 9 % too long."""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from conftest import MODULE
from shapes import dumbbell, grid, icosphere

geodesics = importlib.import_module(f"{MODULE}.deformation.geodesics")
TOO_LONG = 1.09


def spread(vertices, faces, seed: int):
    links = geodesics.Links.of(np.asarray(vertices, dtype=float), np.asarray(faces))
    return geodesics.Spread(links, np.array([seed]), np.zeros(1))


def check_disc(found: np.ndarray, distances: np.ndarray, radius: float) -> None:
    assert not found[distances > radius * (1 + 1e-9)].any(), "some distances are too short"
    assert found[distances < radius / TOO_LONG].all(), "some distances are too long"


@pytest.mark.parametrize("radius", [0.1, 0.3, 0.45])
def test_on_a_sheet_they_are_straight(radius):
    vertices, faces = grid(41, 41)
    seed = 41 * 20 + 20
    found = spread(vertices, faces, seed).within(radius)
    check_disc(found, np.linalg.norm(vertices - vertices[seed], axis=1), radius)


@pytest.mark.parametrize("angle", [0.5, 2.0, 3.1])
def test_folding_a_sheet_changes_none(angle):
    vertices, faces = grid(21, 21)
    beyond = vertices[:, 0] > 0.5
    bent = vertices.copy()
    bent[beyond, 0] = 0.5 + np.cos(angle) * (vertices[beyond, 0] - 0.5)
    bent[beyond, 2] = np.sin(angle) * (vertices[beyond, 0] - 0.5)
    for radius in (0.2, 0.5):
        np.testing.assert_array_equal(
            spread(bent, faces, 21 * 6 + 5).within(radius + 1e-6),
            spread(vertices, faces, 21 * 6 + 5).within(radius + 1e-6),
        )


def test_on_a_sphere_they_are_along_great_circles():
    vertices, faces = icosphere(4)
    arcs = np.arccos(np.clip(vertices @ vertices[0], -1, 1))
    for radius in (0.3, 1.5, 3):
        found = spread(vertices, faces, 0).within(radius)
        assert found[arcs < radius / TOO_LONG].all()
        assert not found[arcs > 1.01 * radius].any()  # chords are shorter than arcs


def test_growing_by_steps_gives_what_growing_at_once_does():
    vertices, faces = dumbbell(n_around=24, n_along=40)
    steps = spread(vertices, faces, 0)
    for radius in (0.1, 0.7, 0.2, 2, 4, 1):
        np.testing.assert_array_equal(
            steps.within(radius), spread(vertices, faces, 0).within(radius)
        )
    assert steps.within(100).all()


def test_what_is_not_connected_is_not_reached():
    vertices, faces = grid(11, 11)
    two = np.vstack([vertices, vertices + np.array([0, 0, 0.01])])
    found = spread(two, np.vstack([faces, faces + len(vertices)]), 0).within(100)
    assert found[: len(vertices)].all() and not found[len(vertices) :].any()


def test_needles_points_and_edges_of_three_faces_do_no_harm():
    vertices, faces = grid(11, 11)
    vertices = np.vstack([vertices, vertices[60], [0.5, 0.5, 1], [9, 9, 9]])
    count = len(vertices)
    faces = np.vstack([faces, [60, 60, count - 3], [60, 61, count - 2], [60, count - 3, 60]])
    with np.errstate(divide="raise", invalid="raise"):
        found = spread(vertices, faces, 60).within(100)
    assert found[:-1].all() and not found[-1]


def test_a_seed_is_in_a_disc_of_no_radius():
    vertices, faces = grid(11, 11)
    links = geodesics.Links.of(vertices, faces)
    around = geodesics.Spread(links, np.array([5, 6]), np.array([0.04, 0.06]))
    assert np.flatnonzero(around.within(0)).tolist() == [5]
    assert np.flatnonzero(around.within(0.061)).tolist() == [5, 6]
