"""Quad meshes of figures made of blended solids."""

from __future__ import annotations

import bpy
import numpy as np
from skimage.measure import marching_cubes

from .solids import Part


def mesh(parts: list[Part], spacing: float, rounds: int = 4) -> bpy.types.Mesh:
    """Evenly spaced quad mesh of the surface of a figure.

    Parameters
    ----------
    parts : list of Part
    spacing : float
        Edge length aimed at, in the units of the parts.
    rounds : int
        Rounds of evening out the vertices and pulling them back onto the surface.

    Returns
    -------
    bpy.types.Mesh
    """
    # The finer the surface to pull back onto, the more of the creases between parts is kept.
    fine = 0.7 * spacing
    values, origin = sample(parts, fine)
    vertices, triangles, _, _ = marching_cubes(values, 0, spacing=(fine,) * 3)
    rough = bpy.data.meshes.new("Meshing")
    rough.from_pydata((origin + vertices).tolist(), [], triangles.tolist())
    scene = bpy.data.scenes.new("Meshing")
    figure, surface = (bpy.data.objects.new("Meshing", rough) for _ in range(2))
    for item in (figure, surface):
        scene.collection.objects.link(item)

    remesh = figure.modifiers.new("Remesh", "REMESH")
    remesh.mode = "VOXEL"
    remesh.voxel_size = spacing
    for _ in range(rounds):
        figure.modifiers.new("Smooth", "SMOOTH").factor = 0.6
        figure.modifiers.new("Shrinkwrap", "SHRINKWRAP").target = surface
    layer = scene.view_layers[0]
    layer.update()
    even = bpy.data.meshes.new_from_object(figure.evaluated_get(layer.depsgraph))
    bpy.data.batch_remove([scene, figure, surface, rough])
    return even


def sample(parts: list[Part], spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Distances to the figure on a grid around it.

    A part is evaluated only in the box in which it can move the surface, so values away from the
    surface have the right sign but not the right size.

    Parameters
    ----------
    parts : list of Part
    spacing : float
        Grid spacing, in the units of the parts.

    Returns
    -------
    values : (X, Y, Z) float32 array
    origin : (3,) array
        Position of `values[0, 0, 0]`.
    """
    boxes = [part.reach() for part in parts]
    lower = np.min([low for low, _ in boxes], axis=0) - 2 * spacing
    upper = np.max([high for _, high in boxes], axis=0) + 2 * spacing
    shape = np.ceil((upper - lower) / spacing).astype(int) + 1
    values = np.ones(shape, dtype=np.float32)
    for part, (low, high) in zip(parts, boxes, strict=True):
        first = ((low - lower) / spacing).astype(int)
        last = ((high - lower) / spacing).astype(int) + 2
        block = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
        ticks = [
            (lower[i] + spacing * np.arange(first[i], last[i])).astype(np.float32) for i in range(3)
        ]
        at = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
        values[block] = part.combine(values[block].ravel(), at).reshape(values[block].shape)
    return values, lower
