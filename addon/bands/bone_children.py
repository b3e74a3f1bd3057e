"""What hangs on the bones of an armature, and stays where it is when their rest changes."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
from mathutils import Matrix
from spectral_tv.notes import listed, note


@contextmanager
def staying(rig: bpy.types.Object) -> Iterator[None]:
    """Have objects whose parents are bones be in the same places of the resting armature
    afterwards. What cannot, or follows bones by other means, is noted."""
    before = {child: _end(child) for child in bpy.data.objects if _hangs_on(child, rig)}
    yield
    stay, left = [], []
    for child, end in before.items():
        now = _end(child)
        if now == end:
            continue
        if child.library is not None or child.override_library is not None:
            left.append(child.name)
            continue
        child.matrix_parent_inverse = now.inverted() @ end @ child.matrix_parent_inverse
        stay.append(child.name)
    if stay:
        note(f"what hangs on its bones stays where it is at rest: {listed(stay)}")
    left += [obj.name for obj in bpy.data.objects if _follows(obj, rig)]
    if left:
        note(f"these follow its bones to where they are now: {listed(left)}")


def _hangs_on(child: bpy.types.Object, rig: bpy.types.Object) -> bool:
    """Whether the parent of an object is a bone of the armature, or of another object with it."""
    if child.parent_type != "BONE" or child.parent is None or child.parent.data != rig.data:
        return False
    bone = rig.data.bones.get(child.parent_bone)
    return bone is not None and not bone.use_relative_parent


def _end(child: bpy.types.Object) -> Matrix:
    """Where a child hangs on its bone at rest: at the tail, in the armature's space."""
    bone = child.parent.data.bones[child.parent_bone]
    return bone.matrix_local @ Matrix.Translation((0, bone.length, 0))


def _follows(obj: bpy.types.Object, rig: bpy.types.Object) -> bool:
    """Whether constraints or hooks of an object refer to bones of the armature."""
    hooks = [each for each in obj.modifiers if each.type == "HOOK"]
    if any(each.object and each.object.data == rig.data and each.subtarget for each in hooks):
        return True
    for constraint in obj.constraints:
        targets = getattr(constraint, "targets", None) or [constraint]  # of Armature there are many
        for each in targets:
            target = getattr(each, "target", None)
            if target and target.data == rig.data and getattr(each, "subtarget", ""):
                return True
    return False
