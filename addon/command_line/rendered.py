"""Making renders show what the viewport shows, for exporters that write what is rendered."""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import chain

import bpy
from spectral_tv.notes import listed, note

from ..scene.channels import curves_and_drivers
from ..scene.temporary import Temporary

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
    # What is instanced may be in no scene.
    data, modifiers = bpy.data, chain.from_iterable(obj.modifiers for obj in bpy.data.objects)
    blocks = [*data.collections, *data.curves, *data.metaballs, *data.objects]
    with Temporary() as now:
        for curve in chain.from_iterable(map(curves_and_drivers, blocks)):
            if curve.data_path.rpartition(".")[2] in PAIRS and not curve.mute:
                now.put(curve, "mute", True)
        for owner in (bpy.context.scene.render, *blocks, *modifiers):
            for name, shown in PAIRS.items():
                has_both = hasattr(owner, name) and hasattr(owner, shown)
                if has_both and getattr(owner, name) != getattr(owner, shown):
                    now.put(owner, name, getattr(owner, shown))
        bpy.context.view_layer.update()
        if bpy.app.version > (5, 1) and (tellers := _tellers()):
            note(f"written as it is rendered, by the nodes that tell: {listed(tellers)}")
        yield


def _tellers() -> list[str]:
    """Names of the node groups in use that tell viewports from renders."""
    return [
        group.name
        for group in bpy.data.node_groups
        if group.users and any(node.bl_idname == TELLER for node in group.nodes)
    ]
