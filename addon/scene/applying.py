"""Applying modifiers to meshes with shape keys, which Blender refuses."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bmesh
import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from . import results
from .applied import mesh_of
from .arrays import numbers
from .attribute_band import has_bands
from .contents import digest, topology_digest
from .coordinates import coordinates
from .temporary import Temporary

# What these do depends on what was before, or cannot be worked out for another shape.
SIMULATIONS = (
    "CLOTH", "COLLISION", "DYNAMIC_PAINT", "EXPLODE", "FLUID", "OCEAN", "PARTICLE_INSTANCE",
    "PARTICLE_SYSTEM", "SOFT_BODY", "SURFACE",
)  # fmt: skip


# What has to follow vertices and faces that change. Each is called with the object before, and
# what it returns is called afterwards.
FOLLOWERS: list[Callable[[bpy.types.Object], Callable[[], None]]] = [results.follow]


@dataclass(frozen=True)
class Applied:
    """What a modifier makes of a mesh: of its Basis as a mesh, and of every key the coordinates."""

    mesh: bpy.types.Mesh
    keys: list[np.ndarray]
    groups: list[str]


def apply_modifier(obj: bpy.types.Object, name: str) -> None:
    """Apply a modifier to the mesh of ``obj`` and to all its shape keys, which are kept.

    Everything about the keys stays: names, values, masks, animation, drivers, and to what they are
    relative. Raises Refusal if there is no such modifier, or it makes other vertices or faces of
    one key than of another.
    """
    modifier = obj.modifiers.get(name)
    reason = _why_not(obj, modifier)
    if reason:
        raise Refusal(f"the modifier {name!r} {reason}")
    with _evaluated(obj, name) as applied:
        if obj.modifiers[0] != modifier:
            note(f"{name!r} was not the first modifier: those before it now come after it")
        _write(obj, applied)
    obj.modifiers.remove(modifier)


def farthest(before: np.ndarray, after: np.ndarray) -> float:
    """How far a vertex moved; 0 where they are not the same vertices."""
    if before.shape != after.shape or not len(before):
        return 0.0
    return float(np.linalg.norm(after - before, axis=1).max())


def _why_not(obj: bpy.types.Object, modifier: bpy.types.Modifier | None) -> str:
    if modifier is None:
        return "does not exist"
    if has_bands(modifier):
        return "has bands, which Apply Look applies"
    if not modifier.show_viewport:
        return "is disabled in the viewport"
    if modifier.type in SIMULATIONS:
        return "is a simulation, which cannot be worked out for each shape key"
    if obj.data.users > 1:
        return f"would be applied to {obj.data.users} objects that share this mesh"
    return ""


@contextmanager
def _evaluated(obj: bpy.types.Object, name: str) -> Iterator[Applied]:
    """What the modifier makes of every shape key, worked out on a copy of the object."""
    with Temporary() as now:
        mesh = now.made(obj.data.copy())
        copy = now.made(obj.copy())
        copy.data = mesh
        bpy.context.scene.collection.objects.link(copy)
        copy.hide_viewport = False
        copy.shape_key_clear()
        for other in [each for each in copy.modifiers if each.name != name]:
            copy.modifiers.remove(other)
        shapes, basis = [], None
        for key in obj.data.shape_keys.key_blocks:
            mesh.vertices.foreach_set("co", coordinates(key.points))
            mesh.update()
            with Temporary() as meanwhile:
                result = (now if basis is None else meanwhile).made(mesh_of(copy))
                basis = basis or result
                _check(name, key.name, basis, result)
                shapes.append(coordinates(result.vertices))
        now.put(copy, "data", basis)
        yield Applied(basis, shapes, copy.vertex_groups.keys())


def _check(name: str, key: str, basis: bpy.types.Mesh, other: bpy.types.Mesh) -> None:
    counts = [len(each.vertices) for each in (basis, other)]
    if counts[0] != counts[1]:
        raise Refusal(
            f"the modifier {name!r} makes {counts[0]} vertices of Basis, but {counts[1]} of {key!r}"
        )
    if _connections(basis) != _connections(other):
        raise Refusal(f"the modifier {name!r} makes other faces of {key!r} than of Basis")


def _connections(mesh: bpy.types.Mesh) -> str:
    edges = numbers(mesh.edges, "vertices", 2)
    return topology_digest(mesh) + digest(edges)


def _write(obj: bpy.types.Object, applied: Applied) -> None:
    """Give the mesh other vertices and faces; its shape keys, and all about them, stay."""
    mesh = obj.data
    for group in applied.groups[len(obj.vertex_groups) :]:
        obj.vertex_groups.new(name=group)
    for material in applied.mesh.materials[len(mesh.materials) :]:
        mesh.materials.append(material)
    # A BMesh that was read from it alone knows which keys are which.
    edited = bmesh.new()
    edited.from_mesh(mesh)
    bmesh.ops.delete(edited, geom=edited.verts[:], context="VERTS")
    edited.from_mesh(applied.mesh)
    for sequence in (edited.verts, edited.edges, edited.faces):
        sequence.sort()  # they are where room was found
    edited.to_mesh(mesh)
    edited.free()
    for key, shape in zip(mesh.shape_keys.key_blocks, applied.keys, strict=True):
        key.points.foreach_set("co", shape)
    mesh.vertices.foreach_set("co", applied.keys[0])
    mesh.update()
