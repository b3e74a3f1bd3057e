"""The deformation of an object: from its constraints to displacements."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.deformation.settings import Settings
from spectral_tv.deformation.solvers import Solver, follow_complaint, solver_of
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene.objects import refusal
from ..scene.places import kept_up
from ..scene.surface import Surface
from . import results, turning
from .additions import note_additions
from .constraints import FIRST_STEPS, deformation_of, followed_by, sharing
from .grips import Grips

# Of lengths, a change that is not seen.
SAME_METRIC = 1e-3


@dataclass(frozen=True)
class Deformable:
    """An object's surface and what constrains it."""

    surface: Surface
    grips: Grips

    @classmethod
    def read(cls, obj: bpy.types.Object, replaced: Collection[str] = ()) -> Deformable:
        """Read ``obj``, while what it follows is kept up; ``replaced`` is as in `note_additions`.

        Raises Refusal or spectral_tv.MeshError if it cannot be deformed.
        """
        reason = shared_refusal(obj)
        if reason is not None:
            raise Refusal(reason)
        bpy.context.evaluated_depsgraph_get()  # for the place of an object that was just moved
        grips = Grips.read(obj)
        note_additions(obj, grips.handles.indices, replaced)
        _note_rest_positions(obj)
        return cls(grips.surface, grips)

    def displacement(self, result: Any) -> np.ndarray:
        """What a result moves every vertex of the object by, in object space, (V, 3)."""
        moved = result.vertices - self.surface.mesh.vertices
        return self.surface.to_object(moved[np.newaxis])[0]

    def note_turning(
        self, obj: bpy.types.Object, targets: list[np.ndarray], algorithm: str
    ) -> None:
        """Note if handles turn, or grow, on the way to ``targets``, and pieces do not."""
        counts = turning.counting(obj, algorithm)
        own = self.grips.is_own & np.isin(self.grips.owners, counts)  # others turn the other way
        owners, rest = self.grips.owners[own], self.grips.rest[own]
        angle = max(turning.of_points(owners, rest, each[own]) for each in targets)
        texts = [turning.told(angle, algorithm)]
        if algorithm == "POSE":
            factor = max(turning.growth_of_points(owners, rest, each[own]) for each in targets)
            texts.append(turning.told_growth(factor))
        for text in filter(None, texts):
            note(text)


def metric_of(obj: bpy.types.Object) -> np.ndarray:
    """What lengths of ``obj`` are in the world, whichever way it is turned, (3, 3)."""
    matrix = np.array(obj.matrix_world.to_3x3(), dtype=np.float64)
    return matrix.T @ matrix


def is_same_metric(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether nobody sees a difference."""
    return np.abs(one - other).max() <= SAME_METRIC * np.abs(other).max()


def shared_refusal(obj: bpy.types.Object) -> str | None:
    """Why the mesh of ``obj`` cannot hold its deformation, in a sentence for the user."""
    rivals = sharing(obj)
    if not rivals:
        return None
    names = results.told([each.name for each in rivals])
    return (
        f"Its mesh is also that of {names}, with other constraints; give it one of its own by "
        "Object > Relations > Make Single User > Object & Data"
    )


def deform_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why ``obj`` cannot be deformed now, in a sentence for the user; None if it can."""
    reason = refusal(obj)
    if reason is None and not deformation_of(obj).constraints:
        reason = f"The object has no constraints; {FIRST_STEPS}"
    return reason or shared_refusal(obj)


def follow_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why ``obj`` cannot be deformed again and again, as :func:`deform_refusal`."""
    reason = deform_refusal(obj)
    return reason or follow_complaint(deformation_of(obj).algorithm)


def prepare(
    obj: bpy.types.Object, settings: Settings, replaced: Collection[str] = ()
) -> tuple[Deformable, np.ndarray, Solver]:
    """What is read of ``obj``, the targets of its grips, and what solves for them.

    ``replaced`` names modifiers that will not act on the result. Raises Refusal or
    spectral_tv.MeshError if it cannot be deformed.
    """
    with kept_up(followed_by(obj)):
        deformable = Deformable.read(obj, replaced)
        targets = deformable.grips.targets(obj)
    deformable.note_turning(obj, [targets], settings.algorithm)
    return deformable, targets, solver_of(deformable.grips.held(obj), settings)


def write(obj: bpy.types.Object, displacement: np.ndarray) -> None:
    """Write a displacement (V, 3) as the shape key of the deformation, and have it be seen."""
    results.write(obj, displacement)
    results.show(obj)


def _note_rest_positions(obj: bpy.types.Object) -> None:
    for constraint in deformation_of(obj).constraints:
        rig = constraint.target if constraint.kind == "OBJECT" else None
        if rig is None or rig.type != "ARMATURE" or not constraint.bone:
            continue
        if rig.data.pose_position == "REST":
            note(f"the armature {rig.name!r} is in Rest Position: its bones do not move")
        elif rig.mode == "EDIT":
            note(
                f"the armature {rig.name!r} is in Edit Mode: its bones are not where they are posed"
            )
