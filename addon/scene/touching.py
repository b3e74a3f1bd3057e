"""Which objects are parts of one surface: those whose open edges meet those of another."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from spectral_tv.later import np
from spectral_tv.notes import gathered

from .surface import Reading, Surface


def touching(
    objects: Sequence[bpy.types.Object], shapes: Sequence[np.ndarray | None], reading: Reading
) -> list[list[int]]:
    """Indices of objects in groups, those together whose corners are joined or share a triangle.

    Raises Refusal or spectral_tv.MeshError if one cannot be read.
    """
    if len(objects) == 1:
        return [[0]]
    with gathered():  # who works on a group reads it again, and notes what is found in it
        surfaces = Surface.read_together(objects, shapes, reading)
    mesh = surfaces[0].mesh
    # Every vertex of the mesh has one of the objects that it is of; what is of two joins them.
    owner = np.full(len(mesh.vertex_areas), -1)
    pairs = []
    for number, surface in enumerate(surfaces):
        mine = surface.copies.places[surface.copies.places >= 0]
        shared = np.unique(owner[mine])
        pairs += [(number, other) for other in shared if other >= 0]
        owner[mine] = number
    corners = owner[mesh.triangles]
    across = corners[(corners[:, :1] != corners).any(axis=1)]
    pairs += [(row[0], other) for row in np.unique(across, axis=0) for other in row[1:]]
    group = list(range(len(objects)))
    for one, other in pairs:
        former, latter = group[one], group[other]
        group = [latter if each == former else each for each in group]
    return [
        [index for index, each in enumerate(group) if each == name] for name in dict.fromkeys(group)
    ]
