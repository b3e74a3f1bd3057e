"""How much room an Alembic file takes."""

from collections.abc import Sequence

import bpy

# Bytes at most for a vertex, a corner, and for all else.
VERTEX, CORNER, REST = 48, 160, 1 << 20


def alembic_size(meshes: Sequence[bpy.types.Mesh]) -> int:
    """How many bytes a frame of meshes takes at most."""
    corners = sum(len(mesh.loops) for mesh in meshes)
    return REST + CORNER * corners + VERTEX * sum(len(mesh.vertices) for mesh in meshes)
