"""Writing the parts of a mesh: vertex groups, face sets and colours."""

import colorsys

import bpy
import numpy as np

# Also the name of the colour attribute; the vertex groups are numbered.
NAME = "Segment"
FACE_SETS = ".sculpt_face_set"
OUTPUTS = (
    ("COLOR", "Colors", "A color attribute named Segment", "COLOR", 1),
    ("GROUPS", "Vertex Groups", "A vertex group per part", "GROUP_VERTEX", 2),
    ("FACE_SETS", "Face Sets", "A face set per part, for sculpting", "FACE_MAPS", 4),
)
# Hues a golden angle apart stay distinct however many there are.
GOLDEN = 0.618034


def write(obj: bpy.types.Object, labels: np.ndarray, segments: int, outputs: set[str]) -> None:
    """Write the labels (V,), 0 to ``segments`` − 1, in the chosen ways; replaces what was there."""
    mesh = obj.data
    if "COLOR" in outputs:
        _write_colors(mesh, labels, segments)
    if "GROUPS" in outputs:
        _write_groups(obj, labels, segments)
    if "FACE_SETS" in outputs:
        _write_face_sets(mesh, labels)
    mesh.update_tag()


def color(label: int) -> tuple[float, float, float]:
    """The colour of a part."""
    return colorsys.hsv_to_rgb((0.02 + GOLDEN * label) % 1, 0.65, 0.85 if label % 2 else 0.7)


def _write_colors(mesh: bpy.types.Mesh, labels: np.ndarray, segments: int) -> None:
    attribute = mesh.color_attributes.get(NAME)
    if attribute is not None and (attribute.domain, attribute.data_type) != (
        "POINT",
        "FLOAT_COLOR",
    ):
        mesh.color_attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = mesh.color_attributes.new(NAME, "FLOAT_COLOR", "POINT")
    palette = np.array([(*color(label), 1.0) for label in range(segments)], dtype=np.float32)
    attribute.data.foreach_set("color", palette[labels].ravel())
    mesh.color_attributes.active_color = attribute


def _write_groups(obj: bpy.types.Object, labels: np.ndarray, segments: int) -> None:
    stale = [
        group for group in obj.vertex_groups
        if group.name.startswith(f"{NAME} ") and group.name.removeprefix(f"{NAME} ").isdecimal()
    ]  # fmt: skip
    for group in stale:
        obj.vertex_groups.remove(group)
    for label in range(segments):
        members = np.flatnonzero(labels == label).tolist()
        obj.vertex_groups.new(name=f"{NAME} {label + 1}").add(members, 1.0, "REPLACE")


def _write_face_sets(mesh: bpy.types.Mesh, labels: np.ndarray) -> None:
    attribute = mesh.attributes.get(FACE_SETS)
    if attribute is None:
        attribute = mesh.attributes.new(FACE_SETS, "INT", "FACE")
    # Faces across a border go to the smaller, hence more special part: the higher label.
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_start", starts)
    order = np.argsort(starts)
    faces = np.empty(len(starts), dtype=np.int32)
    faces[order] = np.maximum.reduceat(labels[corners], starts[order])
    attribute.data.foreach_set("value", (faces + 1).astype(np.int32))
