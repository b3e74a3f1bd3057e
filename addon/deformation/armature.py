"""The armature of a rig: written beside an object, whose mesh it then moves.

It remembers what was written. One that is as it was written may be replaced. One that the user
posed, edited, animated or gave to other objects is the user's.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from spectral_tv.later import np
from spectral_tv.notes import note

from ..scene.attribute_band import has_bands
from ..scene.contents import digest
from ..scene.names import free_name, taken_names
from ..scene.temporary import Temporary
from ..scene.weights import add_group, members
from .bones import Bone, placed
from .constraints import deformation_of

# Where a parent moves an object by its matrix alone, which an armature between them passes on.
PASSED_ON = ("OBJECT", "BONE")
# Of a matrix, what rounding makes of it.
SAME = 1e-4


def former(obj: bpy.types.Object) -> list[bpy.types.ArmatureModifier]:
    """The modifiers of ``obj`` with armatures that were written for it, changed since or not."""
    return [
        modifier
        for modifier in obj.modifiers
        if modifier.type == "ARMATURE"
        and modifier.object is not None
        and deformation_of(modifier.object).rig
    ]


def write(obj: bpy.types.Object, bones: Sequence[Bone]) -> bpy.types.Object:
    """Write an armature with ``bones``, have it move ``obj``, and pose it as they say.

    What was written before is replaced, or kept and switched off, if it is the user's now.
    """
    before = former(obj)
    own = [each for each in before if _is_untouched(obj, each.object)]
    taken = taken_names(obj, "GROUP") - {bone for each in own for bone in _bones(each.object)}
    names: list[str] = []
    for number in range(1, len(bones) + 1):
        names.append(free_name(f"Bone {number}", "", taken | {*names}))
    armature = bpy.data.objects.new(f"{obj.name} Rig", bpy.data.armatures.new(f"{obj.name} Rig"))
    try:
        _add_bones(armature, bones, names)
    except BaseException:
        _remove(armature)
        raise
    _link(armature, obj)
    _adopt(obj, armature, [each.object for each in before])
    for modifier in before:
        if modifier in own:
            _replace(obj, modifier, armature)
        else:
            _switch_off(modifier)
    for name, bone in zip(names, bones, strict=True):
        _add_group(obj, name, bone.weights)
    _add_modifier(obj, armature)
    for name, bone in zip(names, bones, strict=True):
        rest = armature.data.bones[name].matrix_local
        armature.pose.bones[name].matrix_basis = rest.inverted() @ bone.relative(bones) @ rest
    bpy.context.view_layer.update()
    deformation_of(armature).rig = _digest(obj, armature)
    return armature


def _bones(armature: bpy.types.Object) -> list[str]:
    return armature.data.bones.keys()


def _is_untouched(obj: bpy.types.Object, armature: bpy.types.Object) -> bool:
    """Whether an armature is as it was written, and moves ``obj`` alone."""
    if deformation_of(armature).rig != _digest(obj, armature):
        return False
    others = [each for each in bpy.data.objects if each not in (obj, armature)]
    return armature.data.users == 1 and not any(_uses(each, armature) for each in others)


def _uses(obj: bpy.types.Object, armature: bpy.types.Object) -> bool:
    if obj.parent == armature:
        return True
    owners = [*obj.modifiers, *obj.constraints]
    targets = [each.target for each in deformation_of(obj).constraints]
    return armature in targets or any(armature in _targets(owner) for owner in owners)


def _targets(owner: bpy.types.Modifier | bpy.types.Constraint) -> list[bpy.types.Object | None]:
    return [getattr(owner, name, None) for name in ("object", "target")]


def _digest(obj: bpy.types.Object, armature: bpy.types.Object) -> str:
    """Digest of an armature's bones, of how they are posed, and of the groups of ``obj`` for them;
    nothing if something else acts on it.
    """
    names = _bones(armature)
    posed = [armature.pose.bones[name] for name in names]
    animated = (armature.animation_data, armature.data.animation_data)
    is_more = any(len(bone.constraints) for bone in posed) or len(armature.constraints)
    if armature.mode == "EDIT" or any(animated) or is_more:
        return ""
    if not {*names} <= {*obj.vertex_groups.keys()}:
        return ""
    parents = [bone.parent.name if bone.parent else "" for bone in posed]
    matrices = [
        np.array(matrix) for bone in posed for matrix in (bone.bone.matrix_local, bone.matrix_basis)
    ]
    lengths = np.array([bone.length for bone in posed])
    weights = members(obj, names)
    text = np.frombuffer("\n".join([*names, *parents]).encode(), dtype=np.uint8)
    return digest(text, *matrices, lengths, *(each for name in names for each in weights[name]))


def _add_bones(armature: bpy.types.Object, bones: Sequence[Bone], names: Sequence[str]) -> None:
    """Add bones, in a scene of its own: Blender adds them in Edit Mode alone."""
    with Temporary() as now:
        scene = now.made(bpy.data.scenes.new("Spectral TV Rig"))
        scene.collection.objects.link(armature)
        layer = scene.view_layers[0]
        layer.objects.active = armature
        with bpy.context.temp_override(
            scene=scene, view_layer=layer, object=armature, active_object=armature,
            selected_objects=[armature],
        ):  # fmt: skip
            bpy.ops.object.mode_set(mode="EDIT")
            for name, bone in zip(names, bones, strict=True):
                added = armature.data.edit_bones.new(name)
                added.head, added.tail = bone.head, bone.tail
                # X is the axis of the hinge.
                axis = bone.relative(bones).to_quaternion().axis
                added.align_roll(axis.cross(added.vector))
            for name, bone in zip(names, bones, strict=True):
                if bone.parent is not None:
                    added = armature.data.edit_bones[name]
                    added.parent = armature.data.edit_bones[names[bone.parent]]
            bpy.ops.object.mode_set(mode="OBJECT")
    armature.show_in_front = True


def _link(armature: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Put an armature where ``obj`` is."""
    own = [each for each in obj.users_collection if not (each.library or each.override_library)]
    for collection in own or [bpy.context.scene.collection]:
        collection.objects.link(armature)


def _adopt(
    obj: bpy.types.Object, armature: bpy.types.Object, before: Sequence[bpy.types.Object]
) -> None:
    """Place an armature at ``obj``, and make it the parent of it, where that changes nothing.

    It gets the parent that ``obj`` had, or that one of those ``before`` it had.
    """
    child = obj
    while child.parent in before:
        child = child.parent
    place, world = placed(obj), obj.matrix_world.copy()
    parent, kind = child.parent, child.parent_type
    armature.matrix_world = place
    reason = None
    if obj.animation_data is not None or len(obj.constraints):
        reason = "its animation or its constraints move the object"
    elif parent is not None and kind not in PASSED_ON:
        reason = "the object's parent is more than that"
    if reason is None and parent is not None:
        armature.parent, armature.parent_type, armature.parent_bone = (
            parent,
            kind,
            child.parent_bone,
        )
        armature.matrix_world = place
        bpy.context.view_layer.update()
        if not np.allclose(armature.matrix_world, place, atol=SAME, rtol=SAME):
            reason = f"the parent {parent.name!r} is scaled unevenly"
            armature.parent, armature.matrix_world = None, place
    if reason is not None:
        note(f"the armature is not made the parent of the object: {reason}. Move both together")
        return
    obj.parent, obj.parent_type = armature, "OBJECT"
    obj.matrix_parent_inverse = place.inverted() @ world @ obj.matrix_basis.inverted()


def _replace(
    obj: bpy.types.Object, modifier: bpy.types.ArmatureModifier, armature: bpy.types.Object
) -> None:
    """Remove a modifier, its armature and the groups for it; the new ``armature`` gets its name."""
    old = modifier.object
    for name in _bones(old):
        obj.vertex_groups.remove(obj.vertex_groups[name])
    obj.modifiers.remove(modifier)
    names = old.name, old.data.name
    _remove(old)
    armature.name, armature.data.name = names
    note(f"the armature {armature.name!r} of before is replaced")


def _remove(armature: bpy.types.Object) -> None:
    bpy.data.batch_remove([armature, armature.data])


def _switch_off(modifier: bpy.types.ArmatureModifier) -> None:
    """Have an armature that is the user's now move nothing more."""
    if modifier.show_viewport or modifier.show_render:
        modifier.show_viewport = modifier.show_render = False
        note(
            f"the armature {modifier.object.name!r} is kept, as it was changed or used since, and "
            f"the modifier {modifier.name!r} is switched off"
        )


def _add_group(obj: bpy.types.Object, name: str, weights: np.ndarray) -> None:
    group = add_group(obj, name)
    group.add(np.flatnonzero(weights == 1).tolist(), 1.0, "REPLACE")
    for vertex in np.flatnonzero((weights > 0) & (weights < 1)).tolist():
        group.add([vertex], float(weights[vertex]), "REPLACE")


def _add_modifier(obj: bpy.types.Object, armature: bpy.types.Object) -> None:
    """Add the modifier before all others, but for those of bands: it takes the place of a key."""
    modifier = obj.modifiers.new("Rig", "ARMATURE")
    modifier.object = armature
    place = 0
    # Multiresolution stays first, and so do bands, which act at rest.
    while obj.modifiers[place].type == "MULTIRES" or has_bands(obj.modifiers[place]):
        place += 1
    obj.modifiers.move(len(obj.modifiers) - 1, place)
