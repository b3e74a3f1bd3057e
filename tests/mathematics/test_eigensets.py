"""Known eigensets pass the test, known others fail it where they ought to."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import dumbbell, grid, icosphere, torus

TORUS = torus(2.0, 0.6, 160, 60)
SPHERE = icosphere(4)


def examine(shape, members) -> spectral_tv.EigensetTest:
    return spectral_tv.eigenset_test(spectral_tv.Mesh(*shape), members)


@pytest.mark.parametrize("complement", [False, True], ids=["cap", "complement"])
@pytest.mark.parametrize("angle", [0.6, 1.0, 1.5])
def test_a_cap_of_the_sphere_and_its_complement_are_eigensets(angle, complement):
    inside = (SPHERE[0][:, 2] > np.cos(angle)) ^ complement
    found = examine(SPHERE, inside)
    assert found.is_eigenset and found.minimal_perimeter
    area = 2 * np.pi * (1 - np.cos(angle))
    area = 4 * np.pi - area if complement else area
    perimeter = 2 * np.pi * np.sin(angle)
    assert found.area == pytest.approx(area, rel=0.02)
    assert found.perimeter == pytest.approx(perimeter, rel=0.015)
    assert found.eigenvalue == found.perimeter / found.area
    assert found.rate == pytest.approx(perimeter / area, rel=0.02)
    expected = np.maximum(1 - found.rate * found.times, 0)
    np.testing.assert_allclose(found.values, expected, atol=0.03)


def test_the_perimeter_does_not_follow_the_triangles():
    """That of a disc on a grid, whose contour along the triangles is 17 % too long."""
    vertices, triangles = grid(80, 80)
    found = examine((vertices, triangles), np.hypot(*(vertices[:, :2] - 0.5).T) < 0.25)
    assert found.perimeter == pytest.approx(np.pi / 2, rel=0.005)


@pytest.mark.parametrize("half_angle", [0.45, 0.9, 2.2])
def test_a_sleeve_of_the_torus_is_an_eigenset(half_angle):
    around = np.abs(np.arctan2(TORUS[0][:, 1], TORUS[0][:, 0]))
    found = examine(TORUS, around < half_angle)
    assert found.is_eigenset
    assert found.spread < 0.1
    assert found.perimeter == pytest.approx(2 * 2 * np.pi * 0.6, rel=0.005)
    assert found.rate == pytest.approx(found.eigenvalue, rel=0.01)


def test_a_small_disc_on_the_torus_is_an_eigenset_and_a_large_one_is_not():
    """The large one becomes a sleeve (Brokman et al. 2024, the figure of the torus)."""
    distance = np.linalg.norm(TORUS[0] - [2.6, 0, 0], axis=1)
    assert examine(TORUS, distance < 0.4).is_eigenset
    assert examine(TORUS, distance < 0.7).is_eigenset
    large = examine(TORUS, distance < 1.3)
    assert not large.minimal_perimeter and not large.is_eigenset


def test_half_a_dumbbell_is_an_eigenset_if_it_is_cut_at_the_neck():
    shape = dumbbell()
    vertices = shape[0]
    for height in (0, 0.45):  # the neck ends at 0.5
        at_neck = examine(shape, vertices[:, 2] > height)
        assert at_neck.is_eigenset
        assert at_neck.perimeter == pytest.approx(2 * np.pi * 0.25, rel=0.03)
    inside = vertices[:, 2] > 0.8
    off_neck = examine(shape, inside)
    assert not off_neck.minimal_perimeter and not off_neck.is_eigenset
    assert off_neck.straightness < 0.99
    # A better set goes on down to the neck.
    assert off_neck.superset[inside].all()
    assert vertices[off_neck.superset, 2].min() < 0.55
    assert off_neck.perimeter_ratio < 0.5


def test_a_jagged_patch_has_supersets_of_smaller_perimeter():
    x, y, z = SPHERE[0].T
    star = np.arccos(np.clip(z, -1, 1)) < 0.7 + 0.3 * np.cos(5 * np.arctan2(y, x))
    found = examine(SPHERE, star)
    assert not found.minimal_perimeter and not found.is_eigenset


def test_a_random_set_is_no_eigenset():
    members = np.random.default_rng(0).random(len(SPHERE[0])) < 0.3
    assert not examine(SPHERE, members).is_eigenset


def test_size_scales_and_other_components_do_not_matter():
    vertices, triangles = SPHERE
    inside = vertices[:, 2] > np.cos(1.0)
    one = examine(SPHERE, inside)
    large = examine((10 * vertices, triangles), inside)
    assert large.eigenvalue == pytest.approx(one.eigenvalue / 10)
    assert large.rate == pytest.approx(one.rate / 10, rel=1e-6)
    three = np.vstack([vertices, vertices + 5, vertices - 5])
    every = np.vstack([triangles + k * len(vertices) for k in range(3)])
    members = np.concatenate([inside, np.ones_like(inside), np.zeros_like(inside)])
    beside = examine((three, every), members)
    assert beside.area == pytest.approx(one.area)
    assert beside.perimeter == pytest.approx(one.perimeter)
    assert beside.rate == pytest.approx(one.rate, rel=1e-3)
    assert beside.is_eigenset
    assert not beside.superset[len(vertices) :].any()


def test_members_are_a_mask_weights_or_indices():
    inside = SPHERE[0][:, 2] > np.cos(1.0)
    one = examine(SPHERE, inside)
    for members in (np.flatnonzero(inside), np.where(inside, 0.7, 0.2)):
        assert examine(SPHERE, members).perimeter == one.perimeter
    job = spectral_tv.start_eigenset_test(spectral_tv.Mesh(*SPHERE), inside)
    assert job.result().rate == one.rate


@pytest.mark.parametrize(
    ("members", "message"),
    [
        (np.ones(2562, bool), "no boundary"),
        (np.zeros(2562, bool), "no boundary"),
        (np.ones(7, bool), "7 truth values, but there are 2562 vertices"),
        ([3, 2562], "index 2562, but the vertices are 0 to 2561"),
        ([-1], "index -1"),
    ],
)
def test_sets_that_are_none_are_refused(members, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        examine(SPHERE, members)
