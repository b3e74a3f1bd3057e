"""Drivers: compared, copied, and led to other shape keys."""

import re
from collections.abc import Iterator, Mapping

import bpy

from .channels import drivers_of

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
    keys = mesh.shape_keys
    owners = {keys, mesh, *(obj for obj in bpy.data.objects if obj.data == mesh)}
    users = {keys}.union(*bpy.data.user_map(subset=owners).values())
    for target in _targets(users):
        if target.id not in owners:
            continue

        def new_name(found: re.Match[str]) -> str:
            name = bpy.utils.unescape_identifier(found[1])
            return f'key_blocks["{bpy.utils.escape_identifier(renamed.get(name, name))}"]'

        path = KEY.sub(new_name, target.data_path)
        if path != target.data_path:
            target.data_path = path


def _targets(users: set[bpy.types.ID]) -> Iterator[bpy.types.DriverTarget]:
    """All that the drivers of data-blocks and of their node trees read."""
    for user in users:
        for owner in (user, getattr(user, "node_tree", None)):
            for driven in drivers_of(owner):
                for variable in driven.driver.variables:
                    yield from variable.targets


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
