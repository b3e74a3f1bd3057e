"""What can be flowed: attributes, vertex groups and shape keys, as values of the vertices."""

from __future__ import annotations

import bpy
from spectral_tv.attributes.flows import ensure_finite
from spectral_tv.attributes.settings import KINDS
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.means import means
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene.arrays import corner_vertices, numbers
from ..scene.contents import TYPES, attribute_values
from ..scene.fingerprints import names as names_of
from ..scene.mix import key_displacement, keys_of
from ..scene.weights import group_named, weights_of

COLORS = ("FLOAT_COLOR", "BYTE_COLOR")


@dataclass(frozen=True)
class Source:
    """A function on the vertices of an object: ``values`` (V, C), C being 1 for a scalar.

    Of colors red, green and blue are the values, and ``alpha`` (V,) is kept as it is; of shape
    keys the displacements, in object space.
    """

    kind: str
    name: str
    values: np.ndarray
    alpha: np.ndarray | None = None


def names(obj: bpy.types.Object, kind: str) -> list[str]:
    """Names of what can be flowed."""
    if kind in ("GROUP", "KEY"):
        return names_of(obj, kind)
    return [
        attribute.name
        for attribute in obj.data.attributes
        if not attribute.name.startswith(".")
        and (
            attribute.data_type in COLORS or (kind == "ATTRIBUTE" and attribute.data_type in TYPES)
        )
        and not _why_not(attribute)
    ]


def read(obj: bpy.types.Object, kind: str, name: str) -> Source:
    """Read what ``name`` says, or the active one of its kind where it says nothing.

    Raises Refusal if there is none, or it is no function on the surface.
    """
    name = name or _active(obj, kind)
    if not name:
        raise Refusal(f"there is no active {_label(kind)}; choose one")
    alpha = None
    if kind == "GROUP":
        values = weights_of(obj, group_named(obj, name))[:, np.newaxis]
    elif kind == "KEY":
        values = _key(obj, name)
    else:
        values = _attribute(obj.data, name, kind)
        if values.shape[1] == 4:
            values, alpha = values[:, :3], values[:, 3]
    ensure_finite(name, values)
    return Source("ATTRIBUTE" if kind == "COLOR" else kind, name, values, alpha)


def _label(kind: str) -> str:
    return next(label for each, label, *_ in KINDS if each == kind).lower()


def _active(obj: bpy.types.Object, kind: str) -> str:
    active = {
        "ATTRIBUTE": lambda: obj.data.attributes.active,
        "COLOR": lambda: obj.data.color_attributes.active_color,
        "GROUP": lambda: obj.vertex_groups.active,
        "KEY": lambda: obj.active_shape_key,
    }[kind]()
    return "" if active is None else active.name


def _key(obj: bpy.types.Object, name: str) -> np.ndarray:
    key = keys_of(obj.data).get(name)
    if key is None:
        raise Refusal(f"there is no shape key {name!r}")
    if key == key.id_data.reference_key:
        raise Refusal(f"{name!r} is the shape that others are measured from; choose another key")
    if key.vertex_group:
        note(f"{name!r} is limited to {key.vertex_group!r}; what comes of it is not")
    return key_displacement(key)


def _attribute(mesh: bpy.types.Mesh, name: str, kind: str) -> np.ndarray:
    attribute = mesh.attributes.get(name)
    if attribute is None or (kind == "COLOR" and attribute.data_type not in COLORS):
        raise Refusal(f"there is no {_label(kind)} {name!r}")
    reason = _why_not(attribute)
    if reason:
        raise Refusal(f"the attribute {name!r} {reason}")
    _, channels, _ = TYPES[attribute.data_type]
    values = attribute_values(attribute).reshape(-1, channels).astype(np.float64)
    if attribute.domain == "POINT":
        return values
    corners = corner_vertices(mesh)
    if attribute.domain == "CORNER":
        return means(corners, values, len(mesh.vertices))
    sizes = numbers(mesh.polygons, "loop_total")
    areas = numbers(mesh.polygons, "area", dtype=np.float32)
    # A face without area still has a say where it is alone.
    areas = np.maximum(areas, np.finfo(np.float32).tiny)
    face = np.repeat(np.arange(len(sizes)), sizes)
    return means(corners, values[face], len(mesh.vertices), areas[face])


def _why_not(attribute: bpy.types.Attribute) -> str:
    """Why an attribute is no function on the surface; empty if it is."""
    if attribute.data_type not in TYPES:
        return "has no numbers that could be flowed"
    if attribute.domain == "EDGE":
        return "is on edges; convert it to vertices first"
    if attribute.domain == "CORNER" and attribute.data_type == "FLOAT2":
        return "is a UV map, which is torn at its seams; convert it to vertices first"
    if attribute.domain not in ("POINT", "CORNER", "FACE"):
        return "is not on the vertices or faces"
    return ""
