"""What the mouse points at in a 3D view."""

import bpy
from bpy_extras import view3d_utils
from mathutils import Vector
from spectral_tv.refusal import Refusal

# Events that turn and zoom the view, or are of no account.
PASSED_ON = ("HOME", "INBETWEEN", "MIDDLEMOUSE", "MOUSE", "NDOF", "NUMPAD", "TIMER", "TRACKPAD",
             "WHEEL", "WINDOW")  # fmt: skip
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


def on_ray(obj: bpy.types.Object, origin: Vector, direction: Vector) -> tuple[int, Vector] | None:
    """The polygon and the place, in object space, where a ray in the world meets what is shown.

    Raises Refusal if nothing is.
    """
    shown_mesh(obj)
    to_object = obj.matrix_world.inverted_safe()
    start = to_object @ origin
    along = to_object.to_3x3() @ direction
    graph = bpy.context.evaluated_depsgraph_get()
    is_hit, place, _, polygon = obj.ray_cast(start, along.normalized(), depsgraph=graph)
    return (polygon, place) if is_hit else None


def shown_mesh(obj: bpy.types.Object) -> bpy.types.Mesh:
    """What is shown of ``obj``; raises Refusal if it has no face."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    if len(mesh.polygons) == 0:
        raise Refusal("its modifiers leave no face of it")
    return mesh


def tell_next(text: str | None) -> None:
    """Show what is next in the status bar and in the headers of 3D views, until it is None."""
    for workspace in bpy.data.workspaces:  # the user may go to another one meanwhile
        workspace.status_text_set(text)
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                area.header_text_set(text)
