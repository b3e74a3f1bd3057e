"""Drivers: compared, copied, and led to other shape keys."""

import re
from collections.abc import Collection, Iterator, Mapping

import bpy

from .channels import drivers_of, key_path

KEY = re.compile(r'key_blocks\["((?:[^"\\]|\\.)*)"\]')


def same_driver(one: bpy.types.FCurve | None, other: bpy.types.FCurve | None) -> bool:
    """Whether two drivers do the same, or neither is there."""
    if one is None or other is None:
        return one is other
    return _description(one.driver) == _description(other.driver)


def copy_driver(
    animation: bpy.types.AnimData, driver: bpy.types.FCurve, path: str
) -> bpy.types.FCurve:
    """Have a copy of a driver drive another property of the same block."""
    copy = animation.drivers.from_existing(src_driver=driver)
    copy.data_path = path
    return copy


def retarget_drivers(mesh: bpy.types.Mesh, renamed: Mapping[str, str]) -> None:
    """Have drivers that read shape keys of ``mesh`` by old names read those by the new ones."""
    for _, target in _reading(mesh):

        def new_name(found: re.Match[str]) -> str:
            name = bpy.utils.unescape_identifier(found[1])
            return f'key_blocks["{bpy.utils.escape_identifier(renamed.get(name, name))}"]'

        path = KEY.sub(new_name, target.data_path)
        if path != target.data_path:
            target.data_path = path


def readers(mesh: bpy.types.Mesh, names: Collection[str]) -> list[str]:
    """Names of the data-blocks with drivers that read shape keys of ``mesh`` of these names.

    Those of the keys themselves are not among them.
    """
    found = {}
    own = {key_path(mesh.shape_keys.key_blocks[name]) for name in names}
    for driven, target in _reading(mesh):
        read = {bpy.utils.unescape_identifier(name) for name in KEY.findall(target.data_path)}
        is_own = driven.id_data == mesh.shape_keys and driven.data_path.startswith(tuple(own))
        if not is_own and not read.isdisjoint(names):
            found[_told(driven.id_data)] = None
    return list(found)


def path_readers(block: bpy.types.ID, paths: Collection[str]) -> list[str]:
    """Names of the data-blocks with drivers that read paths of one, but for those at the paths."""
    found = {}
    for driven, target in reading([block]):
        is_own = driven.id_data == block and driven.data_path in paths
        if not is_own and target.data_path in paths:
            found[_told(driven.id_data)] = None
    return list(found)


def _told(block: bpy.types.ID) -> str:
    """What a user calls it: shape keys by their mesh."""
    return block.user.name if isinstance(block, bpy.types.Key) and block.user else block.name


def retarget_paths(
    block: bpy.types.ID, renamed: Mapping[str, str], other: bpy.types.ID, id_type: str = ""
) -> None:
    """Have drivers that read paths of a data-block read other ones, of another block."""
    for _, target in [*reading([block])]:
        path = renamed.get(target.data_path)
        if path is not None:
            if id_type:
                target.id_type = id_type
            target.id, target.data_path = other, path


def _reading(mesh: bpy.types.Mesh) -> Iterator[tuple[bpy.types.FCurve, bpy.types.DriverTarget]]:
    """The drivers that read something of a mesh, its shape keys or its objects, and the targets.

    Drivers are those of data-blocks and of their node trees.
    """
    keys = mesh.shape_keys
    objects = {obj for obj in bpy.data.objects if obj.data == mesh}
    yield from reading({mesh, *objects, *([] if keys is None else [keys])})


def reading(
    owners: Collection[bpy.types.ID],
) -> Iterator[tuple[bpy.types.FCurve, bpy.types.DriverTarget]]:
    """The drivers that read something of data-blocks, and the targets that are these."""
    users = {*owners}.union(*bpy.data.user_map(subset={*owners}).values())
    for user in users:
        for owner in (user, getattr(user, "node_tree", None)):
            for driven in drivers_of(owner):
                for variable in driven.driver.variables:
                    for target in variable.targets:
                        if target.id in owners:
                            yield driven, target


def _description(driver: bpy.types.Driver) -> tuple[object, ...]:
    variables = [
        (
            variable.name,
            variable.type,
            [
                (
                    target.id, target.data_path, target.bone_target, target.transform_type,
                    target.transform_space, target.rotation_mode,
                )
                for target in variable.targets
            ],
        )
        for variable in driver.variables
    ]  # fmt: skip
    return driver.type, driver.expression, driver.use_self, variables
