"""The filter curve sets the bands of the active object while it is drawn."""

import bpy

from ..scene.records import record_of, renew_bands
from . import filter_curve, remarks
from .set_bands import apply_curve, bands_refusal

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


def state(obj: bpy.types.Object) -> tuple:
    """What a remark on the curve is about."""
    record = record_of(obj)
    keys = obj.data.shape_keys.key_blocks
    return record.identifier, tuple((key.name, key.value) for key in keys)


def look(node: bpy.types.Node) -> None:
    """Take note of the curve as it is drawn, so that it is known when it becomes another one."""
    _Watch.seen = _points(node)


class _Watch:
    """The points that the curve had when it was last looked at."""

    seen: list[tuple] | None = None


def _points(node: bpy.types.Node) -> list[tuple]:
    points = node.mapping.curves[0].points
    return [(*point.location, point.handle_type) for point in points]


def _follow() -> None:
    """A curve was changed by hand, this one or that of a material."""
    obj, node = bpy.context.view_layer.objects.active, filter_curve.find()
    if node is None or _Watch.seen in (None, _points(node)):
        return
    look(node)
    if bands_refusal(obj) is None:
        renew_bands(obj)
        with remarks.remarked(obj.data, "curve", lambda: state(obj)):
            apply_curve(obj)
