"""The modes of objects: entered, left for a while; what Edit Mode shows."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
from spectral_tv.refusal import Refusal


def set_mode(obj: bpy.types.Object, mode: str) -> None:
    """Have the active object be in a mode of Blender's; raises Refusal if it does not go there."""
    if obj.mode == mode:
        return
    try:
        bpy.ops.object.mode_set(mode=mode)
    except RuntimeError as error:
        raise Refusal(f"Blender does not leave {_label(obj.mode)}: {error}".strip()) from error
    if obj.mode != mode:
        raise Refusal(f"Blender does not enter {_label(mode)} with it")


@contextmanager
def out_of_edit_mode(obj: bpy.types.Object) -> Iterator[None]:
    """Have the active object be in Object Mode in the block, if it is in Edit Mode."""
    if obj.mode != "EDIT":
        yield
        return
    set_mode(obj, "OBJECT")
    try:
        yield
    finally:
        set_mode(obj, "EDIT")


def show_vertices() -> None:
    """Have Edit Mode show and select vertices, and no edges or faces for themselves."""
    # By the scene: up to Blender 4.3 the context's tool settings leave the scene in the context.
    # When that scene is gone, Blender's exporter of glTF crashes.
    bpy.context.scene.tool_settings.mesh_select_mode = (True, False, False)


def _label(mode: str) -> str:
    return bpy.types.Object.bl_rna.properties["mode"].enum_items[mode].name
