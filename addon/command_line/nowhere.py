"""Vertices without a finite place: only a .blend can hold them."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bmesh
import bpy
import numpy as np
from spectral_tv.notes import a, note

from ..scene.coordinates import coordinates
from ..scene.mix import keys_of
from .copies import held
from .digits import are_nowhere


def tell_kept(objects: Sequence[bpy.types.Object]) -> None:
    """Note that a .blend keeps vertices without a finite place."""
    meshes = {obj.data for obj in objects if obj.type == "MESH"}
    count = sum(len(_nowhere(mesh)) for mesh in meshes)
    if count:
        note(f"a .blend keeps {_vertices(count)}, and the faces there, as they were")


@contextmanager
def left_out(objects: Sequence[bpy.types.Object], suffix: str) -> Iterator[None]:
    """Have mesh objects hold copies of their meshes without such vertices and their faces."""
    users: dict[bpy.types.Mesh, list[bpy.types.Object]] = {}
    for obj in objects:
        if obj.type == "MESH":
            users.setdefault(obj.data, []).append(obj)
    found = {mesh: members for mesh in users if len(members := _nowhere(mesh))}
    if not found:
        yield
        return
    copies = {mesh: mesh.copy() for mesh in found}
    faces = sum(_remove(copies[mesh], members) for mesh, members in found.items())
    vertices = _vertices(sum(map(len, found.values())))
    note(f"{a(suffix)} does not hold {vertices}: left out, with {faces} faces there")
    with held({obj: copies[mesh] for mesh in found for obj in users[mesh]}):
        yield


def _vertices(count: int) -> str:
    return f"{'1 vertex' if count == 1 else f'{count} vertices'} without a finite place"


def _nowhere(mesh: bpy.types.Mesh) -> np.ndarray:
    """Indices of the vertices that have no finite place, in the mesh or one of its keys."""
    is_nowhere = np.zeros(len(mesh.vertices), dtype=bool)
    for points in (mesh.vertices, *(key.points for key in keys_of(mesh).values())):
        is_nowhere |= are_nowhere(coordinates(points).reshape(-1, 3))
    return np.flatnonzero(is_nowhere)


def _remove(mesh: bpy.types.Mesh, members: np.ndarray) -> int:
    """Remove vertices, and return how many faces went with them."""
    before = len(mesh.polygons)
    work = bmesh.new()
    work.from_mesh(mesh)
    work.verts.ensure_lookup_table()
    bmesh.ops.delete(work, geom=[work.verts[index] for index in members], context="VERTS")
    work.to_mesh(mesh)
    work.free()
    mesh.update()
    return before - len(mesh.polygons)
