"""The operator that splits the parts that were found into connected ones, as vertex groups."""

from contextlib import nullcontext

import bpy
from bpy.props import FloatProperty
from spectral_tv.later import np
from spectral_tv.notes import about, note
from spectral_tv.refusal import Refusal

from ..job.jobs import read_each
from ..job.operator import ChangeOperator
from ..scene import mix, results
from ..scene.objects import refusal
from ..scene.results import PARTS, SEGMENTS, Piece, groups_shown
from ..scene.surface import Surface
from ..scene.weights import weights_of
from . import parts

PART = "Part"
# Of a vertex in no segment.
NOTHING = -1


class SPECTRAL_TV_OT_split_segments(ChangeOperator, bpy.types.Operator):
    """Split the segments of all selected meshes that are in several pieces into connected parts,
    each a vertex group: one hand and the other. They serve as masks of bands"""

    bl_idname = "spectral_tv.split_segments"
    bl_label = "Split into Connected Parts"

    least: FloatProperty(
        name="Smallest",
        description="Parts of less of the surface are joined to the neighbor that they have the "
        "longest border with",
        default=0.5,
        min=0,
        max=50,
        soft_max=5,
        precision=2,
        subtype="PERCENTAGE",
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return refusal(context.active_object)

    def change(self, context: bpy.types.Context, _obj: bpy.types.Object) -> str:
        found = read_each(context, lambda obj: (obj, *self._read(obj)))
        for obj, pieces, joined in found:
            with about(obj.name) if len(found) > 1 else nullcontext():
                if joined:
                    note(f"{joined} parts were too small, and belong to their neighbors now")
                results.write(obj, PARTS, "", pieces, lambda _: True, _name)
        count = sum(len(pieces) for _, pieces, _ in found)
        meshes = "" if len(found) == 1 else f" in {len(found)} meshes"
        return f"{count} connected parts{meshes}" if count else "every segment is connected"

    def _read(self, obj: bpy.types.Object) -> tuple[dict[str, Piece], int]:
        """The parts of an object by their segments and numbers, and how many were joined."""
        names = groups_shown(obj, SEGMENTS)
        if not names:
            raise Refusal("it has no segments as vertex groups; press Segment Selected first")
        weights = np.column_stack([weights_of(obj, obj.vertex_groups[name]) for name in names])
        labels = np.where(weights.any(axis=1), weights.argmax(axis=1), NOTHING)
        surface = Surface.read(obj, mix.shown(obj))
        mesh = surface.mesh
        merged = np.full(len(mesh.vertex_areas), NOTHING)
        is_there = surface.place >= 0
        merged[surface.place[is_there]] = labels[is_there]
        numbers, own, joined = parts.connected_parts(
            merged, mesh.triangles, mesh.vertex_areas, self.least / 100 * mesh.area
        )
        sizes = np.bincount(numbers, mesh.vertex_areas, len(own))
        found = surface.to_vertices(numbers + 1) - 1
        pieces = {}
        for label, name in enumerate(names):
            # The largest first, and of equal ones that with the first vertex.
            order = sorted(np.flatnonzero(own == label), key=lambda part: -sizes[part])
            for number, part in enumerate(order if len(order) > 1 else (), start=1):
                pieces[f"{name}/{number}"] = Piece("GROUP", (found == part).astype(float))
        return pieces, joined


def _name(_source: str, label: str) -> tuple[str, str]:
    segment, _, number = label.rpartition("/")
    return segment, f"{PART} {number}"
