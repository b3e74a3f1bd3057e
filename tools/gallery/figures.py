"""A man, a dressed one, and a bust, of blended solids."""

from __future__ import annotations

from functools import cache

import bpy
import numpy as np

from ..demo.meshing import mesh
from ..demo.solids import Part, ball, pair, tube, turned
from .page import Shape
from .shapes import lattice, taken

SPACING = 0.0125
CLOTH = 0.016


@cache
def man() -> Shape:
    """A man with hands and feet, a face, muscles."""
    return _blended([*_trunk(), *_head(), *_limbs()], SPACING)


@cache
def dressed() -> Shape:
    """The man in a skirt of two layers, with a cape that is an open sheet."""
    return _together(man(), _skirt(), _cape())


@cache
def bust() -> Shape:
    """Head and shoulders on a foot, with strands of hair."""
    return _blended(_bust(), 0.0125, azimuth=20.0)


def _blended(parts: list[Part], spacing: float, **view: float) -> Shape:
    return taken(bpy.data.objects.new("Figure", mesh(parts, spacing)), **view)


def _together(*shapes: Shape) -> Shape:
    """Several shapes as one mesh, not joined."""
    starts = np.cumsum([0, *(len(shape.vertices) for shape in shapes)])
    triangles = [shape.triangles + start for shape, start in zip(shapes, starts, strict=False)]
    return Shape(np.vstack([shape.vertices for shape in shapes]), np.vstack(triangles))


def _trunk() -> list[Part]:
    return [
        ball((0, 0, 0.98), (0.19, 0.13, 0.16), 0.05, "trunk"),
        ball((0, 0, 1.14), (0.165, 0.115, 0.16), 0.08, "trunk"),
        ball((0, 0.005, 1.34), (0.205, 0.13, 0.19), 0.06, "trunk"),
        *pair(ball((0.09, -0.09, 1.39), (0.095, 0.045, 0.07), 0.02, "trunk")),
        *pair(ball((0.10, 0.09, 1.38), (0.085, 0.04, 0.11), 0.03, "trunk")),
        *(
            half
            for z in (1.28, 1.21, 1.14)
            for half in pair(ball((0.048, -0.105, z), (0.046, 0.02, 0.034), 0.012, "trunk"))
        ),
        ball((0, -0.122, 1.075), (0.016, 0.02, 0.016), 0.01, "trunk", carve=True),
        tube([(0, 0.01, 1.46), (0, -0.01, 1.60)], [0.075, 0.065], 0.05, "trunk"),
    ]


def _head() -> list[Part]:
    return [
        ball((0, 0.0, 1.73), (0.095, 0.12, 0.125), 0.03, "head"),
        ball((0, -0.055, 1.665), (0.07, 0.07, 0.085), 0.03, "head"),
        *pair(ball((0.036, -0.118, 1.725), (0.024, 0.018, 0.017), 0.012, "head", carve=True)),
        tube([(0, -0.115, 1.735), (0, -0.148, 1.685)], [0.012, 0.019], 0.014, "head"),
        tube([(-0.03, -0.117, 1.64), (0.03, -0.117, 1.64)], [0.008, 0.008], 0.008, "head"),
        tube([(-0.03, -0.117, 1.624), (0.03, -0.117, 1.624)], [0.009, 0.009], 0.008, "head"),
        *pair(ball((0.1, 0.005, 1.71), (0.012, 0.03, 0.04), 0.01, "head")),
    ]


def _limbs() -> list[Part]:
    parts = [
        ball((0.215, 0, 1.44), (0.075, 0.075, 0.08), 0.05, "arm"),
        tube([(0.22, 0, 1.44), (0.40, 0.01, 1.24)], [0.06, 0.045], 0.03, "arm"),
        ball((0.30, 0.0, 1.35), (0.058, 0.062, 0.075), 0.03, "arm"),
        tube([(0.40, 0.01, 1.24), (0.545, -0.03, 1.06)], [0.047, 0.03], 0.02, "arm"),
        ball((0.585, -0.04, 1.01), (0.032, 0.045, 0.055), 0.02, "arm", axes=turned((0, -35, 0))),
        tube([(0.095, 0, 0.92), (0.125, 0, 0.53)], [0.105, 0.066], 0.05, "leg"),
        tube([(0.125, 0, 0.53), (0.145, 0.02, 0.10)], [0.064, 0.04], 0.03, "leg"),
        ball((0.135, 0.035, 0.38), (0.055, 0.05, 0.12), 0.03, "leg"),
        ball((0.126, -0.05, 0.53), (0.038, 0.03, 0.045), 0.015, "leg"),
        ball((0.155, -0.05, 0.045), (0.05, 0.12, 0.042), 0.03, "leg"),
    ]
    for y, spread in ((-0.085, 0.4), (-0.058, 0.15), (-0.03, 0.0), (-0.004, -0.2)):
        knuckle = (0.605, y, 0.975)
        middle = (0.632, y - 0.02 * spread, 0.935)
        tip = (0.65, y - 0.05 * spread, 0.885)
        parts.append(tube([knuckle, middle, tip], [0.016, 0.015, 0.011], 0.008, "arm"))
    thumb = [(0.565, -0.08, 1.01), (0.56, -0.115, 0.975), (0.565, -0.135, 0.945)]
    parts.append(tube(thumb, [0.018, 0.016, 0.012], 0.01, "arm"))
    for x, long in ((0.115, 0.03), (0.138, 0.025), (0.158, 0.02), (0.177, 0.012), (0.195, 0.004)):
        toe = [(x, -0.145, 0.03), (x, -0.165 - long, 0.024)]
        parts.append(tube(toe, [0.016, 0.012], 0.006, "leg"))
    return [half for part in parts for half in pair(part)]


def _bust() -> list[Part]:
    parts = [
        ball((0, 0.02, 0.62), (0.21, 0.255, 0.26), 0.03, "head"),
        ball((0, -0.09, 0.50), (0.155, 0.16, 0.20), 0.08, "head"),
        tube([(0, 0.04, 0.42), (0, 0.06, 0.10)], [0.13, 0.15], 0.08, "neck"),
        ball((0, 0.07, 0.02), (0.42, 0.19, 0.14), 0.10, "neck"),
        ball((0, 0.06, -0.12), (0.18, 0.15, 0.06), 0.05, "neck"),
        ball((0, 0.06, -0.24), (0.24, 0.20, 0.08), 0.02, "foot"),
        *pair(ball((0.075, -0.235, 0.585), (0.058, 0.05, 0.036), 0.03, "face", carve=True)),
        *pair(ball((0.073, -0.185, 0.583), (0.042, 0.042, 0.034), 0.008, "face")),
        *pair(tube([(0.03, -0.235, 0.645), (0.12, -0.205, 0.655)], [0.018, 0.014], 0.02, "face")),
        tube([(0, -0.235, 0.63), (0, -0.305, 0.505)], [0.022, 0.036], 0.03, "face"),
        *pair(ball((0.032, -0.27, 0.498), (0.022, 0.03, 0.02), 0.012, "face")),
        tube([(-0.06, -0.232, 0.428), (0, -0.262, 0.432), (0.06, -0.232, 0.428)],
             [0.012, 0.018, 0.012], 0.012, "face"),
        tube([(-0.055, -0.232, 0.398), (0, -0.258, 0.392), (0.055, -0.232, 0.398)],
             [0.012, 0.02, 0.012], 0.012, "face"),
        ball((0, -0.215, 0.325), (0.055, 0.05, 0.045), 0.04, "face"),
        *pair(ball((0.215, 0.02, 0.56), (0.022, 0.06, 0.085), 0.02, "face")),
        *pair(ball((0.232, 0.005, 0.565), (0.014, 0.034, 0.05), 0.01, "face", carve=True)),
    ]  # fmt: skip
    center, radii = np.array([0, 0.02, 0.62]), np.array([0.215, 0.262, 0.268])
    for slant in np.linspace(-0.5, 1.0, 11):
        for side in (-1, 1):
            angle = np.linspace(0.1, 1.5, 6)
            wave = slant + 0.05 * np.sin(9 * angle)
            way = [side * np.sin(angle), np.cos(angle) * np.sin(wave), np.cos(angle) * np.cos(wave)]
            points = center + radii * np.stack(way, axis=1)
            strand = [tuple(point) for point in points.tolist()]
            parts.append(tube(strand, [0.016, 0.024, 0.026, 0.026, 0.024, 0.014], 0.008, "hair"))
    return parts


def _skirt(n_around: int = 150, n_along: int = 55) -> Shape:
    """From the waist to the shins; its outer layer ends in its inner one at both rims."""
    along = np.linspace(0, 1, n_along)
    share = np.concatenate([along, along[::-1]])
    inward = np.repeat([0, CLOTH], n_along)
    angle = np.linspace(0, 2 * np.pi, n_around, endpoint=False)[:, None]
    fold = 0.035 * share * np.cos(11 * angle + 2 * share) + 0.012 * share * np.cos(23 * angle)
    wide = 0.22 + 0.15 * share + fold - inward
    deep = 0.17 + 0.15 * share + fold - inward
    z = np.broadcast_to(1.08 - 0.72 * share, wide.shape)
    points = np.stack([wide * np.cos(angle), deep * np.sin(angle), z], axis=-1)
    triangles = lattice(n_around, 2 * n_along, wrap=(True, True))
    return Shape(points.reshape(-1, 3), triangles[:, ::-1])


def _cape(n_across: int = 90, n_along: int = 90) -> Shape:
    """From the shoulders down the back."""
    across, share = np.meshgrid(
        np.linspace(-1, 1, n_across), np.linspace(0, 1, n_along), indexing="ij"
    )
    fold = 0.04 * share * np.cos(14 * across) + 0.015 * share * np.sin(31 * across + 3 * share)
    x = across * (0.25 + 0.22 * share)
    y = 0.18 + 0.36 * share**1.3 - 0.05 * across**2 * (1 - share) + fold
    points = np.stack([x, y, 1.5 - 1.2 * share], axis=-1)
    return Shape(points.reshape(-1, 3), lattice(n_across, n_along, wrap=(False, False)))
