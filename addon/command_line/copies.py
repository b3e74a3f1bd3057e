"""Temporary changes for an export: objects hold copies of their meshes, modifiers are off."""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager

import bpy

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
    before = {obj: obj.data for obj in copies}
    names: dict[bpy.types.ID, str] = {}
    actions = []
    try:
        for obj, copy in copies.items():
            mesh = obj.data
            obj.data = copy
            pairs = [(mesh, copy)]
            if (pair := _actions(mesh, copy)) is not None:
                pairs.append(pair)
                actions.append(pair[1])
            for original, other in pairs:
                names.setdefault(original, original.name)
                original.name = f"{names[original]} (kept)"
                other.name = names[original]
        bpy.context.view_layer.update()
        yield
    finally:
        for obj, mesh in before.items():
            obj.data = mesh
        bpy.data.batch_remove(list(dict.fromkeys([*copies.values(), *actions])))
        for original, name in names.items():
            original.name = name
        bpy.context.view_layer.update()


@contextmanager
def unhooked(modifiers: Iterable[bpy.types.Modifier]) -> Iterator[None]:
    """Have armatures let go of objects: exporters take them along even where they are off."""
    before = [(item, item.object) for item in modifiers if item.type == "ARMATURE"]
    try:
        for modifier, _ in before:
            modifier.object = None
        yield
    finally:
        for modifier, rig in before:
            modifier.object = rig


@contextmanager
def off(modifiers: Collection[bpy.types.Modifier]) -> Iterator[None]:
    """Have modifiers be off that are on."""
    on = [modifier for modifier in modifiers if modifier.show_viewport]
    try:
        for modifier in on:
            modifier.show_viewport = False
        yield
    finally:
        for modifier in on:
            modifier.show_viewport = True


def _actions(
    mesh: bpy.types.Mesh, copy: bpy.types.Mesh
) -> tuple[bpy.types.Action, bpy.types.Action] | None:
    """The action of a mesh's keys, and the copy of it that was made for a copy, if there is one."""
    both = [keys.animation_data for keys in (mesh.shape_keys, copy.shape_keys) if keys is not None]
    own = [animation.action for animation in both if animation is not None]
    return (own[0], own[1]) if len(own) == 2 and None not in own and own[0] != own[1] else None
