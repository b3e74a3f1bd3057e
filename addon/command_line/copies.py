"""Temporary changes for an export: objects hold copies of their meshes, modifiers are off."""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import chain

import bpy

from ..scene.temporary import Temporary

Dress = Callable[[bpy.types.Mesh], None]


@contextmanager
def dressed(objects: Sequence[bpy.types.Object], dress: Dress) -> Iterator[None]:
    """Have mesh objects hold copies of their meshes, with the changes that a format asks for."""
    copies = {mesh: mesh.copy() for mesh in dict.fromkeys(obj.data for obj in objects)}
    for copy in copies.values():
        dress(copy)
    with held({obj: copies[obj.data] for obj in objects}):
        yield


@contextmanager
def held(copies: dict[bpy.types.Object, bpy.types.Mesh]) -> Iterator[None]:
    """Have objects hold copies under the names of what they are copies of, then remove them."""
    pairs = dict.fromkeys(chain(*(_pairs(obj.data, copy) for obj, copy in copies.items())))
    names = {original: original.name for original, _ in pairs}
    with Temporary() as now:
        now.callback(bpy.context.view_layer.update)
        for original, name in names.items():
            now.put(original, "name", f"{name} (kept)")
        for original, copy in pairs:
            now.made(copy).name = names[original]
        for obj, copy in copies.items():
            now.put(obj, "data", copy)
        bpy.context.view_layer.update()
        yield


@contextmanager
def own_materials(objects: Iterable[bpy.types.Object]) -> Iterator[None]:
    """Have meshes with shape keys hold the materials that slots have by the object.

    The exporter of FBX writes a copy of such a mesh otherwise, whose keys nothing animates.
    """
    with Temporary() as now:
        for obj in objects:
            places = [i for i, slot in enumerate(obj.material_slots) if slot.link == "OBJECT"]
            if not places or obj.data.shape_keys is None:
                continue
            if obj.data.users > 1:
                now.put(obj, "data", now.made(obj.data.copy()))
            materials = [slot.material for slot in obj.material_slots]
            for place in places:
                now.put(obj.material_slots[place], "link", "DATA")
                now.callback(obj.data.materials.__setitem__, place, obj.data.materials[place])
                obj.data.materials[place] = materials[place]
        yield


@contextmanager
def unhooked(modifiers: Iterable[bpy.types.Modifier]) -> Iterator[None]:
    """Have armatures let go of objects: exporters take them along even where they are off."""
    with Temporary() as now:
        for modifier in modifiers:
            if modifier.type == "ARMATURE":
                now.put(modifier, "object", None)
        yield


@contextmanager
def off(modifiers: Collection[bpy.types.Modifier]) -> Iterator[None]:
    """Have modifiers be off that are on."""
    with Temporary() as now:
        for modifier in modifiers:
            if modifier.show_viewport:
                now.put(modifier, "show_viewport", False)
        yield


def _pairs(mesh: bpy.types.Mesh, copy: bpy.types.Mesh) -> list[tuple[bpy.types.ID, bpy.types.ID]]:
    """A mesh and its copy, and the action of its keys if that was copied for the copy."""
    both = [keys.animation_data for keys in (mesh.shape_keys, copy.shape_keys) if keys is not None]
    own = [animation.action for animation in both if animation is not None]
    is_copied = len(own) == 2 and None not in own and own[0] != own[1]
    return [(mesh, copy), (own[0], own[1])] if is_copied else [(mesh, copy)]
