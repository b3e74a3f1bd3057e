"""What is held and what is pulled, drawn over the active mesh, or over those that the active object
moves.

Nothing of Blender's is kept between two drawings but batches of the graphics card. What they show
is recognised by identifiers.
"""

from __future__ import annotations

import bpy
from spectral_tv.later import np

from ..drawing.views import is_seen, lifted, redraw_views
from ..scene import listening
from . import held
from .constraints import deformation_of

# How opaque the least and the greatest weight are.
FAINTEST, STRONGEST = 0.12, 0.6
# A scene, a view layer and an object, by their identifiers.
Key = tuple[int, str, int]

_known: dict[Key, _Drawn] = {}
# What is being picked, by the object's identifier.
_picked: dict[int, held.Picked] = {}
# The active object and the meshes that it moves, of each view layer.
_moved: dict[tuple[int, str], tuple[int, list[str]]] = {}
_handle: object | None = None


class _Drawn:
    """What was last drawn of an object."""

    def __init__(self) -> None:
        self.held = held.Held()
        self.layer: held.Layer | None = None
        self.chosen: tuple | None = None
        self.colors: np.ndarray | None = None
        self.batch: object = None


def start() -> None:
    """Draw in all 3D views; without a window there are none."""
    global _handle  # noqa: PLW0603 - there is one
    if _handle is None and not bpy.app.background:
        space = bpy.types.SpaceView3D
        _handle = space.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")


def withdraw() -> None:
    """Draw no more."""
    global _handle  # noqa: PLW0603 - there is one
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
    _handle = None


def forget() -> None:
    """Let go of all that is kept, and listen no more until something is drawn."""
    _known.clear()
    _picked.clear()
    _moved.clear()
    listening.ignore(_handlers())
    if bpy.app.timers.is_registered(redraw_views):
        bpy.app.timers.unregister(redraw_views)


def pick(obj: bpy.types.Object, picked: held.Picked | None) -> None:
    """Draw what is being picked of ``obj`` too, whatever is hidden; None ends it."""
    _picked.clear()
    if picked is not None:
        _picked[obj.session_uid] = picked
    redraw_views()


def drawn(
    layer: bpy.types.ViewLayer, active: bpy.types.Object | None, scene: bpy.types.Scene
) -> list[bpy.types.Object]:
    """The objects that are drawn over: the active mesh, or those that the active object moves."""
    if active is None:
        return []
    if active.type == "MESH" and deformation_of(active).constraints:
        return [active]
    place = scene.session_uid, layer.name
    uid, names = _moved.get(place, (0, []))
    if uid != active.session_uid:
        names = [each.name for each in layer.objects if _is_moved_by(each, active)]
        _moved[place] = active.session_uid, names
    found = [layer.objects.get(name) for name in names]
    return [each for each in found if each is not None and _is_moved_by(each, active)]


def colors(layer: held.Layer, held: tuple, pulled: tuple) -> np.ndarray:
    """RGBA (P, 4) of the places of a layer, with the RGB of what is held and what is pulled."""
    firm, corners = layer.strengths.astype(np.float64), layer.corners
    hue = firm.copy()
    # Where the weight is 0 it is that of the neighbors, so that edges fade and do not darken.
    for column in corners.T:
        is_edge = ~firm[column].any(axis=1)
        np.add.at(hue, column[is_edge], firm[corners[is_edge]].sum(axis=1))
    mixed = hue @ np.array([held, pulled]) / hue.sum(axis=1, keepdims=True)
    firmest = firm.max(axis=1, keepdims=True)
    opacity = np.where(firmest > 0, FAINTEST + (STRONGEST - FAINTEST) * firmest, 0)
    return np.hstack([mixed, opacity]).astype(np.float32)


def _is_moved_by(obj: bpy.types.Object, mover: bpy.types.Object) -> bool:
    return obj.type == "MESH" and any(
        each.kind == "OBJECT" and each.target == mover for each in deformation_of(obj).constraints
    )


def _draw() -> None:
    context = bpy.context
    space, scene, layer = context.space_data, context.scene, context.view_layer
    if space is None or space.type != "VIEW_3D" or context.region_data is None:
        return
    active, graph = context.active_object, layer.depsgraph
    shown = drawn(layer, active, scene) if space.overlay.show_overlays else []
    shown = [each for each in shown if deformation_of(each).shows_regions]
    if active is not None and active.session_uid in _picked and active not in shown:
        shown.append(active)
    keys = [(scene.session_uid, layer.name, each.session_uid) for each in shown]
    for key in [key for key in _known if key[:2] == (scene.session_uid, layer.name)]:
        if key not in keys:
            del _known[key]
    for key, obj in zip(keys, shown, strict=True):
        if graph is not None and obj.mode == "OBJECT" and is_seen(obj, space, graph):
            _draw_over(obj, graph, context, _known.setdefault(key, _Drawn()))


def _draw_over(
    obj: bpy.types.Object, graph: bpy.types.Depsgraph, context: bpy.types.Context, known: _Drawn
) -> None:
    import gpu  # noqa: PLC0415 - it is of no use without a window
    from gpu_extras.batch import batch_for_shader  # noqa: PLC0415

    _listen()
    theme = context.preferences.themes[0]
    chosen = tuple(theme.user_interface.axis_z), tuple(theme.view_3d.object_active)
    layer = known.held.layer(obj, graph, _picked.get(obj.session_uid))
    if known.held.wait is not None and not bpy.app.timers.is_registered(redraw_views):
        bpy.app.timers.register(redraw_views, first_interval=known.held.wait)
    if not len(layer.corners):
        known.layer = known.batch = None
        return
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    if known.layer is None or layer.strengths is not known.layer.strengths or (
        chosen != known.chosen
    ):  # fmt: skip
        known.colors, known.chosen, known.batch = colors(layer, *chosen), chosen, None
    if known.batch is None or layer is not known.layer:
        content = {"pos": layer.positions, "color": known.colors}
        known.batch = batch_for_shader(shader, "TRIS", content, indices=layer.corners)
        known.layer = layer
    world = obj.evaluated_get(graph).matrix_world
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    with gpu.matrix.push_pop():
        gpu.matrix.load_matrix(lifted(obj, world, layer.is_exact, context) @ world)
        known.batch.draw(shader)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def _listen() -> None:
    listening.listen(_handlers())


def _handlers() -> list[listening.Handler]:
    frames = (bpy.app.handlers.frame_change_post, _notice)
    return [*listening.changes(_notice, _distrust), frames]


def _notice(_scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> None:
    """Take note of what Blender updated; a handle that is dragged is not of it."""
    for update in graph.updates:
        changed = update.id.original
        if update.is_updated_geometry and isinstance(changed, bpy.types.Object):
            for key, known in _known.items():
                if key[2] == changed.session_uid:
                    known.held.notice()
        elif not update.is_updated_transform:
            _moved.clear()


def _distrust(*_arguments: object) -> None:
    _moved.clear()
    for known in _known.values():
        known.held = held.Held()
