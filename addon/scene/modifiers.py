"""Modifiers that change what is seen of a mesh, beside its vertices and shape keys."""

import bpy

from .attribute_band import has_bands

# Types that move no vertex and change no face.
HARMLESS = {
    "DATA_TRANSFER",
    "NORMAL_EDIT",
    "UV_PROJECT",
    "UV_WARP",
    "VERTEX_WEIGHT_EDIT",
    "VERTEX_WEIGHT_MIX",
    "VERTEX_WEIGHT_PROXIMITY",
    "WEIGHTED_NORMAL",
    "COLLISION",
    "DYNAMIC_PAINT",
    "FLUID",
    "PARTICLE_SYSTEM",
}
# Those whose result is another on another frame, whatever else is animated.
MOVING = {
    "ARMATURE",
    "CLOTH",
    "CURVE",
    "HOOK",
    "LATTICE",
    "MESH_CACHE",
    "MESH_DEFORM",
    "MESH_SEQUENCE_CACHE",
    "NODES",
    "OCEAN",
    "SHRINKWRAP",
    "SOFT_BODY",
    "SURFACE_DEFORM",
    "WAVE",
}


def symmetries(obj: bpy.types.Object) -> list[bpy.types.MirrorModifier]:
    """The Mirror modifiers of ``obj`` that are shown, and add the other half to this one.

    Those that cut the mesh first are not among them: what they add is no other half of it.
    """
    return [
        modifier
        for modifier in obj.modifiers
        if modifier.type == "MIRROR"
        and modifier.show_viewport
        and any(modifier.use_axis)
        and not any(modifier.use_bisect_axis)
    ]


def passed_over(obj: bpy.types.Object) -> list[bpy.types.Modifier]:
    """The modifiers that are shown and change the shape, but for `symmetries` and the bands'."""
    mirrors = symmetries(obj)
    return [
        modifier
        for modifier in obj.modifiers
        if modifier.show_viewport
        and modifier.type not in HARMLESS
        and modifier not in mirrors
        and not has_bands(modifier)
        and not (modifier.type == "MULTIRES" and modifier.levels == 0)
        and not (modifier.type == "SUBSURF" and modifier.levels == 0)
        and not (modifier.type == "ARMATURE" and modifier.object is None)
    ]


def ahead_of_bands(obj: bpy.types.Object) -> list[str]:
    """The modifiers that change the shape before those of bands do, which so do not act at rest."""
    own = [each for each in obj.modifiers if has_bands(each)]
    place = max((obj.modifiers.find(each.name) for each in own), default=0)
    return [
        each.name
        for each in obj.modifiers[:place]
        if each.show_viewport and each.type not in HARMLESS and not has_bands(each)
    ]


def bending_parent(obj: bpy.types.Object) -> bpy.types.Object | None:
    """The parent of ``obj`` if it bends it as a modifier before all others would, or None."""
    return obj.parent if obj.parent_type in ("ARMATURE", "LATTICE") else None


def between(obj: bpy.types.Object) -> list[str]:
    """What lies between the mesh and what is shown, in its order."""
    parent, passed = bending_parent(obj), [*symmetries(obj), *passed_over(obj)]
    names = [modifier.name for modifier in obj.modifiers if modifier in passed]
    return names if parent is None else [parent.name, *names]


def is_moved(obj: bpy.types.Object) -> bool:
    """Whether some of that depends on the frame by its nature."""
    return bending_parent(obj) is not None or any(
        modifier.type in MOVING for modifier in passed_over(obj)
    )
