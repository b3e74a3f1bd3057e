"""The filter curve H: Blender's own curve widget, kept in the file."""

from functools import partial

import bpy
from spectral_tv.bands.filtering import Curve

# Curves live in nodes only; the dot hides the group from menus.
GROUP = ".Spectral TV Filter"
NODE = "Filter"
HIGHEST = 4.0


def find() -> bpy.types.Node | None:
    """The node that holds the curve, if there is one."""
    group = bpy.data.node_groups.get(GROUP)
    return group.nodes.get(NODE) if group is not None else None


def ensure() -> bpy.types.Node:
    """The node that holds the curve; a new curve keeps every band."""
    node = find()
    if node is not None:
        return node
    group = bpy.data.node_groups.get(GROUP)  # the node may have been deleted
    if group is None:
        group = bpy.data.node_groups.new(GROUP, "ShaderNodeTree")
        group.use_fake_user = True
    node = group.nodes.new("ShaderNodeFloatCurve")
    node.name = NODE
    mapping = node.mapping
    mapping.clip_min_x, mapping.clip_max_x = 0, 1
    mapping.clip_min_y, mapping.clip_max_y = -1, HIGHEST
    for point in mapping.curves[0].points:
        point.location.y = 1
    mapping.update()
    mapping.reset_view()
    return node


def evaluate(node: bpy.types.Node, position: float) -> float:
    """H at a position in [0, 1], finest to largest."""
    node.mapping.initialize()
    return node.mapping.evaluate(node.mapping.curves[0], position)


def current() -> Curve | None:
    """H, if there is one."""
    node = find()
    return None if node is None else partial(evaluate, node)
