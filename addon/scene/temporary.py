"""What is changed or made for a while."""

from contextlib import ExitStack
from typing import Any, TypeVar

import bpy
from mathutils import Matrix

Made = TypeVar("Made", bound=bpy.types.ID)


class Temporary(ExitStack):
    """Changes that are undone at the end of the block, the last one first."""

    def put(self, owner: Any, name: str, value: Any) -> None:
        """Set a property."""
        self.callback(setattr, owner, name, getattr(owner, name))
        setattr(owner, name, value)

    def made(self, data: Made) -> Made:
        """Have a data-block that was made be removed; what uses it has to be made later."""
        self.callback(bpy.data.batch_remove, [data])
        return data

    def adopt(self, obj: bpy.types.Object, parent: bpy.types.Object, inverse: Matrix) -> None:
        """Give an object that has no parent one."""
        own = obj.matrix_parent_inverse.copy()
        self.callback(setattr, obj, "matrix_parent_inverse", own)
        self.put(obj, "parent", parent)  # it resets the matrix
        obj.matrix_parent_inverse = inverse
