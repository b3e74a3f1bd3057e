"""A small armoured dragon: a closed mesh with features of every size."""

from __future__ import annotations

import bpy
import numpy as np

from .meshing import mesh
from .solids import Part, ball, pair, tube, turned
from .studio import vertices_of

SPACING = 0.0152
BROW = [(0.075, -0.262, 1.765), (0.145, -0.262, 1.778), (0.225, -0.215, 1.715)]
HORN = [(0.15, 0.02, 1.72), (0.22, 0.06, 1.84), (0.25, 0.07, 1.93), (0.235, 0.04, 2.02)]
TAIL = [
    (0, 0.16, 0.62),
    (-0.03, 0.42, 0.42),
    (-0.19, 0.62, 0.27),
    (-0.45, 0.68, 0.22),
    (-0.68, 0.57, 0.29),
    (-0.79, 0.43, 0.43),
    (-0.79, 0.35, 0.56),
]
# Foot and tip of each spike of the crest, from the head down to the tail.
SPIKES = [
    ((0, 0.14, 1.70), (0, 0.27, 1.81)),
    ((0, 0.18, 1.50), (0, 0.34, 1.56)),
    ((0, 0.26, 1.24), (0, 0.44, 1.31)),
    ((0, 0.31, 1.01), (0, 0.51, 1.05)),
    ((0, 0.33, 0.79), (0, 0.54, 0.81)),
    ((-0.04, 0.49, 0.53), (-0.03, 0.61, 0.63)),
    ((-0.20, 0.63, 0.36), (-0.19, 0.68, 0.49)),
    ((-0.44, 0.69, 0.29), (-0.44, 0.72, 0.41)),
]


def creature(name: str = "Creature") -> bpy.types.Object:
    """Build the demo's model: a standing dragon with limbs, horns, plates and scales.

    The mesh is one closed component of quads, the same at every call, about 2 units tall, with
    Z up and facing -Y. The object is not linked to any collection.

    Parameters
    ----------
    name : str
        Name of the new object and of its mesh.

    Returns
    -------
    bpy.types.Object
    """
    parts = anatomy()
    data = mesh(parts, SPACING)
    data.name = name
    vertices = vertices_of(data) + relief(parts, data)
    data.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    data.shade_smooth()
    return bpy.data.objects.new(name, data)


def anatomy() -> list[Part]:
    """The solids that the creature is blended from, in the order of blending."""
    return [*_torso(), *_head(), *_tail(), *_legs(), *_arms()]


def _torso() -> list[Part]:
    return [
        ball((0, 0, 0.80), (0.35, 0.31, 0.38), 0.02, "torso"),
        ball((0, 0.01, 1.10), (0.30, 0.25, 0.24), 0.16, "torso"),
        ball((0, 0.075, 0.84), (0.345, 0.29, 0.39), 0.01, "torso"),
        ball((0, 0.055, 1.12), (0.285, 0.25, 0.23), 0.06, "torso"),
        tube([(0, 0.0, 1.15), (0, -0.03, 1.45)], [0.19, 0.17], 0.1, "torso"),
    ]


def _head() -> list[Part]:
    snout = np.array([0, -0.26, 1.45]), np.array([0.165, 0.175, 0.12])
    mouth = []
    for x in np.linspace(-0.135, 0.135, 9):
        z = 1.395 + 2.6 * x * x
        rest = 1 - (x / snout[1][0]) ** 2 - ((z - snout[0][2]) / snout[1][2]) ** 2
        mouth.append((x, snout[0][1] - snout[1][1] * np.sqrt(rest) - 0.006, z))
    ear = turned((0, -28, -18))
    return [
        ball((0, -0.05, 1.56), (0.27, 0.25, 0.235), 0.06, "head"),
        ball(tuple(snout[0]), tuple(snout[1]), 0.08, "face"),
        *pair(ball((0.17, -0.17, 1.45), (0.10, 0.10, 0.085), 0.07, "face")),
        *pair(ball((0.068, -0.38, 1.525), (0.050, 0.05, 0.042), 0.03, "face")),
        *pair(ball((0.075, -0.432, 1.538), (0.026, 0.03, 0.023), 0.01, "face", carve=True)),
        tube(mouth, [0.022] * 9, 0.01, "face", carve=True),
        *pair(ball((0.137, -0.21, 1.635), (0.108, 0.105, 0.105), 0.03, "face")),
        *pair(ball((0.14, -0.25, 1.617), (0.088, 0.088, 0.088), 0.006, "face")),
        *pair(ball((0.135, -0.345, 1.615), (0.045, 0.032, 0.05), 0.006, "face", carve=True)),
        *pair(ball((0.126, -0.325, 1.634), (0.016, 0.018, 0.016), 0.006, "face")),
        *pair(tube(BROW, [0.018, 0.026, 0.017], 0.02, "face")),
        *pair(tube(HORN, [0.072, 0.055, 0.038, 0.015], 0.03, "horn")),
        *pair(ball((0.335, 0.0, 1.62), (0.17, 0.048, 0.09), 0.03, "smooth", axes=ear)),
        *pair(
            ball((0.36, -0.05, 1.632), (0.12, 0.034, 0.055), 0.015, "smooth", axes=ear, carve=True)
        ),
    ]


def _tail() -> list[Part]:
    tip = turned((0, -12, 0))
    return [
        tube(TAIL, [0.22, 0.165, 0.13, 0.10, 0.078, 0.06, 0.05], 0.12, "scales"),
        ball((-0.79, 0.33, 0.68), (0.10, 0.042, 0.12), 0.03, "smooth", axes=tip),
        tube([(-0.795, 0.325, 0.72), (-0.83, 0.30, 0.90)], [0.06, 0.012], 0.08, "smooth"),
        *(tube([base, spike], [0.062, 0.013], 0.03, "smooth") for base, spike in SPIKES),
    ]


def _legs() -> list[Part]:
    leg = [
        ball((0.235, 0.0, 0.52), (0.185, 0.20, 0.23), 0.06, "scales"),
        tube([(0.25, -0.02, 0.45), (0.31, -0.06, 0.30)], [0.15, 0.125], 0.05, "scales"),
        tube([(0.31, -0.05, 0.30), (0.33, 0.0, 0.10)], [0.125, 0.115], 0.05, "scales"),
        ball((0.335, 0.045, 0.24), (0.10, 0.09, 0.12), 0.05, "scales"),
        ball((0.345, -0.09, 0.075), (0.14, 0.20, 0.085), 0.05, "scales"),
        ball((0.305, -0.165, 0.345), (0.085, 0.05, 0.10), 0.012, "smooth"),
    ]
    for x, y in ((0.24, -0.25), (0.345, -0.285), (0.45, -0.25)):
        leg.append(ball((x, y, 0.065), (0.058, 0.075, 0.06), 0.025, "smooth"))
        tip = (x + 0.25 * (x - 0.345), y - 0.125, 0.03)
        leg.append(tube([(x, y - 0.05, 0.06), tip], [0.036, 0.014], 0.012, "smooth"))
    return [half for part in leg for half in pair(part)]


def _arms() -> list[Part]:
    arm = [
        ball((0.32, 0.0, 1.17), (0.145, 0.14, 0.135), 0.06, "scales"),
        tube([(0.32, 0.0, 1.16), (0.57, 0.01, 1.09)], [0.115, 0.095], 0.05, "scales"),
        ball((0.45, 0.0, 1.155), (0.12, 0.09, 0.075), 0.05, "scales"),
        tube([(0.57, 0.01, 1.09), (0.69, -0.07, 1.34)], [0.098, 0.072], 0.04, "scales"),
        ball((0.635, -0.02, 1.19), (0.092, 0.092, 0.105), 0.05, "scales"),
        ball((0.595, 0.075, 1.06), (0.065, 0.05, 0.07), 0.012, "smooth"),
        ball((0.715, -0.09, 1.41), (0.088, 0.062, 0.085), 0.04, "scales"),
        ball((0.39, 0.0, 1.225), (0.145, 0.15, 0.11), 0.012, "plates", axes=turned((0, 28, 0))),
    ]
    for x, y, z, lean in (
        (0.655, -0.10, 1.475, -0.25),
        (0.725, -0.10, 1.50, 0.1),
        (0.79, -0.10, 1.465, 0.5),
        (0.645, -0.14, 1.40, -0.55),
    ):
        knuckle = (x + 0.06 * lean, y - 0.02, z + 0.05)
        tip = (x + 0.16 * lean, y - 0.07, z + 0.12)
        arm.append(tube([(x, y, z), knuckle], [0.042, 0.036], 0.02, "smooth"))
        arm.append(tube([knuckle, tip], [0.030, 0.014], 0.01, "smooth"))
    return [half for part in arm for half in pair(part)]


def relief(parts: list[Part], data: bpy.types.Mesh) -> np.ndarray:
    """Offsets (V, 3) along the normals of the mesh of the figure that carve plates and scales."""
    vertices = vertices_of(data)
    normals = np.empty(vertices.size, dtype=np.float32)
    data.vertex_normals.foreach_get("vector", normals)
    normals = normals.reshape(-1, 3)
    skins = _skins(parts, vertices)
    back = skins["torso"] * _step(vertices[:, 1] - 0.09 + 0.1 * (vertices[:, 2] - 0.9), 0.012)
    belly = skins["torso"] * _belly_mask(vertices)
    height = back * (0.014 + 0.028 * _cells(vertices, back > 0.5, 0.145, 0.20))
    height += belly * (0.012 + 0.022 * _bands(vertices[:, 2] - 0.5 * vertices[:, 0] ** 2, 0.093))
    height += skins["scales"] * 0.016 * _cells(vertices, skins["scales"] > 0.5, 0.072, 0.5)
    height += skins["plates"] * 0.016 * _cells(vertices, skins["plates"] > 0.5, 0.10, 0.25)
    height += skins["head"] * 0.012 * _cells(vertices, skins["head"] > 0.5, 0.10, 0.28)
    height += skins["horn"] * 0.010 * _bands(vertices[:, 2], 0.05)
    # In sharp creases the two sides would be pushed through each other.
    bend = ((_neighbour_mean(data, vertices) - vertices) * normals).sum(axis=1)
    height *= 1 - _step(bend / SPACING - 0.14, 0.08)
    # Slopes as steep as the mesh can carry would be ragged where they run across it.
    height += 0.25 * (_neighbour_mean(data, height) - height)
    return height[:, None] * normals


def _neighbour_mean(data: bpy.types.Mesh, values: np.ndarray) -> np.ndarray:
    """Mean of `values` (V, ...) over the neighbours of each vertex along the edges of the mesh."""
    edges = np.empty(2 * len(data.edges), dtype=np.int32)
    data.edges.foreach_get("vertices", edges)
    tails, heads = edges.reshape(-1, 2).T
    total, degree = np.zeros_like(values), np.bincount(edges)
    np.add.at(total, tails, values[heads])
    np.add.at(total, heads, values[tails])
    return (total.T / degree).T


def _skins(parts: list[Part], vertices: np.ndarray) -> dict[str, np.ndarray]:
    """For each skin how much of it each vertex has, (V,) in [0, 1]."""
    names = sorted({part.skin for part in parts})
    gaps = np.stack(
        [
            np.min([p.solid.distance(vertices) for p in parts if p.skin == name], axis=0)
            for name in names
        ]
    )
    nearest = np.sort(gaps, axis=0)
    rival = np.where(gaps == nearest[0], nearest[1], nearest[0])
    return dict(zip(names, _step(rival - gaps - 0.008, 0.008), strict=True))


def _belly_mask(vertices: np.ndarray) -> np.ndarray:
    """Where the belly plates lie, (V,) in [0, 1]: an oval on the front of the torso."""
    x, y, z = vertices.T
    oval = 1 - np.hypot(x / 0.235, (z - 0.88) / 0.40)
    return _step(oval, 0.035) * (y < 0)


def _bands(along: np.ndarray, period: float) -> np.ndarray:
    """Overlapping bands across a coordinate (V,): each stands out at its lower edge."""
    phase = np.mod(along / period, 1)
    return _step(phase - 0.17, 0.17) * (1 - 0.75 * phase)


def _cells(vertices: np.ndarray, chosen: np.ndarray, size: float, groove: float) -> np.ndarray:
    """Polygonal plates on the chosen vertices: 1 on a plate, 0 in the grooves.

    Parameters
    ----------
    vertices : (V, 3) array
    chosen : (V,) bool array
        Vertices among which the centres of the plates are spread evenly.
    size : float
        Smallest distance of two centres.
    groove : float
        Width of the grooves with their slopes, as a share of `size`.
    """
    centres = _spread(vertices[chosen], size)
    first, second = np.full((2, len(vertices)), np.inf)
    for centre in centres:
        gap = np.linalg.norm(vertices - centre, axis=1)
        second = np.minimum(second, np.maximum(first, gap))
        first = np.minimum(first, gap)
    middle = groove * size / 2
    return _step(second - first - middle, middle)


def _spread(points: np.ndarray, apart: float) -> np.ndarray:
    """Farthest-point sampling of `points` (N, 3) until all lie within `apart` of a sample."""
    picked = [points[np.argmin(points[:, 2])]]
    gap = np.linalg.norm(points - picked[0], axis=1)
    while gap.max() > apart:
        picked.append(points[np.argmax(gap)])
        gap = np.minimum(gap, np.linalg.norm(points - picked[-1], axis=1))
    return np.array(picked)


def _step(x: np.ndarray, half_width: float) -> np.ndarray:
    """Smooth step from 0 at -half_width to 1 at half_width."""
    t = np.clip(0.5 + 0.5 * x / half_width, 0, 1)
    return t * t * (3 - 2 * t)
