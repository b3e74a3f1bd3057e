"""What must not change a deformation, and meshes of the worst kind."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from scipy.spatial.transform import Rotation
from shapes import bumpy_sphere, dumbbell, ends
from test_soups import KINDS, soup

# Some meshes are bad on purpose.
pytestmark = pytest.mark.filterwarnings("ignore::spectral_tv.MeshWarning")

MESHES = {"dumbbell": dumbbell(n_around=24, n_along=48), "bumpy_sphere": bumpy_sphere(3, 0.3)}
ALGORITHMS = ("convex", "paper", "harmonic", "biharmonic", "arap")
TURN = Rotation.from_euler("xyz", [0.4, 1.1, -0.7]).as_matrix()
SHIFT = np.array([3.0, -5.0, 2.0])


@pytest.fixture(params=MESHES, scope="module")
def pose(request):
    """A mesh, the constraints that turn one end and pin the other, and soft weights for them."""
    vertices, triangles = MESHES[request.param]
    low, high = ends(vertices)
    pivot = vertices[high].mean(axis=0)
    turned = (vertices[high] - pivot) @ Rotation.from_euler("xyz", [0.5, 0.3, -0.2]).as_matrix()
    indices = np.r_[low, high]
    targets = np.vstack([vertices[low], turned + pivot + [0.3, 0.2, 0.5]])
    weights = np.repeat([1.0, 0.7], [len(low), len(high)])
    return vertices, triangles, indices, targets, weights


def deformed(vertices, triangles, indices, targets, **arguments):
    mesh = spectral_tv.Mesh(vertices, triangles)
    return spectral_tv.deform(mesh, indices, targets, tolerance=1e-6, **arguments)


@pytest.mark.parametrize("kind", ["exact", "soft constraints", "softness", "arap", "harmonic"])
def test_turned_shifted_and_scaled_with_the_mesh(pose, kind):
    vertices, triangles, indices, targets, weights = pose
    small, large = {
        "exact": ({}, {}),
        "soft constraints": ({"weights": weights}, {"weights": weights}),
        "softness": ({"softness": 0.4}, {"softness": 4.0}),
        "arap": ({"algorithm": "arap"}, {"algorithm": "arap"}),
        "harmonic": ({"algorithm": "harmonic"}, {"algorithm": "harmonic"}),
    }[kind]
    result = deformed(vertices, triangles, indices, targets, **small)

    def moved(points):
        return 10 * points @ TURN.T + SHIFT

    other = deformed(moved(vertices), triangles, indices, moved(targets), **large)
    np.testing.assert_allclose(other.vertices, moved(result.vertices), atol=1e-4)
    assert other.total_variation == pytest.approx(100 * result.total_variation, rel=1e-6)


@pytest.mark.parametrize(
    "kind", ["exact", "soft constraints", "softness", "harmonic", "biharmonic"]
)
def test_linear_in_the_size_of_the_movement(pose, kind):
    """TV is homogeneous, and so are springs and softness, which refer to the movement."""
    vertices, triangles, indices, targets, weights = pose
    arguments = {
        "exact": {},
        "soft constraints": {"weights": weights},
        "softness": {"softness": 0.4},
    }.get(kind, {"algorithm": kind})
    result = deformed(vertices, triangles, indices, targets, **arguments)
    for factor in (-0.01, 100.0):
        scaled = vertices[indices] + factor * (targets - vertices[indices])
        other = deformed(vertices, triangles, indices, scaled, **arguments)
        displacement = (other.vertices - vertices) / factor
        np.testing.assert_allclose(displacement, result.vertices - vertices, atol=1e-5)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_all_targets_shifted_alike_shift_everything(pose, algorithm):
    vertices, triangles, indices, _, weights = pose
    targets = vertices[indices] + SHIFT
    for given in (None, weights):
        result = deformed(vertices, triangles, indices, targets, weights=given, algorithm=algorithm)
        np.testing.assert_allclose(result.vertices, vertices + SHIFT, atol=1e-9)
        assert result.total_variation == pytest.approx(0, abs=1e-9)
        assert result.gap == 0


def test_a_shift_of_all_targets_adds_to_the_deformation(pose):
    vertices, triangles, indices, targets, weights = pose
    for given in (None, weights):
        result = deformed(vertices, triangles, indices, targets, weights=given)
        other = deformed(vertices, triangles, indices, targets + SHIFT, weights=given)
        np.testing.assert_allclose(other.vertices, result.vertices + SHIFT, atol=1e-5)


def test_the_order_of_constraints_does_not_matter(pose):
    vertices, triangles, indices, targets, weights = pose
    result = deformed(vertices, triangles, indices, targets, weights=weights)
    order = np.random.default_rng(0).permutation(len(indices))
    other = deformed(vertices, triangles, indices[order], targets[order], weights=weights[order])
    np.testing.assert_allclose(other.vertices, result.vertices, atol=1e-5)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_rounding_stays_rounding(algorithm):
    """Another order of vertices rounds everything differently; 1e-10 is what platforms agree to."""
    vertices, triangles = dumbbell()
    low, high = ends(vertices)
    indices = np.r_[low, high]
    targets = np.vstack([vertices[low], vertices[high] + [0.3, 0.0, 0.5]])
    order = np.random.default_rng(1).permutation(len(vertices))
    place = np.argsort(order)
    result, other = (
        spectral_tv.deform(mesh, held, targets, tolerance=1e-2, algorithm=algorithm)
        for mesh, held in (
            (spectral_tv.Mesh(vertices, triangles), indices),
            (spectral_tv.Mesh(vertices[order], place[triangles]), place[indices]),
        )
    )
    np.testing.assert_allclose(other.vertices[place], result.vertices, rtol=0, atol=1e-10)


@pytest.mark.parametrize("kind", KINDS)
def test_soups(kind):
    """Finite, the constraints met and the gap reached, whatever the mesh."""
    rng = np.random.default_rng(len(kind))
    survived = 0
    for _ in range(40):
        vertices, triangles = soup(kind, rng)
        indices = rng.choice(len(vertices), rng.integers(1, 1 + len(vertices) // 2), replace=False)
        size = np.abs(vertices).max()
        targets = vertices[indices] + 0.3 * size * rng.normal(size=(len(indices), 3))
        try:
            mesh = spectral_tv.Mesh(vertices, triangles)
            results = [
                spectral_tv.deform(mesh, indices, targets, algorithm=name)
                for name in ("convex", "harmonic", "arap")
            ]
        except spectral_tv.MeshError as error:
            assert "span no area" in str(error) or "nothing is left to deform" in str(error)
            continue
        survived += 1
        soft = rng.uniform(0.1, 0.999, len(indices))
        results.append(spectral_tv.deform(mesh, indices, targets, weights=soft))
        results.append(spectral_tv.deform(mesh, indices, targets, softness=0.3 * size))
        for result in results:
            assert np.isfinite(result.vertices).all()
            assert 0 <= result.gap <= 1
        for result in results[:3]:
            np.testing.assert_allclose(result.vertices[indices], targets, atol=1e-9 * size)
        for index in (0, 3, 4):
            assert results[index].gap <= 1e-3
    assert survived > 20


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_loose_vertices_and_repeated_indices(algorithm):
    """They change nothing for the rest; a soft constraint alone takes a loose vertex along."""
    vertices, triangles = MESHES["bumpy_sphere"]
    low, high = ends(vertices)
    indices = np.r_[low, high]
    targets = vertices[indices] + np.isin(indices, high)[:, None] * [0.3, 0.0, 0.2]
    clean = spectral_tv.deform(
        spectral_tv.Mesh(vertices, triangles), indices, targets, algorithm=algorithm
    )
    count = len(vertices)
    more = np.vstack([vertices, [[5.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 5.0]]])
    mesh = spectral_tv.Mesh(more, np.vstack([triangles, [[0, 0, count + 1], [0, 1, 1]]]))
    result = spectral_tv.deform(
        mesh,
        np.r_[indices, count + 2],
        np.vstack([targets, [[0.1, 0.0, 5.0]]]),
        np.r_[np.ones(len(indices)), 0.5],
        algorithm=algorithm,
    )
    np.testing.assert_allclose(result.vertices[:count], clean.vertices, atol=1e-4)
    np.testing.assert_allclose(result.vertices[-1], [0.1, 0.0, 5.0], atol=1e-6)
    np.testing.assert_array_equal(result.unconstrained, [count, count + 1])
