"""F-curves as plain values: read, and made again."""

from collections.abc import Sequence
from dataclasses import replace

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

# Keyframes nearer than this are one, in frames; Blender takes them for one too.
TOGETHER = 0.01
# Handles that Blender places itself, by rules that sums do not follow.
PLACED = ("AUTO", "AUTO_CLAMPED")


@dataclass(frozen=True)
class Point:
    """A keyframe, and how it goes on from there; places are (frame, value)."""

    co: tuple[float, float]
    left: tuple[float, float]
    right: tuple[float, float]
    left_type: str = "FREE"
    right_type: str = "FREE"
    interpolation: str = "BEZIER"
    easing: str = "AUTO"
    amplitude: float = 0.0
    back: float = 0.0
    period: float = 0.0
    type: str = "KEYFRAME"

    @classmethod
    def of(cls, point: bpy.types.Keyframe) -> "Point":
        """Read a keyframe."""
        return cls(
            tuple(point.co), tuple(point.handle_left), tuple(point.handle_right),
            point.handle_left_type, point.handle_right_type,
            point.interpolation, point.easing, point.amplitude, point.back, point.period,
            point.type,
        )  # fmt: skip

    @property
    def kinds(self) -> tuple[object, ...]:
        """What two keyframes have to share for their sum to be one of the same kind."""
        handles = self.left[0] - self.co[0], self.right[0] - self.co[0]
        return (
            self.interpolation, self.easing, self.amplitude, self.back, self.period,
            self.left_type, self.right_type, *(np.round(handles, 3).tolist()),
            round(self.co[0] / TOGETHER),
        )  # fmt: skip

    def mapped(self, scale: float, offset: float) -> "Point":
        """The keyframe with its values scaled and then shifted."""
        co, left, right = (
            (frame, scale * value + offset) for frame, value in (self.co, self.left, self.right)
        )
        # Elastic interpolation overshoots by a value.
        return replace(self, co=co, left=left, right=right, amplitude=scale * self.amplitude)

    def plus(self, other: "Point") -> "Point":
        """The sum of two keyframes of the same kind."""
        co, left, right = (
            (one[0], one[1] + two[1])
            for one, two in (
                (self.co, other.co),
                (self.left, other.left),
                (self.right, other.right),
            )
        )
        types = [
            "ALIGNED" if kind in PLACED else kind for kind in (self.left_type, self.right_type)
        ]
        return replace(self, co=co, left=left, right=right, left_type=types[0], right_type=types[1])


def add_curve(
    curves: bpy.types.bpy_prop_collection,
    path: str,
    points: Sequence[Point],
    like: bpy.types.FCurve,
    keeps_group: bool = True,
) -> bpy.types.FCurve:
    """Add a curve of these keyframes that is shown, extrapolated and modified like another. It is
    in the same channel group, unless it is of another action."""
    curve = curves.new(path, index=like.array_index)
    curve.keyframe_points.add(len(points))
    for made, point in zip(curve.keyframe_points, points, strict=True):
        made.co = point.co
        made.handle_left_type, made.handle_right_type = point.left_type, point.right_type
        made.handle_left, made.handle_right = point.left, point.right
        for name in ("interpolation", "easing", "amplitude", "back", "period", "type"):
            setattr(made, name, getattr(point, name))
    for name in ("extrapolation", "color_mode", "color", "mute", "hide", "lock", "auto_smoothing"):
        setattr(curve, name, getattr(like, name))
    if keeps_group and like.group is not None:
        curve.group = like.group
    for modifier in like.modifiers:
        _copy_modifier(modifier, curve.modifiers.new(modifier.type))
    curve.update()
    return curve


def make_keyframes(curve: bpy.types.FCurve) -> None:
    """Turn the samples of a baked curve into keyframes."""
    if len(curve.sampled_points) and not len(curve.keyframe_points):
        first, last = curve.range()
        curve.convert_to_keyframes(int(first), int(last) + 1)


def same_modifiers(curves: Sequence[bpy.types.FCurve]) -> bool:
    """Whether curves are modified in the same way."""
    return len({tuple(map(_modifier_values, curve.modifiers)) for curve in curves}) < 2


def _copy_modifier(source: bpy.types.FModifier, target: bpy.types.FModifier) -> None:
    for name, value in _modifier_values(source):
        setattr(target, name, value)


def _modifier_values(modifier: bpy.types.FModifier) -> tuple[tuple[str, object], ...]:
    found = []
    for declared in modifier.bl_rna.properties:
        name = declared.identifier
        if not declared.is_readonly and declared.type not in ("POINTER", "COLLECTION"):
            value = getattr(modifier, name)
            found.append((name, tuple(value) if getattr(declared, "is_array", False) else value))
    return tuple(found)
