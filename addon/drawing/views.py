"""What is drawn over the surface of an object in the 3D views."""

import bpy
from mathutils import Matrix

# How far in front of the surface it is, relative to the distance from the eye; and relative to the
# object's size where modifiers round what is drawn.
LIFT, ROUNDED = 1e-3, 0.03


def redraw_views() -> None:
    """Have all 3D views drawn anew."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def is_seen(
    obj: bpy.types.Object, space: bpy.types.SpaceView3D, graph: bpy.types.Depsgraph
) -> bool:
    """Whether a view shows it; Blender tells of local views in what was evaluated alone."""
    layer = graph.view_layer
    return obj.visible_get(view_layer=layer) and (
        obj.evaluated_get(graph).visible_in_viewport_get(space)
    )


def lifted(
    obj: bpy.types.Object, world: Matrix, is_exact: bool, context: bpy.types.Context
) -> Matrix:
    """From the world to the view, a little nearer to the eye at the same place of the picture.

    Further if what is drawn ``is_exact`` not where the surface is.
    """
    view, size = context.region_data.view_matrix, max(obj.dimensions)
    if context.region_data.window_matrix[3][3] == 0:  # perspective
        distance = max(-(view @ world.translation).z, size / 2)
        lift = LIFT if is_exact else min(LIFT + ROUNDED * size / distance, 0.5)
        return Matrix.Diagonal((1 - lift, 1 - lift, 1 - lift, 1)) @ view
    lift = max(LIFT * context.region_data.view_distance, 1e-6 * context.space_data.clip_end)
    return Matrix.Translation((0, 0, lift if is_exact else lift + ROUNDED * size)) @ view
