"""Writing on meshes whole or not at all."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
from spectral_tv.dataclass import dataclass

from .property_values import set_values_of, values_of


@contextmanager
def whole(*objects: bpy.types.Object) -> Iterator[None]:
    """If the block fails, remove all that it added to mesh objects.

    That is vertex groups, attributes, shape keys, modifiers, and texts, images and node groups of
    the file. The records of the meshes are restored. Things that existed before are not, so the
    block has to write them last, when nothing can fail.
    """
    before = [_Parts.of(obj) for obj in objects]
    kinds = (bpy.data.texts, bpy.data.images, bpy.data.node_groups)
    kept = [set(each.keys()) for each in kinds]
    try:
        yield
    except BaseException:
        for obj, parts in zip(objects, before, strict=True):
            parts.restore(obj)
        for found, names in zip(kinds, kept, strict=True):
            for name in set(found.keys()) - names:
                found.remove(found[name])
        raise


@dataclass(frozen=True)
class _Parts:
    """Names of what a mesh object has, what is active of it, and what the mesh remembers."""

    groups: list[str]
    attributes: list[str]
    keys: list[str] | None
    modifiers: list[str]
    active: tuple[int, int, str]
    remembered: tuple[dict[str, Any], dict[str, Any]]

    @classmethod
    def of(cls, obj: bpy.types.Object) -> "_Parts":
        mesh = obj.data
        keys = mesh.shape_keys
        return cls(
            obj.vertex_groups.keys(),
            mesh.attributes.keys(),
            None if keys is None else keys.key_blocks.keys(),
            obj.modifiers.keys(),
            (
                obj.vertex_groups.active_index,
                obj.active_shape_key_index,
                mesh.color_attributes.active_color_name,
            ),
            (values_of(mesh.spectral_tv), {} if keys is None else values_of(keys.spectral_tv)),
        )

    def restore(self, obj: bpy.types.Object) -> None:
        mesh = obj.data
        for name in set(obj.modifiers.keys()) - set(self.modifiers):
            obj.modifiers.remove(obj.modifiers[name])
        for name in set(obj.vertex_groups.keys()) - set(self.groups):
            obj.vertex_groups.remove(obj.vertex_groups[name])
        for name in set(mesh.attributes.keys()) - set(self.attributes):
            mesh.attributes.remove(mesh.attributes[name])
        if mesh.shape_keys is not None and self.keys is None:
            obj.shape_key_clear()
        elif mesh.shape_keys is not None:
            present = mesh.shape_keys.key_blocks
            for name in set(present.keys()) - set(self.keys):
                obj.shape_key_remove(present[name])
            set_values_of(mesh.shape_keys.spectral_tv, self.remembered[1])
        set_values_of(mesh.spectral_tv, self.remembered[0])
        obj.vertex_groups.active_index, obj.active_shape_key_index, color = self.active
        mesh.color_attributes.active_color_name = color
        mesh.update_tag()
