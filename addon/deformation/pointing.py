"""What the mouse points at in a 3D view."""

import bpy
from bpy_extras import view3d_utils
from mathutils import Vector

# A view, and where it is pointed at, in its pixels.
View = tuple[bpy.types.Region, bpy.types.RegionView3D, tuple[int, int]]


def view_under(context: bpy.types.Context, event: bpy.types.Event) -> View | None:
    """The 3D view under the mouse, not what lies over it; for the moment, as it may be closed."""
    x, y = event.mouse_x, event.mouse_y
    for area in context.window.screen.areas:
        if area.type == "VIEW_3D":
            under = [
                each
                for each in area.regions
                if 0 <= x - each.x < each.width and 0 <= y - each.y < each.height
            ]
            if under and all(each.type == "WINDOW" for each in under):
                region = under[0]
                return region, region.data, (x - region.x, y - region.y)
    return None


def ray(view: View) -> tuple[Vector, Vector]:
    """Where the line under the mouse begins in the world, and its direction."""
    return (
        view3d_utils.region_2d_to_origin_3d(*view),
        view3d_utils.region_2d_to_vector_3d(*view),
    )


def pixel(view: View, point: Vector) -> float:
    """How long a pixel is at a point of the world."""
    region, data, (x, y) = view
    ends = [
        view3d_utils.region_2d_to_location_3d(region, data, (x + step, y), point) for step in (0, 1)
    ]
    return (ends[1] - ends[0]).length
