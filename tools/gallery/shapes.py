"""The surfaces of the figures: generated ones, and those of a folder of meshes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import bpy
import numpy as np

from ..demo.creature import creature as demo_creature
from ..demo.importing import import_mesh
from ..demo.studio import vertices_of
from .page import Shape


def sinc(n_around: int = 72, n_along: int = 190) -> Shape:
    """A part of a sinc curve, moved off the axis and turned around it: three bulges, two necks."""
    s = np.linspace(1.6, 14.1, n_along)
    radius = 0.32 + np.sinc(s / np.pi)
    return Shape(*_turned(radius, 0.26 * (s - s[0]), n_around), elevation=14.0)


def sphere(subdivisions: int = 5) -> Shape:
    """The unit sphere."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions + 1)
    return taken(bpy.context.object)


def torus(major: float = 2.0, minor: float = 0.7, n_around: int = 200, n_tube: int = 70) -> Shape:
    """A torus about the z axis."""
    around, tube = np.meshgrid(
        *(np.linspace(0, 2 * np.pi, n, endpoint=False) for n in (n_around, n_tube)), indexing="ij"
    )
    distance = major + minor * np.cos(tube)
    points = [distance * np.cos(around), distance * np.sin(around), minor * np.sin(tube)]
    triangles = lattice(n_around, n_tube, wrap=(True, True))
    return Shape(np.stack(points, axis=-1).reshape(-1, 3), triangles, azimuth=0, elevation=48)


def meteorite() -> Shape:
    """A lump with the dents and pits of a stone that has come through the air."""
    shape = sphere(6)
    rng = np.random.default_rng(7)
    unit = shape.vertices / np.linalg.norm(shape.vertices, axis=1, keepdims=True)
    lump = unit * [1.25, 0.9, 0.85]
    for _ in range(9):  # great facets
        direction = _direction(rng)
        lump -= 0.55 * np.maximum(unit @ direction - 0.72, 0)[:, None] * direction
    height = np.zeros(len(unit))
    for _ in range(150):
        width = rng.uniform(0.07, 0.24)
        height -= 0.30 * width * _dent(unit @ _direction(rng), width)
    for frequency, strength in ((9, 0.012), (21, 0.007), (45, 0.004)):
        waves = [np.sin(frequency * unit @ _direction(rng) + rng.uniform(0, 6)) for _ in range(12)]
        height += strength * np.sum(waves, axis=0) / 3
    return Shape(lump * (1 + height)[:, None], shape.triangles, azimuth=30)


@cache
def terrain(n: int = 150) -> Shape:
    """Mountains with ridges, an open sheet."""
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    rng = np.random.default_rng(1)
    height = np.zeros_like(x)
    for frequency in (3, 6, 12, 24, 48):
        for _ in range(5):
            along, across = _direction(rng)[:2]
            wave = np.sin(frequency * (x * along + y * across) + rng.uniform(0, 6))
            height -= 0.24 / frequency * np.abs(wave)
    points = np.stack([x, y, height], axis=-1).reshape(-1, 3)
    triangles = lattice(n, n, wrap=(False, False))
    return Shape(points - points.mean(axis=0), triangles, azimuth=30, elevation=38)


@cache
def monkey() -> Shape:
    """Blender's Suzanne, subdivided; her eyes and her head are open surfaces of their own."""
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 3
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    return taken(obj, azimuth=20.0)


@cache
def creature() -> Shape:
    """The demo's dragon."""
    return taken(demo_creature())


def poses() -> list[Shape]:
    """The dragon as it is; turned, with an arm let down; leaning, with its arms up."""
    shape = creature()
    moved = []
    for turn, lean, left, right in ((0, 0, 0, 0), (35, 0, 75, 10), (-20, 22, -35, -25)):
        points = shape.vertices.copy()
        for side, degrees in ((1, left), (-1, right)):
            out = side * points[:, 0]
            ears = _step(points[:, 2], 1.45, 1.5) * (1 - _step(out, 0.5, 0.54))
            share = _step(out, 0.34, 0.6) * _step(points[:, 2], 0.8, 1.0) * (1 - ears)
            pivot = np.array([side * 0.36, 0, 1.15])
            points = _bent(points, pivot, 1, side * degrees * share)
        points = _bent(points, np.zeros(3), 2, turn * _step(points[:, 2], 0.6, 1.5))
        points = _bent(points, np.array([0, 0, 0.6]), 1, lean * _step(points[:, 2], 0.5, 1.5))
        moved.append(replace(shape, vertices=points))
    return moved


def from_folder(folder: Path | None, name: str, **view: float) -> Shape | None:
    """The mesh ``name`` in a folder of them; None where there is none."""
    files = sorted(folder.glob(f"{name}.*")) if folder is not None else []
    if not files:
        return None
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return taken(import_mesh(files[0]), **view)


def taken(obj: bpy.types.Object, **view: float) -> Shape:
    """The triangles of an object, which is removed, to be seen from somewhere."""
    data = obj.data
    data.calc_loop_triangles()
    corners = np.empty(3 * len(data.loop_triangles), dtype=np.int32)
    data.loop_triangles.foreach_get("vertices", corners)
    shape = Shape(vertices_of(data), corners.reshape(-1, 3).astype(np.int64), **view)
    bpy.data.objects.remove(obj)
    bpy.data.meshes.remove(data)
    return shape


def _turned(radius: np.ndarray, z: np.ndarray, n_around: int) -> tuple[np.ndarray, np.ndarray]:
    """A profile turned around the z axis, open at both ends."""
    angle = np.linspace(0, 2 * np.pi, n_around, endpoint=False)[:, None]
    points = [
        radius * np.cos(angle),
        radius * np.sin(angle),
        np.broadcast_to(z, (n_around, len(z))),
    ]
    vertices = np.stack(points, axis=-1).reshape(-1, 3)
    return vertices, lattice(n_around, len(z), wrap=(True, False))


def lattice(rows: int, columns: int, wrap: tuple[bool, bool]) -> np.ndarray:
    """Two triangles per cell, the diagonals alternating so that no direction is favoured."""
    index = np.pad(
        np.arange(rows * columns).reshape(rows, columns),
        ((0, wrap[0]), (0, wrap[1])),
        mode="wrap",
    )
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    is_even = (np.add.outer(np.arange(a.shape[0]), np.arange(a.shape[1])) % 2 == 0)[..., None]
    one = np.where(is_even, np.stack([a, b, c], axis=-1), np.stack([a, b, d], axis=-1))
    two = np.where(is_even, np.stack([a, c, d], axis=-1), np.stack([b, c, d], axis=-1))
    return np.concatenate([one.reshape(-1, 3), two.reshape(-1, 3)])


def _step(x: np.ndarray, low: float, high: float) -> np.ndarray:
    """From 0 at ``low`` smoothly to 1 at ``high``."""
    share = np.clip((x - low) / (high - low), 0, 1)
    return share * share * (3 - 2 * share)


def _bent(points: np.ndarray, pivot: np.ndarray, axis: int, degrees: np.ndarray) -> np.ndarray:
    """Each point turned about an axis through ``pivot`` by its own angle."""
    one, two = (axis + 1) % 3, (axis + 2) % 3
    angle = np.radians(degrees)
    offset, turned = points - pivot, points - pivot
    turned[:, one] = offset[:, one] * np.cos(angle) - offset[:, two] * np.sin(angle)
    turned[:, two] = offset[:, one] * np.sin(angle) + offset[:, two] * np.cos(angle)
    return turned + pivot


def _direction(rng: np.random.Generator) -> np.ndarray:
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def _dent(cosine: np.ndarray, width: float) -> np.ndarray:
    """A hollow with a raised rim around a direction, of this angular width."""
    angle = np.arccos(np.clip(cosine, -1, 1)) / width
    return np.where(angle < 1, 1 - angle**2, 0) - 0.35 * np.exp(-((angle - 1.1) ** 2) / 0.04)
