"""On edges sets fade at their true rates, whatever the triangles; docs/sets.md has the table."""

from __future__ import annotations

import numpy as np
import pytest
import set_meshes
import spectral_tv
from shapes import cylinder_open, grid, icosphere

COARSE, FINE = 2_562, 10_242
STEPS = 16


def fading(known: set_meshes.KnownSet) -> tuple[spectral_tv.Flow, float, np.ndarray]:
    """The flow of ψ, 1 on the set and −|C|/|M∖C| off it, its extinction, and its median on C."""
    mesh = spectral_tv.Mesh(*known.mesh)
    inside = mesh.vertex_areas[known.members].sum()
    psi = np.where(known.members, 1.0, -inside / (mesh.area - inside))
    extinct = inside / known.perimeter
    flow = spectral_tv.flow(mesh, psi, np.linspace(0, 1.2 * extinct, STEPS + 1))
    return flow, extinct, np.median(flow.states[:, known.members], axis=1)


@pytest.mark.parametrize(
    ("name", "vertices", "error"),
    [
        ("cap of 0.5, regular", FINE, 0.005),
        ("cap of 1.0, jittered", FINE, 0.005),
        ("cap of 1.5, Delaunay", FINE, 0.005),
        ("sleeve of the torus, jittered", FINE, 0.005),
        ("disc, regular", FINE, 0.005),
        ("disc, cells of 8:1", FINE, 0.01),
        ("half of the dumbbell, squeezed", FINE, 0.005),
        ("cap of 1.0, decimated", COARSE, 0.01),
        ("disc, Delaunay", COARSE, 0.01),
        ("complement of the cap of 1.0, jittered", COARSE, 0.01),
        ("cap of 1.0, half sphere", COARSE, 0.005),
        ("half a cap of 0.8, half sphere", COARSE, 0.005),
    ],
)
def test_a_set_fades_straight_to_extinction_at_its_rate(name, vertices, error):
    make_set, make_mesh = set_meshes.SETS[name]
    flow, extinct, values = fading(make_set(make_mesh(vertices)))
    assert flow.gap.max() <= 1e-3
    times = flow.times / extinct
    alive = values > 0.1
    slope, start = np.polyfit(times[alive], values[alive], 1)
    assert -slope / start == pytest.approx(1, rel=error)
    np.testing.assert_allclose(values[alive], start + slope * times[alive], atol=5e-3)
    assert np.abs(flow.states[times > 1.05]).max() < 1e-3


@pytest.mark.parametrize("name", ["cap of 1.0, jittered", "disc, Delaunay"])
def test_the_perimeter_of_a_set_is_that_of_its_border(name):
    make_set, make_mesh = set_meshes.SETS[name]
    known = make_set(make_mesh(FINE))
    found = spectral_tv.eigenset_test(spectral_tv.Mesh(*known.mesh), known.members)
    assert found.is_eigenset
    assert found.perimeter == pytest.approx(known.perimeter, rel=0.005)
    assert found.rate == pytest.approx(known.perimeter / found.area, rel=0.005)


@pytest.mark.parametrize("shape", [icosphere(3), cylinder_open()], ids=["closed", "open"])
def test_bands_of_sets_add_up_and_keep_the_mean(shape):
    vertices, triangles = shape
    mesh = spectral_tv.Mesh(vertices, triangles)
    values = np.stack([vertices[:, 2] > 0.3, vertices[:, 0] > 0], axis=1).astype(float)
    flow = spectral_tv.flow(mesh, values, np.linspace(0, 1, 9))
    np.testing.assert_array_equal(flow.states[0], values)
    bands = flow.bands(flow.band_edges(3))
    np.testing.assert_allclose(bands.sum(axis=0) + flow.residual, values, atol=1e-12)
    means = flow.mean(np.ones(len(vertices)))
    np.testing.assert_allclose(means, np.broadcast_to(means[0], means.shape), atol=1e-12)
    assert flow.states.min() > -1e-3 and flow.states.max() < 1 + 1e-3


BALL = icosphere(4)


@pytest.mark.parametrize(
    ("vertices", "triangles"),
    [grid(8, 512), (BALL[0] * [1, 1, 0.02], BALL[1])],
    ids=["cells of 64:1", "pancake"],
)
def test_values_stay_between_those_of_the_set_and_the_rest_on_bad_triangles(vertices, triangles):
    mesh = spectral_tv.Mesh(vertices, triangles)
    members = (vertices[:, 0] > 0.5).astype(float)
    flow = spectral_tv.flow(mesh, members, np.linspace(0, 0.2, 5))
    assert flow.gap.max() <= 1e-3
    assert flow.states.min() > -1e-3 and flow.states.max() < 1 + 1e-3
    means = flow.mean(np.ones(len(vertices)))
    np.testing.assert_allclose(means, np.broadcast_to(means[0], means.shape), atol=1e-12)


def test_a_border_across_an_eigenset_is_no_boundary():
    known = set_meshes.half_cap(set_meshes.half_sphere(COARSE))
    found = spectral_tv.eigenset_test(spectral_tv.Mesh(*known.mesh), known.members)
    assert found.is_eigenset
    assert found.perimeter == pytest.approx(known.perimeter, rel=0.01)


def test_elements_are_chosen_by_what_flows():
    vertices, triangles = icosphere(3)
    mesh = spectral_tv.Mesh(vertices, triangles)
    times = [0.0, 0.05, 0.1]
    group, height = (vertices[:, 2] > 0.3).astype(float), vertices[:, 2]

    def last(values, **options):
        return spectral_tv.flow(mesh, values, times, **options).states[-1]

    assert spectral_tv.suiting_elements(group) == "edges"
    assert spectral_tv.suiting_elements(height) == "vertices"
    # There are iterated steps on vertices alone, and a factorization of so many takes long.
    assert spectral_tv.suiting_elements(1.0 * (np.arange(250_001) < 7)) == "vertices"
    on_edges = last(group, elements="edges")
    np.testing.assert_array_equal(last(group), on_edges)
    np.testing.assert_array_equal(last(2 * group - 5, exact=True), last(
        2 * group - 5, elements="edges", scheme="exact"))  # fmt: skip
    on_vertices = last(group, exact=True, elements="vertices")
    assert np.abs(on_vertices - on_edges).max() > 1e-3
    for options in ({}, {"exact": True}):
        np.testing.assert_array_equal(
            last(height, **options), last(height, elements="vertices", **options)
        )
    lagged = last(group, scheme="lagged")
    np.testing.assert_array_equal(lagged, last(group, scheme="lagged", elements="vertices"))
    for options in ({"scheme": "lagged"}, {"operator": "heat"}):
        with pytest.raises(spectral_tv.MeshError, match="exact"):
            last(group, elements="edges", **options)


def test_an_edge_of_three_faces_is_one_unknown():
    """Three half-discs on one diameter: a third of the border goes across each."""
    angles, radii = np.linspace(0, np.pi, 49), np.linspace(0, 1, 25)[1:]
    ring = np.stack([np.outer(radii, np.cos(angles)), np.outer(radii, np.sin(angles))], axis=-1)
    pages = []
    for turn in (0, 2 * np.pi / 3, 4 * np.pi / 3):
        x, y = ring.reshape(-1, 2).T
        pages.append(np.stack([x, y * np.cos(turn), y * np.sin(turn)], axis=1))
    points = np.vstack([[np.zeros(3)], *pages])
    index = 1 + np.arange(ring.shape[0] * ring.shape[1]).reshape(ring.shape[:2])
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    page = np.vstack([
        np.stack([np.zeros(48, int), index[0, :-1], index[0, 1:]], axis=1),
        np.stack([a, b, c], axis=-1).reshape(-1, 3), np.stack([a, c, d], axis=-1).reshape(-1, 3),
    ])  # fmt: skip
    shift = index.size * np.arange(3)
    triangles = np.vstack([np.where(page > 0, page + each, 0) for each in shift])
    mesh = spectral_tv.Mesh(points, triangles, weld=1e-9)
    inside = np.zeros(len(mesh.vertices), bool)
    kept = mesh.vertices
    inside[np.linalg.norm(kept, axis=1) < 0.52] = True
    flow = spectral_tv.flow(mesh, inside.astype(float), np.linspace(0, 0.1, 5))
    assert flow.gap.max() <= 1e-3
    found = spectral_tv.eigenset_test(mesh, inside)
    assert found.rate == pytest.approx(found.eigenvalue, rel=0.02)
    assert found.perimeter == pytest.approx(3 * np.pi * 0.52, rel=0.02)
