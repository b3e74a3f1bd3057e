"""What uses a vertex group."""

from collections.abc import Collection, Iterator

import bpy
from spectral_tv.notes import listed

from .attribute_band import has_bands
from .mix import Slider, sliders_of


def masked_by(obj: bpy.types.Object, name: str) -> list[Slider]:
    """The shape keys and bands that a vertex group masks."""
    return [each for each in sliders_of(obj) if each.vertex_group == name]


def others_with(obj: bpy.types.Object, name: str) -> list[str]:
    """What else uses a vertex group of the mesh: modifiers, constraints, particles and such."""
    found = []
    for user in [each for each in bpy.data.objects if each.data == obj.data]:
        modifiers = [each for each in user.modifiers if not has_bands(each)]
        owners = [*modifiers, *(each.settings for each in user.particle_systems)]
        found += [each.name for each in [*owners, *user.particle_systems] if _has(each, name)]
        if any(each.vertex_group == name for each in user.spectral_tv.constraints):
            found.append("a constraint of Deform")
        found += [each.name for each in _aiming_at(user) if each.subtarget == name]
    return list(dict.fromkeys(found))


def told(obj: bpy.types.Object, name: str, but: Collection[str] = ()) -> str:
    """What uses a vertex group beside some shape keys, as a user reads it; "" if nothing does."""
    names = [each.name for each in masked_by(obj, name) if each.name not in but]
    return listed([*names, *others_with(obj, name)])


def _has(owner: bpy.types.bpy_struct, name: str) -> bool:
    """Whether a modifier, or settings of it, name a vertex group."""
    for each in (
        owner,
        *(getattr(owner, part, None) for part in ("settings", "collision_settings")),
    ):
        if each is None:
            continue
        fields = each.bl_rna.properties
        groups = [field for field, _ in fields.items() if "vertex_group" in field]
        if any(getattr(each, field) == name for field in groups):
            return True
    return getattr(owner, "type", "") == "NODES" and name in _inputs(owner)


def _inputs(nodes: bpy.types.NodesModifier) -> Iterator[object]:
    """What the inputs of a modifier of Geometry Nodes are, and the attributes they take."""
    if not hasattr(nodes, "properties"):  # before Blender 5.2
        yield from nodes.values()
        return
    inputs = nodes.properties.inputs
    for field in set(inputs.bl_rna.properties.keys()) - {"rna_type", "name"}:
        socket = getattr(inputs, field)
        yield from (getattr(socket, part, None) for part in ("value", "attribute_name"))


def _aiming_at(obj: bpy.types.Object) -> Iterator[bpy.types.Constraint]:
    """The constraints of objects and bones that aim at a part of ``obj``."""
    for other in bpy.data.objects:
        bones = other.pose.bones if other.pose is not None else ()
        for constraint in (each for owner in (other, *bones) for each in owner.constraints):
            if getattr(constraint, "target", None) == obj and hasattr(constraint, "subtarget"):
                yield constraint
