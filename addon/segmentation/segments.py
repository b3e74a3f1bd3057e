"""Writing the parts of a mesh: vertex groups, face sets and colors."""

from __future__ import annotations

import bpy
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.segmentation.colors import color

from ..scene import results
from ..scene.arrays import corner_vertices, polygon_starts
from ..scene.contents import attribute_values
from ..scene.names import free_name, taken_names
from ..scene.results import SEGMENTS, Piece

# The beginning of the names of results; the vertex groups are numbered.
NAME = "Segment"
COLOR, SETS = "Color", "Face Sets"
# Blender knows the face sets by their name, so there is one of them on a mesh.
FACE_SETS = ".sculpt_face_set"


def write(obj: bpy.types.Object, labels: np.ndarray, segments: int, outputs: set[str]) -> None:
    """Write labels (V,), 0 to ``segments`` − 1, in the chosen ways, in place of the last ones."""
    pieces = {}
    if "COLOR" in outputs:
        palette = np.array([(*color(label), 1.0) for label in range(segments)])
        pieces[COLOR] = Piece("ATTRIBUTE", palette[labels], "FLOAT_COLOR")
    if "GROUPS" in outputs:
        for label in range(segments):
            pieces[str(label + 1)] = Piece("GROUP", (labels == label).astype(float))

    def is_stale(label: str) -> bool:
        return "GROUPS" in outputs and label.isdecimal()

    def wanted(_source: str, label: str) -> tuple[str, str]:
        return NAME, label if label.isdecimal() else ""

    names = results.write(obj, SEGMENTS, "", pieces, is_stale, wanted)
    if "COLOR" in outputs:
        attributes = obj.data.color_attributes
        attributes.active_color = attributes[names[list(pieces).index(COLOR)]]
    if "FACE_SETS" in outputs:
        _write_face_sets(obj, labels)


def _write_face_sets(obj: bpy.types.Object, labels: np.ndarray) -> None:
    """Write them over those that are there, which are kept elsewhere if they are the user's."""
    mesh = obj.data
    # Faces across a border go to the smaller, hence more special part: the higher label.
    corners = corner_vertices(mesh)
    starts = polygon_starts(mesh)
    order = np.argsort(starts)
    faces = np.empty(len(starts), dtype=np.int32)
    faces[order] = np.maximum.reduceat(labels[corners], starts[order])
    before = mesh.attributes.get(FACE_SETS)
    if before is not None and FACE_SETS not in results.known(obj, "ATTRIBUTE").values():
        _keep(obj, attribute_values(before))
    if before is None:
        mesh.attributes.new(FACE_SETS, "INT", "FACE")
    pieces = {SETS: Piece("ATTRIBUTE", faces + 1, "INT", "FACE")}
    results.write(obj, SEGMENTS, "", pieces, over={SETS: FACE_SETS})


def _keep(obj: bpy.types.Object, sets: np.ndarray) -> None:
    """Keep the user's face sets as an attribute, unless all faces are in one."""
    count = len(np.unique(sets))
    if count < 2:
        return
    name = free_name(SETS, "", taken_names(obj, "ATTRIBUTE"))
    obj.data.attributes.new(name, "INT", "FACE").data.foreach_set("value", sets)
    note(f"{count} face sets were replaced; the attribute {name!r} keeps them")
