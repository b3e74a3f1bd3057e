"""The filter curve sets the bands of the active object while it is drawn."""

import bpy

from ..scene.mix import sliders_of
from ..scene.records import record_of, renew_bands
from . import filter_curve, remarks, whole_change
from .set_bands import apply_curve, bands_refusal

# Seconds without a change after which a step of undo is made, and what it is called.
REST = 0.2
STEP = "Filter Curve"
# Whose subscriptions they are.
_OWNER = object()


def start() -> None:
    """Begin to watch; loading a file ends it."""
    bpy.msgbus.clear_by_owner(_OWNER)
    bpy.msgbus.subscribe_rna(
        key=(bpy.types.ShaderNodeFloatCurve, "mapping"),
        owner=_OWNER,
        args=(),
        notify=_follow,
    )


def stop() -> None:
    """Watch no more."""
    bpy.msgbus.clear_by_owner(_OWNER)


def forget() -> None:
    """Make no step of undo for what was followed last."""
    if bpy.app.timers.is_registered(make_step):
        bpy.app.timers.unregister(make_step)


def make_step() -> None:
    """Make a step of undo for bands that followed the curve: the curve has one without them."""
    node, obj = filter_curve.find(), bpy.context.view_layer.objects.active
    if node is None or record_of(obj) is None:
        return
    points, before, name = _points(node), _Watch.before, obj.name

    def is_first() -> bool:
        """Whether the curve is this one, and the bands are as they were."""
        node, obj = filter_curve.find(), bpy.data.objects.get(name)
        is_there = node is not None and record_of(obj) is not None
        return is_there and _points(node) == points and state(obj) == before

    whole_change.make_step(bpy.context.scene, STEP, is_first)


def state(obj: bpy.types.Object) -> tuple:
    """What a remark on the curve is about."""
    return record_of(obj).identifier, tuple((key.name, key.value) for key in sliders_of(obj))


def look(node: bpy.types.Node) -> None:
    """Take note of the curve as it is drawn, so that it is known when it becomes another one."""
    _Watch.seen = _points(node)


class _Watch:
    """The points that the curve had when it was last looked at."""

    seen: list[tuple] | None = None
    # The state of the bands before they followed.
    before: tuple = ()


def _points(node: bpy.types.Node) -> list[tuple]:
    points = node.mapping.curves[0].points
    return [(*point.location, point.handle_type) for point in points]


def _follow() -> None:
    """A curve was changed by hand, this one or that of a material."""
    obj, node = bpy.context.view_layer.objects.active, filter_curve.find()
    if node is None or _Watch.seen in (None, _points(node)):
        return
    look(node)
    if bands_refusal(obj, values_alone=True) is None:
        renew_bands(obj)
        if not bpy.app.timers.is_registered(make_step):
            _Watch.before = state(obj)
        with remarks.remarked(obj.data, "curve", lambda: state(obj)):
            apply_curve(obj)
        if not bpy.app.background:
            forget()
            bpy.app.timers.register(make_step, first_interval=REST)
