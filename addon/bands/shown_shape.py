"""Shapes with other vertices than the mesh: what modifiers show, and the top level of a sculpt.

Their bands are on a new object, which takes the place of the one that was decomposed.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene import applied, mix, multires, work_objects
from ..scene.modifiers import between, is_moved
from ..scene.objects import take_place
from ..scene.places import is_kept_up
from ..scene.surface import Reading, Surface
from ..scene.temporary import Temporary


def count(obj: bpy.types.Object, shape: str) -> int:
    """How many vertices such a shape has, as far as Blender has worked it out already."""
    if shape == "MULTIRES":
        has_levels = multires.levels_refusal(obj) is None
        return multires.top_count(obj) if has_levels else len(obj.data.vertices)
    graph = bpy.context.view_layer.depsgraph
    return len((obj if graph is None else obj.evaluated_get(graph)).data.vertices)


def read(obj: bpy.types.Object, shape: str, reading: Reading) -> Surface:
    """The surface of such a shape; raises Refusal or spectral_tv.MeshError if it cannot be read."""
    with Temporary() as now:
        return Surface.read_mesh(now.made(_mesh(obj, shape)), obj.matrix_world, reading)


def new_object(obj: bpy.types.Object, shape: str, surface: Surface) -> bpy.types.Object:
    """A new object with the shape that was read; raises Refusal if it is another one by now."""
    mesh = _mesh(obj, shape)
    if not surface.is_of(mesh):
        bpy.data.meshes.remove(mesh)
        raise Refusal("nothing was written, as what is shown changed in the meantime")
    if shape == "MULTIRES":
        return work_objects.make(obj, mesh)
    return applied.object_of(mesh, obj, "Applied")


@contextmanager
def in_the_place_of(
    obj: bpy.types.Object, shape: str, surface: Surface
) -> Iterator[bpy.types.Object]:
    """Yield the same; in the end it takes the place of ``obj``, or is gone if the block fails."""
    new = new_object(obj, shape, surface)
    try:
        yield new
    except BaseException:
        bpy.data.meshes.remove(new.data)  # and the object with it
        raise
    if shape == "MULTIRES":
        note(f"the bands are on {new.name!r}; Write Back gives {obj.name!r} its shape")
    else:
        obj.hide_render = True
        note(
            f"the bands are on {new.name!r}, with its modifiers applied; {obj.name!r} is hidden, "
            "in renders too"
        )
    take_place(new, obj)


def remarks(obj: bpy.types.Object, shape: str) -> list[str]:
    """What is decomposed of ``obj``, and what becomes of the modifiers."""
    names = ", ".join(between(obj))
    if shape == "MULTIRES":
        reason = multires.levels_refusal(obj)
        if reason is not None:
            return [reason[0].lower() + reason[1:]]
        modifier = multires.modifier_of(obj)
        return [f"level {modifier.total_levels} of {modifier.name} is decomposed, at rest"]
    when = f" on frame {bpy.context.scene.frame_current}" if is_moved(obj) else ""
    found = [f"it is decomposed as shown{when} with {names}"] if names else []
    if when:
        found.append(f"the new object keeps this shape: {names} will not move it")
    keys = mix.told(obj)
    return found + ([f"{keys} become part of the shape"] if keys else [])


def _mesh(obj: bpy.types.Object, shape: str) -> bpy.types.Mesh:
    if shape == "MULTIRES":
        return multires.top_mesh(obj)
    if not is_kept_up(obj):
        raise Refusal("it is hidden, so that Blender does not work out its modifiers; show it")
    return applied.mesh_of(obj)
