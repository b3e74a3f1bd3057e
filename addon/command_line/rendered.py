"""Making renders show what the viewport shows, for exporters that write what is rendered."""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import chain

import bpy

from ..scene.channels import actions_of
from ..scene.notes import listed, note

# Properties that renders go by, and those that the viewport goes by.
PAIRS = {
    "hide_render": "hide_viewport",
    "show_instancer_for_render": "show_instancer_for_viewport",
    "show_render": "show_viewport",
    "render_levels": "levels",  # of subdivision
    "render_steps": "steps",  # of a screw
    "resolution": "viewport_resolution",  # of an ocean
    "render_resolution": "resolution",  # of metaballs
    "render_resolution_u": "resolution_u",  # of curves
    "render_resolution_v": "resolution_v",
    "simplify_subdivision_render": "simplify_subdivision",  # of all in a scene
}
# The node that tells viewports from renders.
TELLER = "GeometryNodeIsViewport"


@contextmanager
def rendered_as_shown() -> Iterator[None]:
    """Have renders show what the viewport shows; it is noted where nodes will tell them apart."""
    before = []

    def change(owner: bpy.types.bpy_struct, name: str, value: object) -> None:
        if getattr(owner, name) != value:
            before.append((owner, name, getattr(owner, name)))
            setattr(owner, name, value)

    try:
        for curve in _curves():
            if curve.data_path.rpartition(".")[2] in PAIRS:
                change(curve, "mute", True)
        for owner in _owners():
            for name, shown in PAIRS.items():
                if hasattr(owner, name) and hasattr(owner, shown):
                    change(owner, name, getattr(owner, shown))
        bpy.context.view_layer.update()
        if bpy.app.version > (5, 1) and (tellers := _tellers()):
            note(f"written as it is rendered, by the nodes that tell: {listed(tellers)}")
        yield
    finally:
        for owner, name, value in reversed(before):
            setattr(owner, name, value)


def _blocks() -> Iterator[bpy.types.ID]:
    """All data-blocks that have such properties; what is instanced may be in no scene."""
    return chain(bpy.data.collections, bpy.data.curves, bpy.data.metaballs, bpy.data.objects)


def _owners() -> Iterator[bpy.types.bpy_struct]:
    yield bpy.context.scene.render
    for block in _blocks():
        yield block
        if isinstance(block, bpy.types.Object):
            yield from block.modifiers


def _curves() -> Iterator[bpy.types.FCurve]:
    """What animates or drives them."""
    for block in _blocks():
        if getattr(block, "animation_data", None) is not None:
            yield from block.animation_data.drivers
            for animated in actions_of(block):
                yield from animated.curves or ()


def _tellers() -> list[str]:
    """Names of the node groups in use that tell viewports from renders."""
    return [
        group.name
        for group in bpy.data.node_groups
        if group.users and any(node.bl_idname == TELLER for node in group.nodes)
    ]
