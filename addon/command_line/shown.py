"""Preparing meshes for an exporter so that the file shows what the screen shows.

Exporters that store shape keys ignore masks, muted keys and keys relative to others. They also
ignore either the keys or the modifiers. While they write, objects hold copies of their meshes whose
keys have all of that in their shapes. Afterwards objects hold their own meshes again.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, suppress

import bpy
import numpy as np
from spectral_tv.dataclass import dataclass
from spectral_tv.notes import listed, note

from ..scene.animation import curves_of
from ..scene.applied import mesh_of
from ..scene.coordinates import seen_coordinates
from ..scene.shape_keys import SLIDER_RANGE
from ..scene.temporary import Temporary
from .contents import armatures, own_properties
from .copies import Dress, held, off, unhooked

# So far, relative to the object's size, may keys that went through modifiers be off together.
LINEAR = 1e-5
# Below this a difference is rounding.
ROUNDING = 1e-6

Kept = Callable[[bpy.types.Object, bpy.types.ShapeKey], bool]


@dataclass(frozen=True)
class Shape:
    """What is seen of an object: its shape at all keys 0, (V, 3), and its keys' displacements."""

    base: np.ndarray
    moves: dict[str, np.ndarray]
    values: dict[str, float]


@contextmanager
def shown(
    objects: Sequence[bpy.types.Object],
    kept: Kept,
    rigs: Collection[bpy.types.Object],
    dress: Dress | None,
) -> Iterator[None]:
    """Have mesh objects hold copies of their meshes whose keys alone give what is seen.

    ``kept`` tells which keys stay keys, the others become part of the shape. Modifiers but those of
    the armatures ``rigs`` are applied, and off meanwhile. ``dress`` makes the other changes to the
    copies that the format asks for.
    """
    rigged = {item for obj in objects for item in armatures(obj) if item.object in rigs}
    posed = [obj.name for obj in objects if any(item not in rigged for item in armatures(obj))]
    if posed:
        note(f"posed for good, as their armatures are not in the file: {listed(posed)}")
    applied = [item for obj in objects for item in obj.modifiers if item not in rigged]
    copies: dict[tuple, bpy.types.Mesh] = {}
    try:
        with off(rigged):
            bpy.context.view_layer.update()
            laid_out = {obj: _copy(obj, kept, copies) for obj in objects}
        for copy in copies.values() if dress is not None else ():
            dress(copy)
    except BaseException:
        bpy.data.batch_remove(list(copies.values()))
        raise
    _tell_instances(objects)
    with off(applied), unhooked(applied), held(laid_out):
        yield


def _tell_instances(objects: Sequence[bpy.types.Object]) -> None:
    """Note which objects show others by their modifiers, which are in no mesh."""
    graph = bpy.context.evaluated_depsgraph_get()
    parents = {
        item.parent.original.name
        for item in graph.object_instances
        if item.is_instance and item.parent is not None
    }
    if shown := [obj.name for obj in objects if obj.name in parents and len(obj.modifiers)]:
        note(f"left out: instances that {listed(shown)} shows; realize them to keep them")


def _copy(obj: bpy.types.Object, kept: Kept, copies: dict[tuple, bpy.types.Mesh]) -> bpy.types.Mesh:
    """A copy of the mesh of ``obj`` as it is seen, its keys those that are kept."""
    has_modifiers = any(item.show_viewport for item in obj.modifiers)
    place: tuple = (obj.data.session_uid,)
    if has_modifiers or obj.show_only_shape_key:  # seen of this object alone
        place += (obj.name,)
    if place in copies:
        return copies[place]
    copy = copies[place] = mesh_of(obj)
    for name in own_properties(obj.data):  # the extension's own are in no other file
        with suppress(TypeError):
            copy[name] = obj.data[name]
    shape = _shape(obj, kept, has_modifiers)
    if shape is not None and shape.moves:
        _write(copy, shape)
        _animate(copy, obj, shape)
    return copy


def _shape(obj: bpy.types.Object, kept: Kept, has_modifiers: bool) -> Shape | None:
    """The keys of an object as they are seen; None if it has none, or none that can be kept."""
    keys = obj.data.shape_keys
    if keys is None or not keys.use_relative:
        return None
    graph = bpy.context.evaluated_depsgraph_get()
    seen = seen_coordinates(obj)
    values = _values(obj, graph)
    wanted = [key.name for key in keys.key_blocks[1:] if kept(obj, key)]
    _tell(obj, wanted)
    base, moves = _moves(obj, wanted, values)
    size = float(np.linalg.norm(np.ptp(seen, axis=0))) if len(seen) else 0.0
    if all(shape.shape == seen.shape for shape in (base, *moves.values())):
        apart = seen - base - sum(values[name] * move for name, move in moves.items())
        error = float(np.abs(apart).max(initial=0.0))
        if not has_modifiers or error <= LINEAR * size:
            base = base + apart if error > ROUNDING * size else base
            return Shape(base, moves, {name: values[name] for name in wanted})
    if wanted:
        note(
            f"{obj.name}: its shape keys became part of the shape, as its modifiers do not let "
            "each of them through by itself"
        )
    return None


def _tell(obj: bpy.types.Object, wanted: Sequence[str]) -> None:
    """Note which keys are in the file in another way than by their values."""
    keys = [obj.data.shape_keys.key_blocks[name] for name in wanted]
    if obj.show_only_shape_key and wanted:
        pinned = obj.active_shape_key.name
        note(f"{obj.name}: {pinned} is shown alone, so the other shape keys are 0 in the file")
    elif muted := [key.name for key in keys if key.mute]:
        note(f"{obj.name}: muted shape keys are 0 in the file: {listed(muted)}")


def _values(obj: bpy.types.Object, graph: bpy.types.Depsgraph) -> dict[str, float]:
    """The values by which the keys of an object are seen: muted ones are at 0."""
    keys = obj.data.shape_keys
    if obj.show_only_shape_key:
        pinned = obj.active_shape_key_index
        return {key.name: float(i == pinned) for i, key in enumerate(keys.key_blocks)}
    return {
        key.name: 0.0 if key.mute else key.value for key in keys.evaluated_get(graph).key_blocks
    }


def _moves(
    obj: bpy.types.Object, wanted: Sequence[str], values: dict[str, float]
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """The shape with some keys at 0, and how far each of them at 1 moves it, as Blender sees it."""
    with Temporary() as now:
        mesh, probe = now.made(obj.data.copy()), now.made(obj.copy())
        probe.data, keys = mesh, mesh.shape_keys
        keys.animation_data_clear()
        probe.show_only_shape_key = False
        bpy.context.scene.collection.objects.link(probe)
        for key in keys.key_blocks[1:]:
            key.slider_min, key.slider_max = SLIDER_RANGE
            key.mute = False
            key.value = 0.0 if key.name in wanted else values[key.name]
        base = seen_coordinates(probe)
        moves = {}
        for name in wanted:
            keys.key_blocks[name].value = 1.0
            moved = seen_coordinates(probe)
            moves[name] = moved - base if moved.shape == base.shape else moved
            keys.key_blocks[name].value = 0.0
    return base, moves


def _write(mesh: bpy.types.Mesh, shape: Shape) -> None:
    """Give a mesh without keys these, and nothing that the extension keeps."""
    mesh.vertices.foreach_set("co", shape.base.astype(np.float32).ravel())
    with Temporary() as now:
        helper = now.made(bpy.data.objects.new("Helper", mesh))
        helper.shape_key_add(name="Basis", from_mix=False)
        for name, move in shape.moves.items():
            key = helper.shape_key_add(name=name, from_mix=False)
            key.slider_min, key.slider_max = SLIDER_RANGE
            key.value = shape.values[name]
            key.points.foreach_set("co", (shape.base + move).astype(np.float32).ravel())


def _animate(mesh: bpy.types.Mesh, obj: bpy.types.Object, shape: Shape) -> None:
    """Have the keys of a copy move as those of ``obj`` do, as far as that is seen."""
    source = obj.data.shape_keys
    mesh.shape_keys.key_blocks[0].name = source.reference_key.name
    animation = source.animation_data
    if animation is None or obj.show_only_shape_key:
        return
    own = mesh.shape_keys.animation_data_create()
    still = {key.path_from_id("value") for key in source.key_blocks if key.mute}
    _play(own, animation, animation.action)
    if any(curve.data_path in still for curve in curves_of(source) or ()):
        _play(own, animation, animation.action.copy())
        curves = curves_of(mesh.shape_keys)
        for path in still:
            if (curve := curves.find(path)) is not None:
                curves.remove(curve)
    for driver in animation.drivers:
        if driver.data_path not in still:
            own.drivers.from_existing(src_driver=driver)


def _play(
    own: bpy.types.AnimData, other: bpy.types.AnimData, action: bpy.types.Action | None
) -> None:
    """Have an action, or a copy of it, be played like ``other`` does."""
    own.action = action
    slot = getattr(other, "action_slot", None)
    if action is not None and slot is not None:
        own.action_slot = next(item for item in action.slots if item.identifier == slot.identifier)
