"""Masks of shape keys: vertex groups whose weights say how much of a key reaches each vertex.

A mask that was made for a key is its own, and the mesh remembers its name. Its weights may be
replaced, and it follows the name of its key. Any other vertex group is the user's: it is used as it
is, and never written.
"""

from collections.abc import Iterable, Sequence

import bpy
from bpy.props import StringProperty
from spectral_tv.later import np
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from .contents import attribute_values
from .group_users import masked_by, others_with, told
from .mix import Slider, mask
from .names import free_name, taken_names
from .weights import add_group, set_weights

# What of its name comes after that of its key.
LABEL = "Mask"
# The attribute with what is masked in Sculpt Mode; masks of Multiresolution are in no attribute.
SCULPT_MASK = ".sculpt_mask"


class SpectralTVMask(bpy.types.PropertyGroup):
    """A vertex group that was made as the mask of a shape key."""

    name: StringProperty(name="Name", description="Of the vertex group")


def sculpt_mask(mesh: bpy.types.Mesh) -> "np.ndarray | None":
    """How much Sculpt Mode masks each vertex, (V,); None if it never did.

    Of levels of Multiresolution it tells nothing: Blender 4.2 has 0 everywhere then.
    """
    attribute = mesh.attributes.get(SCULPT_MASK)
    if attribute is None or attribute.domain != "POINT":
        return None
    return np.clip(attribute_values(attribute).astype(np.float64), 0, 1)


def mask_group(obj: bpy.types.Object, key: Slider) -> bpy.types.VertexGroup | None:
    """The vertex group that masks a key; None without one, or if it is missing."""
    return obj.vertex_groups.get(key.vertex_group) if key.vertex_group else None


def weights(obj: bpy.types.Object, key: Slider) -> "np.ndarray":
    """Those of the mask of a key, (V,); raises Refusal if it has none."""
    if mask_group(obj, key) is None:
        missing = f": there is no vertex group {key.vertex_group!r}" if key.vertex_group else ""
        raise Refusal(f"{key.name!r} has no mask{missing}")
    return mask(obj, key)


def is_own(obj: bpy.types.Object, name: str) -> bool:
    """Whether a vertex group was made as a mask, and still is one."""
    kept = obj.data.spectral_tv.masks
    return name in kept and name in obj.vertex_groups and bool(masked_by(obj, name))


def give(obj: bpy.types.Object, key: Slider, found: "np.ndarray") -> bpy.types.VertexGroup:
    """Have a key have a mask of these weights, (V,), of its own.

    A former one of its own is written over, unless something else uses it too. Raises Refusal if it
    is locked.
    """
    former = mask_group(obj, key)
    _tell_missing(key, former)
    if former is not None and is_own(obj, former.name) and not told(obj, former.name, [key.name]):
        if former.lock_weight:
            raise Refusal(f"the vertex group {former.name!r} is locked")
        group = former
    else:
        group = _new(obj, key)
        if former is not None:
            note(f"{former.name!r} stays as it was; the mask of {key.name!r} is {group.name!r} now")
    set_weights(group, found)
    key.vertex_group = group.name
    _renew(obj)
    return group


def choose(obj: bpy.types.Object, key: Slider, group: bpy.types.VertexGroup) -> None:
    """Have a vertex group be the mask of a key, as it is."""
    key.vertex_group = group.name
    _renew(obj)


def remove(obj: bpy.types.Object, key: Slider) -> str:
    """Have a key act everywhere; returns what became of its mask.

    One of its own is removed, unless it is locked or something else uses it. Raises Refusal if it
    has no mask.
    """
    name, group = key.vertex_group, mask_group(obj, key)
    if not name:
        raise Refusal(f"{key.name!r} has no mask")
    is_free = group is not None and not group.lock_weight and not told(obj, name, [key.name])
    goes = is_free and is_own(obj, name)
    key.vertex_group = ""
    if group is None:
        return f"the vertex group {name!r} was missing"
    if goes:
        obj.vertex_groups.remove(group)
    _renew(obj)
    return f"the vertex group {name!r} {'was removed' if goes else 'stays'}"


def settle(obj: bpy.types.Object, keys: Sequence[Slider]) -> None:
    """Have keys that took masks over from others each have one of its own, named after it.

    Masks that were made as such and are none any more are noted, and stay as vertex groups.
    """
    seen: set[str] = set()
    for key in keys:
        name = key.vertex_group
        if name in seen and is_own(obj, name):
            found = mask(obj, key)
            group = _new(obj, key)
            set_weights(group, found)
            key.vertex_group = group.name
        seen.add(name)
    fit_names(obj, keys)
    release(obj)


def fit_names(obj: bpy.types.Object, keys: Iterable[Slider]) -> None:
    """Have masks of keys that are their own follow the names of these, of the first if shared."""
    first: dict[str, str] = {}
    for key in keys:
        name = key.vertex_group
        if is_own(obj, name) and not others_with(obj, name):
            first.setdefault(name, key.name)
    taken = taken_names(obj, "GROUP") - first.keys()
    wanted = {}
    for former, stem in first.items():
        wanted[former] = free_name(stem, LABEL, taken)
        taken.add(wanted[former])
    changed = [(obj.vertex_groups[name], name) for name in wanted if wanted[name] != name]
    masked = {name: masked_by(obj, name) for _, name in changed}
    for group, former in changed:
        group.name = free_name(former, "", taken_names(obj, "GROUP"))  # to make room for others
    for group, former in changed:
        group.name = wanted[former]
        for key in masked[former]:
            key.vertex_group = group.name
    kept = obj.data.spectral_tv.masks
    places = [(kept[former], wanted[former]) for _, former in changed]
    for place, name in places:
        place.name = name


def release(obj: bpy.types.Object) -> None:
    """Note which masks that were made as such mask nothing any more; they stay as groups."""
    left = [
        each.name
        for each in obj.data.spectral_tv.masks
        if each.name in obj.vertex_groups and not masked_by(obj, each.name)
    ]
    if left:
        note(f"no bands have these masks any more, which stay as vertex groups: {listed(left)}")
    _renew(obj)


def _new(obj: bpy.types.Object, key: Slider) -> bpy.types.VertexGroup:
    """A new vertex group, so far empty, that is remembered as the mask of a key."""
    group = add_group(obj, free_name(key.name, LABEL, taken_names(obj, "GROUP")))
    if group.name not in obj.data.spectral_tv.masks:
        obj.data.spectral_tv.masks.add().name = group.name
    return group


def _renew(obj: bpy.types.Object) -> None:
    """Forget masks that are none any more, and have Blender work the shape out anew."""
    kept = obj.data.spectral_tv.masks
    for place in reversed(range(len(kept))):
        if not is_own(obj, kept[place].name):
            kept.remove(place)
    obj.data.update_tag()


def _tell_missing(key: Slider, group: bpy.types.VertexGroup | None) -> None:
    if key.vertex_group and group is None:
        note(f"the vertex group {key.vertex_group!r} that masked {key.name!r} is missing")
