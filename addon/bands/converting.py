"""Bands of one kind turned into the other: shape keys into attributes, and back.

Values, mutes, masks, names, keyframes and drivers go over, and drivers that read the bands follow.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import bpy
from spectral_tv.later import np
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..scene import masks, mix
from ..scene.attribute_band import AttributeBand
from ..scene.channels import Animated, actions_of, drivers_of, drop_empty_action
from ..scene.coordinates import basis_coordinates
from ..scene.decomposition import SpectralTVRecord
from ..scene.drivers import retarget_paths
from ..scene.fcurves import Point, add_curve, make_keyframes
from ..scene.fingerprints import Likeness
from ..scene.keeping import PLACES, Band, ShapeKeys, place_of
from ..scene.records import keep_in, keeping_of, recognise_bands
from ..scene.whole import whole
from .bands import settings_of

# What can be animated of bands of either kind.
SHARED = ("value", "mute")
# A Basis of this name goes along with the last key, and is made anew with the next.
BASIS = "Basis"


def conversion_refusal(obj: bpy.types.Object, record: SpectralTVRecord, kind: str) -> str | None:
    """Why bands cannot become those of another kind, in a sentence; None if they can."""
    source, target = keeping_of(record), PLACES[kind]
    if source == target:
        return f"The bands of {record.name} are {target.label} already"
    reason = source.refusal(obj) or target.refusal(obj)
    if reason is not None:
        return reason
    if obj.data.is_editmode or obj.mode not in ("OBJECT", "SCULPT"):
        return "Go to Object Mode first"
    return None


def convert(obj: bpy.types.Object, record: SpectralTVRecord, kind: str) -> list[Band]:
    """Turn the bands of a decomposition into those of another kind; returns these.

    Raises Refusal if that cannot be done; then nothing was changed.
    """
    reason = conversion_refusal(obj, record, kind)
    if reason is not None:
        raise Refusal(reason[0].lower() + reason[1:])
    source, target = keeping_of(record), PLACES[kind]
    likes, there = recognise_bands(obj, record), source.all(obj)
    old = [there[name] for name, _ in likes if name]
    if not old:
        raise Refusal(f"the bands of {record.name!r} were deleted")
    _check_animation(obj, old)
    places = [source.displacement(band) for band in old]
    with whole(obj):
        new = target.add(obj, [band.name for band in old], places)
        pairs = [*zip(old, new, strict=True)]
        _carry_curves(obj, pairs)
    for one, other in pairs:
        if one.name != other.name:
            note(f"{one.name!r} is {other.name!r} now, as something else has its name")
        _carry_settings(obj, one, other)
    _carry_drivers(obj, pairs)
    _lead_readers(obj, pairs)
    by_name = {one.name: other for one, other in pairs}
    names = {name: other.name for name, other in by_name.items()}
    is_animated = any(True for _ in _of(_curves(source.block(obj)), old))
    source.remove(obj, old)
    if is_animated:
        drop_empty_action(source.block(obj))
    _drop_basis(obj)
    for band, (name, likeness) in zip(record.bands, likes, strict=True):
        if name:
            band.given = names[name] if band.given == name else band.given
            band.key, band.digest = names[name], ""
            if likeness == Likeness.SAME:
                band.take(obj, target.written, names[name])
    keep_in(obj, record, kind)
    record.settings = _with_kind(record, kind)
    masks.fit_names(obj, [*by_name.values()])
    obj.data.update_tag()
    return new


def _with_kind(record: SpectralTVRecord, kind: str) -> str:
    """The settings of a record with another kind of bands; those of 0.1.0 are none."""
    return replace(settings_of(record), bands_as=kind).text() if record.settings else ""


def _curves(block: bpy.types.ID) -> Sequence[bpy.types.FCurve]:
    """Those of the action that a data-block plays."""
    animation = block.animation_data
    if animation is None or animation.action is None:
        return ()
    return Animated(animation, animation.action).curves or ()


def _check_animation(obj: bpy.types.Object, old: Sequence[Band]) -> None:
    """Raise Refusal where animation of bands would be lost."""
    for animated in actions_of(place_of(old[0]).block(obj)):
        moved = any(True for _ in _of(animated.curves or (), old))
        if moved and isinstance(animated.user, bpy.types.NlaStrip):
            raise Refusal("strips of the NLA Editor animate its bands, which cannot go over")


def _of(
    curves: Sequence[bpy.types.FCurve], bands: Sequence[Band]
) -> Iterator[tuple[bpy.types.FCurve, Band, str]]:
    """The curves that are of bands, each with its band and the property."""
    for curve in [*curves]:
        for band in bands:
            name = place_of(band).property_of(band, curve.data_path)
            if name:
                yield curve, band, name


def _carry_settings(obj: bpy.types.Object, one: Band, other: Band) -> None:
    other.slider_min, other.slider_max = one.slider_min, one.slider_max
    other.value, other.mute, other.lock_shape = one.value, one.mute, one.lock_shape
    if masks.mask_group(obj, one) is not None:
        other.vertex_group = one.vertex_group
        return
    if isinstance(one, AttributeBand):
        weights = one.weights()
        if weights.min(initial=1.0) < 1:
            group = masks.give(obj, other, weights)
            note(f"the mask of {one.name!r} is the vertex group {group.name!r} now")
    elif one.vertex_group:
        note(f"{one.name!r} acts everywhere, as its mask {one.vertex_group!r} is missing")


def _carry_curves(obj: bpy.types.Object, pairs: Sequence[tuple[Band, Band]]) -> None:
    """Have new bands play what the old ones do."""
    old, heirs = [one for one, _ in pairs], dict(pairs)
    lost = set()
    for curve, band, name in _of(_curves(place_of(old[0]).block(obj)), old):
        if name not in SHARED:
            lost.add(band.name)
            continue
        make_keyframes(curve)
        points = [Point.of(point) for point in curve.keyframe_points]
        curves, path = _curves_for(obj, heirs[band], name)
        add_curve(curves, path, points, curve, keeps_group=False)
    if lost:
        note(f"only values and mutes stay animated, not what else is of {listed(sorted(lost))}")


def _curves_for(
    obj: bpy.types.Object, band: Band, name: str
) -> tuple[bpy.types.bpy_prop_collection, str]:
    """The curves of an action that a band plays, and the path of a property, of which none is."""
    place = place_of(band)
    animation, path = place.block(obj).animation_data, place.path(band, name)
    if animation is not None and animation.action is not None:
        played = Animated(animation, animation.action)
        if played.is_shared:
            note(f"{played.action.name!r} animates others too; {obj.name!r} has a copy now")
            played.with_own_action()
    if not place.keyframe(band, name, 0):  # which makes an action, and room in it
        raise Refusal("its animation is linked from another file, or locked")
    animation = place.block(obj).animation_data
    curves = Animated(animation, animation.action).curves
    curves.remove(curves.find(path))
    return curves, path


def _carry_drivers(obj: bpy.types.Object, pairs: Sequence[tuple[Band, Band]]) -> None:
    old, heirs = [one for one, _ in pairs], dict(pairs)
    lost, selfish = set(), set()
    for driver, band, name in _of(drivers_of(place_of(old[0]).block(obj)), old):
        if name not in SHARED:
            lost.add(band.name)
            continue
        place = place_of(heirs[band])
        block = place.block(obj)
        copy = (block.animation_data or block.animation_data_create()).drivers.from_existing(
            src_driver=driver
        )
        copy.data_path = place.path(heirs[band], name)
        if driver.driver.use_self:
            selfish.add(band.name)
    if lost:
        note(f"only values and mutes stay driven, not what else is of {listed(sorted(lost))}")
    if selfish:
        note(f"drivers of {listed(sorted(selfish))} read self, which is another thing now")


def _lead_readers(obj: bpy.types.Object, pairs: Sequence[tuple[Band, Band]]) -> None:
    """Have drivers that read old bands read the new ones."""
    source, target = place_of(pairs[0][0]), place_of(pairs[0][1])
    renamed = {
        source.path(one, name): target.path(other, name) for one, other in pairs for name in SHARED
    }
    block, other = source.block(obj), target.block(obj)
    id_type = "KEY" if target == ShapeKeys else "OBJECT"
    retarget_paths(block, renamed, other, id_type)
    if source == ShapeKeys:  # which drivers read by way of the mesh and the object too
        for owner, start in ((obj.data, "shape_keys."), (obj, "data.shape_keys.")):
            longer = {f"{start}{path}": found for path, found in renamed.items()}
            retarget_paths(owner, longer, other, id_type)


def _drop_basis(obj: bpy.types.Object) -> None:
    """Remove a Basis that is left alone, as Blender does more with a mesh without shape keys."""
    keys = mix.keys_of(obj.data)
    if len(keys) == 1 and obj.data.shape_keys.reference_key.name == BASIS:
        basis = basis_coordinates(obj.data).astype(np.float32)
        obj.shape_key_clear()
        obj.data.vertices.foreach_set("co", basis.ravel())
