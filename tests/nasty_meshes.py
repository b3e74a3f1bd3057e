"""Meshes as they come from the wild: a corpus of bad ones, and a strategy that makes more."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapes import grid, icosphere

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]
Injury = Callable[[Mesh, np.random.Generator], Mesh]

TRIANGLE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 0.8, 0.0]])


def one_triangle() -> Mesh:
    return TRIANGLE, np.array([[0, 1, 2]])


def needle() -> Mesh:
    """One triangle, a million times as long as it is wide."""
    return TRIANGLE * [1e6, 1.0, 1.0], np.array([[0, 1, 2]])


def fan() -> Mesh:
    """Seven triangles on one edge."""
    angle = np.linspace(0.0, 6.0, 7)
    tips = np.column_stack([np.cos(angle), np.sin(angle), 0.3 * angle])
    vertices = np.vstack([[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]], tips])
    return vertices, np.array([[0, 1, tip] for tip in range(2, 9)])


def bow_tie() -> Mesh:
    """Two cones that share their tip alone."""
    angle = np.linspace(0.0, 2.0 * np.pi, 6, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.ones(6)])
    first = np.arange(6)
    upper = np.column_stack([np.zeros(6, int), 1 + first, 1 + np.roll(first, -1)])
    lower = np.where(upper > 0, upper + 6, 0)
    return np.vstack([[[0.0, 0.0, 0.0]], ring, -ring]), np.vstack([upper, lower])


def moebius_strip() -> Mesh:
    """No orientation fits it."""
    angle = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)[:, None]
    radius = 1.0 + np.array([-0.3, 0.3]) * np.cos(angle / 2.0)
    height = np.array([-0.3, 0.3]) * np.sin(angle / 2.0)
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)
    following = [(2 * k + 2, 2 * k + 3) for k in range(11)] + [(1, 0)]
    sides = [((2 * k, 2 * k + 1), ends) for k, ends in enumerate(following)]
    triangles = [corners for (a, b), (c, d) in sides for corners in ((a, b, c), (b, d, c))]
    return vertices.reshape(-1, 3), np.array(triangles)


def many_components() -> Mesh:
    """Twelve tetrahedra of sizes from 1 down to 1e-6."""
    corners = np.vstack([TRIANGLE, [[0.4, 0.3, 0.7]]])
    sizes = np.geomspace(1.0, 1e-6, 12)
    vertices = [size * corners + [2.0 * k, 0.0, 0.0] for k, size in enumerate(sizes)]
    sides = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    return np.vstack(vertices), np.vstack([sides + 4 * k for k in range(12)])


def soup(rng: np.random.Generator) -> Mesh:
    """Random triangles of any size over random vertices, repeated indices included."""
    vertices = rng.normal(size=(rng.integers(1, 30), 3))
    return vertices, rng.integers(0, len(vertices), (rng.integers(1, 60), 3))


def _flattened(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    return mesh[0] * np.where(np.arange(3) == rng.integers(3), 0.0, 1.0), mesh[1]


def _into_needles(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    return mesh[0] * [1.0, 10.0 ** -rng.integers(3, 12), 10.0 ** -rng.integers(3, 12)], mesh[1]


def _merged_vertices(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    """Some vertices lie where others do, so that triangles have no area."""
    vertices, count = mesh[0].copy(), len(mesh[0])
    vertices[rng.integers(0, count, 5)] = vertices[rng.integers(0, count, 5)]
    return vertices, mesh[1]


def _collinear_triangle(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    vertices, triangles = mesh
    a, b, _ = triangles[rng.integers(len(triangles))]
    middle = 0.5 * (vertices[a] + vertices[b])
    return np.vstack([vertices, middle]), np.vstack([triangles, [a, len(vertices), b]])


def _doubled_triangles(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    return mesh[0], np.vstack([mesh[1], rng.permutation(mesh[1])[:7]])


def _repeated_indices(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    triangles = rng.permutation(mesh[1])[:4].copy()
    triangles[:, 0] = triangles[:, 2]
    return mesh[0], np.vstack([mesh[1], triangles])


def _loose_vertices(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    return np.vstack([mesh[0], 9.0 * rng.normal(size=(3, 3))]), mesh[1]


def _fins(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    vertices, triangles = mesh
    a, b, c = triangles[rng.integers(len(triangles))]
    tip = 1.5 * vertices[c] + 0.1
    return np.vstack([vertices, tip]), np.vstack([triangles, [a, b, len(vertices)]])


def _turned_triangles(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    is_turned = rng.random(len(mesh[1])) < 0.5
    return mesh[0], np.where(is_turned[:, None], mesh[1][:, ::-1], mesh[1])


def _a_far_vertex(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    vertices = mesh[0].copy()
    vertices[rng.integers(len(vertices))] += 10.0 ** rng.integers(2, 9)
    return vertices, mesh[1]


def _holes(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    return mesh[0], mesh[1][rng.random(len(mesh[1])) < 0.7]


def _noise(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    return mesh[0] + 10.0 ** -rng.integers(0, 9) * rng.normal(size=mesh[0].shape), mesh[1]


def _shuffled(mesh: Mesh, rng: np.random.Generator) -> Mesh:
    order = rng.permutation(len(mesh[0]))
    return mesh[0][order], np.argsort(order)[mesh[1]]


BODIES: dict[str, Mesh] = {
    "one triangle": one_triangle(),
    "needle": needle(),
    "fan": fan(),
    "bow tie": bow_tie(),
    "Moebius strip": moebius_strip(),
    "many components": many_components(),
    "flat grid": grid(6, 5),
    "grid a million times as long": grid(6, 5, 1e6, 1.0),
    "sphere": icosphere(1),
}

INJURIES: dict[str, Injury] = {
    "flattened": _flattened,
    "into needles": _into_needles,
    "merged vertices": _merged_vertices,
    "collinear triangle": _collinear_triangle,
    "doubled triangles": _doubled_triangles,
    "repeated indices": _repeated_indices,
    "loose vertices": _loose_vertices,
    "fins": _fins,
    "turned triangles": _turned_triangles,
    "a far vertex": _a_far_vertex,
    "holes": _holes,
    "noise": _noise,
    "shuffled": _shuffled,
}


def corpus() -> dict[str, Mesh]:
    """Every body as it is, the sphere with every injury, and the sphere in bad places."""
    rng = np.random.default_rng(1)
    sphere, triangles = icosphere(1)
    injured = {f"sphere: {name}": hurt((sphere, triangles), rng) for name, hurt in INJURIES.items()}
    return {
        **BODIES,
        **injured,
        "sphere of 1e-9": (1e-9 * sphere, triangles),
        "sphere of 1e7": (1e7 * sphere, triangles),
        "sphere 1e4 away": (sphere + 1e4, triangles),
        "small sphere 1e4 away": (1e-3 * sphere + [1e4, -1e4, 0.0], triangles),
    }


@st.composite
def meshes(draw: st.DrawFn) -> Mesh:
    """A body or a soup with up to four injuries, of any size, anywhere."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    body = draw(st.sampled_from([*BODIES, "soup"]))
    mesh = soup(rng) if body == "soup" else BODIES[body]
    for name in draw(st.lists(st.sampled_from([*INJURIES]), max_size=4)):
        if len(mesh[1]) > 0:
            mesh = INJURIES[name](mesh, rng)
    vertices, triangles = mesh
    size = 10.0 ** draw(st.integers(-9, 7))
    away = draw(st.sampled_from([0.0, 0.0, 1.0, 1e4]))
    return size * (vertices + away * rng.normal(size=3)), triangles
