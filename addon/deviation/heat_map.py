"""The deviation in color over the active object, with a legend; it follows the bands.

Nothing of Blender's is kept between two drawings but batches of the graphics card.
"""

from __future__ import annotations

import time

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from ..bands import deviation, original
from ..bands.live_guard import question_of, sliders_of
from ..drawing.views import is_seen, lifted, redraw_views
from ..scene import lengths, listening, mix
from ..scene.coordinates import coordinates
from ..scene.records import all_bands_shown, record_of, topology_changed

# From inwards to outwards, and how opaque they are.
RAMP = (
    (0.07, 0.25, 0.75),
    (0.45, 0.68, 0.9),
    (0.93, 0.93, 0.9),
    (0.95, 0.62, 0.35),
    (0.75, 0.1, 0.06),
)
OPACITY = 0.8
# Of a drawing that takes longer, in seconds, the next one waits until nothing changed for a while.
LONG, REST = 0.1, 0.3
# In unscaled pixels: the bar, how far from the left it is, letters, and gaps.
BAR, LEFT, LETTERS, GAP = (14, 150), 75, 12, 8
STEPS = 32

_handles: list[object] = []
_known: dict[int, _Shown] = {}


@dataclass
class Layer:
    """Triangles to draw: ``positions`` (V, 3) in object space with a ``signed`` deviation (V,).

    ``is_exact`` tells whether the positions are those that are shown.
    """

    positions: np.ndarray
    faces: np.ndarray
    signed: np.ndarray
    is_exact: bool


class _Shown:
    """What was last drawn of an object."""

    def __init__(self) -> None:
        self.moves = mix.Moves()
        self.sliders: tuple | None = None
        self.question: tuple | None = None
        self.layer: Layer | None = None
        self.changed = self.took = 0.0
        self.drawn: tuple | None = None
        self.batch: object = None

    def notice(self, mesh: bpy.types.Mesh) -> None:
        """Take note that Blender updated the mesh; if no slider has moved, it may be masks."""
        before, self.sliders = self.sliders, sliders_of(mesh)
        if before == self.sliders:
            self.moves.forget_masks()
        self.question, self.changed = None, time.monotonic()

    def read(self, obj: bpy.types.Object, graph: bpy.types.Depsgraph) -> None:
        """Work the layer out anew if something has changed, and it does not take too long now."""
        question = *question_of(obj), np.array(obj.matrix_world).tobytes()
        if question == self.question:
            return
        wait = self.changed + REST - time.monotonic()
        if self.layer is not None and self.took > LONG and wait > 0:
            if not bpy.app.timers.is_registered(redraw_views):
                bpy.app.timers.register(redraw_views, first_interval=wait)
            return
        started = time.monotonic()
        self.layer, self.drawn = layer_of(obj, graph, self.moves), None
        self.question, self.took = question, time.monotonic() - started


def start() -> None:
    """Draw in all 3D views; without a window there are none."""
    if not _handles and not bpy.app.background:
        add = bpy.types.SpaceView3D.draw_handler_add
        _handles.append(add(_draw, (), "WINDOW", "POST_VIEW"))
        _handles.append(add(_draw_legend, (), "WINDOW", "POST_PIXEL"))


def withdraw() -> None:
    """Draw no more."""
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")


def forget() -> None:
    """Let go of all that is kept, and listen no more until something is drawn."""
    _known.clear()
    listening.ignore(_handlers())
    if bpy.app.timers.is_registered(redraw_views):
        bpy.app.timers.unregister(redraw_views)


def layer_of(
    obj: bpy.types.Object, graph: bpy.types.Depsgraph, moves: mix.Moves | None = None
) -> Layer:
    """What is drawn of an object: where it is seen, or before modifiers that add vertices."""
    found = deviation.Deviation.of(obj, all_bands_shown(obj), moves)
    shown = obj.evaluated_get(graph).data
    is_exact = len(shown.vertices) == len(obj.data.vertices)
    places = coordinates(shown.vertices).reshape(-1, 3) if is_exact else mix.shown(obj)
    return Layer(places.astype(np.float32), found.faces, found.signed, is_exact)


def colors(signed: np.ndarray, most: float) -> np.ndarray:
    """RGBA (V, 4) of a signed deviation (V,); beyond ``most`` they are the strongest."""
    shares = np.clip(signed / max(most, np.finfo(float).tiny), -1, 1)
    stops = np.linspace(-1, 1, len(RAMP))
    channels = [np.interp(shares, stops, channel) for channel in zip(*RAMP, strict=True)]
    return np.column_stack([*channels, np.full(len(signed), OPACITY)]).astype(np.float32)


def hidden(context: bpy.types.Context) -> str:
    """Why nothing is seen in a view where it is turned on, for panels; nothing if it is."""
    if original.is_shown(context.active_object):
        return "The original is shown, which does not deviate"
    if context.active_object.mode != "OBJECT":
        return "The colors are seen in Object Mode"
    space = context.space_data
    is_off = space is not None and space.type == "VIEW_3D" and not space.overlay.show_overlays
    return "Overlays are off in this view" if is_off else ""


def most_of(layer: Layer, scene: bpy.types.Scene) -> float:
    """What the strongest colors stand for: what is chosen, or the largest deviation."""
    return scene.spectral_tv_deviation.range or float(np.abs(layer.signed).max(initial=0.0))


def _subject() -> bpy.types.Object | None:
    """The active object, if it is drawn in the view at hand."""
    context = bpy.context
    space, obj = context.space_data, context.active_object
    graph = context.view_layer.depsgraph
    if space is None or space.type != "VIEW_3D" or context.region_data is None or graph is None:
        return None
    if obj is None or obj.type != "MESH" or not obj.data.spectral_tv.shows_deviation:
        return None
    if hidden(context) or record_of(obj) is None or topology_changed(obj):
        return None
    return obj if is_seen(obj, space, graph) else None


def _draw() -> None:
    import gpu  # noqa: PLC0415 - it is of no use without a window
    from gpu_extras.batch import batch_for_shader  # noqa: PLC0415

    obj, context = _subject(), bpy.context
    if obj is None:
        return
    listening.listen(_handlers())
    graph = context.view_layer.depsgraph
    for other in [other for other in _known if other != obj.session_uid]:
        del _known[other]
    known = _known.setdefault(obj.session_uid, _Shown())
    known.read(obj, graph)
    most = most_of(known.layer, context.scene)
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    if known.drawn != (most,):
        content = {"pos": known.layer.positions, "color": colors(known.layer.signed, most)}
        known.batch = batch_for_shader(shader, "TRIS", content, indices=known.layer.faces)
        known.drawn = (most,)
    world = obj.evaluated_get(graph).matrix_world
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    with gpu.matrix.push_pop():
        gpu.matrix.load_matrix(lifted(obj, world, known.layer.is_exact, context) @ world)
        known.batch.draw(shader)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def _draw_legend() -> None:
    """A bar of the colors, with what its ends and its middle stand for."""
    import blf  # noqa: PLC0415 - they are of no use without a window
    import gpu  # noqa: PLC0415
    from gpu_extras.batch import batch_for_shader  # noqa: PLC0415

    obj = _subject()
    known = None if obj is None else _known.get(obj.session_uid)
    if known is None or known.layer is None:
        return
    scale = bpy.context.preferences.system.ui_scale
    width, height, left = np.multiply([*BAR, LEFT], scale)
    bottom = (bpy.context.region.height - height) / 2
    shares = np.linspace(-1, 1, STEPS)
    ends = [
        (x, bottom + (share + 1) / 2 * height) for share in shares for x in (left, left + width)
    ]
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    tints = np.repeat(colors(shares, 1.0), 2, axis=0)
    tints[:, 3] = 1
    places = np.column_stack([np.array(ends), np.zeros(len(ends))]).astype(np.float32)
    batch_for_shader(shader, "TRI_STRIP", {"pos": places, "color": tints}).draw(shader)
    most = most_of(known.layer, bpy.context.scene)
    blf.size(0, LETTERS * scale)
    blf.color(0, *bpy.context.preferences.themes[0].view_3d.space.text_hi, 1.0)
    blf.enable(0, blf.SHADOW)
    blf.shadow(0, 3, 0.0, 0.0, 0.0, 0.8)
    texts = [(f"+{lengths.told(most)}", 1), ("0", 0), (f"−{lengths.told(most)}", -1)]
    for text, share in texts:
        _, tall = blf.dimensions(0, "0")
        middle = bottom + (share + 1) / 2 * height - tall / 2
        blf.position(0, left + width + GAP * scale, middle, 0)
        blf.draw(0, text)
    blf.position(0, left, bottom + height + 2 * GAP * scale, 0)
    blf.draw(0, f"Deviation of {obj.name}")
    blf.disable(0, blf.SHADOW)


def _handlers() -> list[listening.Handler]:
    return listening.changes(_notice, _distrust)


def _notice(_scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> None:
    for update in graph.updates:
        changed = update.id.original
        for uid, known in _known.items():
            obj = bpy.context.view_layer.objects.active
            if obj is not None and obj.session_uid == uid and changed in (obj, obj.data):
                known.notice(obj.data)


def _distrust(*_arguments: object) -> None:
    for known in _known.values():
        known.moves.forget_masks()
        known.question = None
