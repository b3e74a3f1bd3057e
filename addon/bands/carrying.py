"""What is bound to a body, and follows its bands by shape keys of its own."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import spectral_tv
from spectral_tv.later import np
from spectral_tv.notes import about, note
from spectral_tv.refusal import Refusal

from ..scene import masks, mix, results
from ..scene.channels import drivers_of
from ..scene.keeping import Band, place_of
from ..scene.objects import refusal
from ..scene.places import linear_of
from ..scene.records import all_bands_of
from ..scene.results import Piece
from ..scene.surface import NOWHERE, Surface

# What the keys are results of: bands of the body by its name.
KIND = "CARRIED"
# What is the value of a key: that of the band, unless this is muted.
EXPRESSION = "gain * (1 - muted)"


def carried_along(body: bpy.types.Object, others: list[bpy.types.Object]) -> str:
    """Have objects follow the bands of a body; returns what was done.

    Raises Refusal if the body has no bands, or one of the objects cannot have shape keys.
    """
    bands = all_bands_of(body)
    if not bands:
        raise Refusal("all its bands were deleted")
    for obj in others:
        reason = refusal(obj)
        if reason is not None:
            raise Refusal(f"{obj.name}: {reason}")
        if obj.data == body.data:
            raise Refusal(f"{obj.name} shares its mesh, and has the bands already")
    surface = Surface.read(body, mix.shown(body, bands))
    moves = np.array([surface.merge_vectors(_moved(body, band)) for band in bands])
    found = [(obj, _carried(surface, moves, body, obj)) for obj in others]
    for obj, (carried, matrix, is_there) in found:
        with about(obj.name):
            _tell(carried)
            _write(body, bands, obj, carried.displacements @ np.linalg.inv(matrix).T, is_there)
    names = ", ".join(obj.name for obj in others)
    verb = "follows" if len(others) == 1 else "follow"
    return f"{names} {verb} its {len(bands)} bands"


def _moved(body: bpy.types.Object, band: Band) -> np.ndarray:
    """By what a band moves the body at a gain of 1, (V, 3) in object space."""
    return masks.mask(body, band)[:, np.newaxis] * place_of(band).displacement(band)


def _carried(
    surface: Surface, moves: np.ndarray, body: bpy.types.Object, obj: bpy.types.Object
) -> tuple[spectral_tv.Carried, np.ndarray, np.ndarray]:
    """What the bands do to an object; its matrix; and which of its vertices have a place."""
    matrix = linear_of(obj.matrix_world, obj.name)
    shift = np.array(obj.matrix_world.translation - body.matrix_world.translation)
    shape = mix.shown(obj, [key for _, key, _ in results.keys_written(obj, KIND)])
    is_there = (np.abs(shape) < NOWHERE).all(axis=1)
    points = shape[is_there] @ matrix.T + shift
    return spectral_tv.carry(surface.mesh, moves, points), matrix, is_there


def _write(
    body: bpy.types.Object,
    bands: list[Band],
    obj: bpy.types.Object,
    moved: np.ndarray,
    is_there: np.ndarray,
) -> None:
    """Give an object a shape key for every band, (K, N, 3), driven by it."""
    pieces = {}
    for band, step in zip(bands, moved, strict=True):
        whole = np.zeros((len(is_there), 3))
        whole[is_there] = step
        pieces[band.name] = Piece("KEY", whole)
    _follow_name(body, obj)
    results.mute_kept(obj, KIND, body.name)
    names = results.write(
        obj, KIND, body.name, pieces, lambda _: True, lambda _source, label: (label, "")
    )
    keys = obj.data.shape_keys.key_blocks
    for name, band in zip(names, bands, strict=True):
        key = keys[name]
        key.slider_min, key.slider_max = band.slider_min, band.slider_max
        _drive(key, body, band)


def settle(body: bpy.types.Object, bands: Sequence[Band]) -> list[str]:
    """Have what follows bands of a body stay as these have it now, as they will be no more; returns
    its names. The keys are the user's from then on."""
    values = {
        (place_of(band).block(body), place_of(band).path(band, "value")): band for band in bands
    }
    found = []
    for obj in [each for each in bpy.data.objects if each.type == "MESH" and not each.data.library]:
        spent = []
        for each, key, _ in results.keys_written(obj, KIND):
            for band in [values[target] for target in _read_by(key) if target in values]:
                key.driver_remove("value")
                key.value = 0.0 if band.mute else band.value
                spent.append(each)
        results.release(obj, spent)
        found += [obj.name] if spent else []
    return found


def _follow_name(body: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Have the keys of an object that follow a body be results of it by its name today."""
    for each, key, _ in results.keys_written(obj, KIND):
        if any(block in (body, body.data.shape_keys) for block, _ in _read_by(key)):
            each.source = body.name


def _read_by(key: bpy.types.ShapeKey) -> list[tuple[bpy.types.ID | None, str]]:
    """The data-blocks and paths that the driver of a key reads."""
    path = key.path_from_id("value")
    return [
        (target.id, target.data_path)
        for driver in drivers_of(key.id_data)
        if driver.data_path == path
        for variable in driver.driver.variables
        for target in variable.targets
    ]


def _drive(key: bpy.types.ShapeKey, body: bpy.types.Object, band: Band) -> None:
    """Have a key have the value of a band, and 0 while that is muted."""
    key.driver_remove("value")
    driver = key.driver_add("value").driver
    place = place_of(band)
    block = place.block(body)
    for name, field in (("gain", "value"), ("muted", "mute")):
        variable = driver.variables.new()
        variable.name = name
        target = variable.targets[0]
        target.id_type = block.id_type
        target.id, target.data_path = block, place.path(band, field)
    driver.type, driver.expression = "SCRIPTED", EXPRESSION


def _tell(carried: spectral_tv.Carried) -> None:
    """Note what was changed to keep vertices outside, and where it did not do."""
    pushed, inside, below = (
        np.count_nonzero(each) for each in (carried.pushed, carried.inside, carried.inside_below)
    )
    if pushed:
        note(f"{pushed} vertices are pushed out, which would have gone inside at gains up to 1")
    if inside:
        note(f"{inside} vertices that were outside go inside all the same at gains up to 1")
    if below:
        note(f"{below} vertices that were outside go inside at gains of −1")
