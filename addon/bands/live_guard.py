"""The line under the sliders: how many faces the bands of all decompositions fold and stretch."""

import bpy
import spectral_tv
from spectral_tv.bands.counts import Counts
from spectral_tv.dataclass import dataclass

from ..drawing.sidebar import say
from ..job.operator import Refusing
from ..scene import listening, mix
from ..scene.objects import user_of
from ..scene.records import all_bands_shown
from . import guard
from .set_bands import bands_refusal

# Triangles that are counted again at every move of a slider; of more, when it rests; and of still
# more, when the user asks.
MOST_MOVING, MOST_LIVE = 100_000, 1_000_000
# Objects whose faces are kept in memory: those seen last.
MOST_KNOWN = 2
# Where the shape keys are what is seen.
MODES = ("OBJECT", "VERTEX_PAINT", "TEXTURE_PAINT")


@dataclass(frozen=True)
class Line:
    """What is drawn: a text and its icon. Without a text, a button that counts."""

    text: str = ""
    icon: str = "INFO"


class _Watched:
    """An object, what is known of its faces, and what was last counted."""

    def __init__(self, obj: bpy.types.Object) -> None:
        self.mesh = obj.data.session_uid
        self.reference = guard.Reference()
        self.question: tuple | None = None
        self.line: Line | None = None
        self._awaited: tuple | None = None
        self._sliders = sliders_of(obj.data)

    def is_moving(self, question: tuple) -> bool:
        """Whether the answer is to wait, as sliders move. When they rest, panels are drawn anew."""
        if question != self._awaited:
            self._awaited = question
            listening.await_rest(_redraw)
        return listening.is_awaiting(_redraw)

    def count(self, obj: bpy.types.Object, question: tuple) -> Line:
        """Count anew."""
        try:
            counts = self.reference.counts(obj, all_bands_shown(obj))
        except (spectral_tv.MeshError, MemoryError) as error:
            self.line = Line(f"Faces cannot be counted: {error}")
        else:
            self.line = line_of(counts)
        self.question = question
        return self.line

    def notice(self, mesh: bpy.types.Mesh) -> None:
        """Take note that Blender has updated the mesh.

        Masks take long to read. An update at which no slider has moved may be one of them.
        """
        before, self._sliders = self._sliders, sliders_of(mesh)
        if self._sliders == before:
            self.reference.forget_masks()
        self.question = None

    def distrust(self) -> None:
        """Read all of it again."""
        self.reference.forget_masks()
        self.question = None


# By the objects, those seen last in the end.
_watched: dict[int, _Watched] = {}


def line_of(counts: Counts) -> Line:
    """What is drawn of counts."""
    told = counts.told()
    return Line(told[0].upper() + told[1:], "ERROR" if counts else "CHECKMARK")


def line(context: bpy.types.Context) -> Line | None:
    """What is drawn of the active object, which has bands; None where they are not what is seen.

    Counts only if something that matters has changed. Raises nothing.
    """
    obj = context.active_object
    if obj.mode not in MODES or obj.data.is_editmode or not is_relative(obj.data):
        return None
    known, question = _watched.get(obj.session_uid), question_of(obj)
    if known is not None and known.question == question:
        return known.line
    if context.screen is not None and context.screen.is_animation_playing:
        return Line("Folds are counted when the animation stops")
    triangles = _triangles(obj.data)
    if triangles > MOST_LIVE:
        return Line()
    if triangles > MOST_MOVING and known is not None and known.is_moving(question):
        return Line("Folds are counted when the sliders rest")
    return count(obj)


def count(obj: bpy.types.Object) -> Line:
    """Count now, and remember it."""
    listening.listen(_handlers())
    known = _watched.pop(obj.session_uid, None)
    if known is None or known.mesh != obj.data.session_uid:
        known = _Watched(obj)
    _watched[obj.session_uid] = known
    while len(_watched) > MOST_KNOWN:
        del _watched[next(iter(_watched))]
    return known.count(obj, question_of(obj))


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the line."""
    found = line(context)
    if found is not None and found.text:
        say(layout, context, found.text, found.icon)
    elif found is not None:
        layout.operator(SPECTRAL_TV_OT_count_folds.bl_idname, icon="VIEWZOOM")


class SPECTRAL_TV_OT_count_folds(Refusing, bpy.types.Operator):
    """Tell how many faces the bands fold and stretch at their present values"""

    bl_idname = "spectral_tv.count_folds"
    bl_label = "Count Folds"
    bl_options = {"REGISTER"}

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return bands_refusal(context.active_object)

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.active_object
        _watched.pop(obj.session_uid, None)  # what was read may be out of date in scripts
        return self.tell(obj, count(obj).text, [])


def forget() -> None:
    """Let go of all that is kept, and listen no more."""
    _watched.clear()
    listening.ignore(_handlers())
    listening.stop_awaiting(_redraw)


def _handlers() -> list[listening.Handler]:
    return listening.changes(_notice, _distrust)


def _notice(_scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> None:
    for update in graph.updates:
        mesh = update.id.original
        if isinstance(mesh, bpy.types.Mesh):
            for each in _watched.values():
                if each.mesh == mesh.session_uid:
                    each.notice(mesh)


def _redraw() -> None:
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _distrust(*_arguments: object) -> None:
    for each in _watched.values():
        each.distrust()


def _triangles(mesh: bpy.types.Mesh) -> int:
    return len(mesh.loops) - 2 * len(mesh.polygons)


def is_relative(mesh: bpy.types.Mesh) -> bool:
    """Whether a mesh has no absolute shape keys."""
    return mesh.shape_keys is None or mesh.shape_keys.use_relative


def sliders_of(mesh: bpy.types.Mesh) -> tuple:
    """What is changed by turning a slider of the panel, or by pressing something beside it."""
    obj = user_of(mesh)
    found = [] if obj is None else mix.sliders_of(obj)
    keys = tuple((key.name, key.value, key.mute) for key in found)
    return tuple(record.settings for record in mesh.spectral_tv.decompositions), keys


def question_of(obj: bpy.types.Object) -> tuple:
    """All that the answer depends on, but for what Blender tells of by an update."""
    matrix = guard.distortion(obj)
    return (
        obj.data.session_uid,
        None if matrix is None else matrix.tobytes(),
        sliders_of(obj.data),
        tuple(key.name for key in all_bands_shown(obj)),
        tuple(key.vertex_group for key in mix.sliders_of(obj)),
        obj.show_only_shape_key and obj.active_shape_key_index,
    )
