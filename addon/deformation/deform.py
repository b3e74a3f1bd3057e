"""The deformation of an object: from its constraints to a shape key."""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
import spectral_tv

from ..scene.objects import Refusal, refusal
from ..scene.records import coordinates, digest
from ..scene.shape_keys import add_displacements, set_displacement
from ..scene.surface import Surface
from .constraints import deformation_of
from .handles import Handles

NAME = "Deformation"
ONE_AFTER_ANOTHER = "Live and Bake Animation need the algorithm Total Variation"


@dataclass(frozen=True)
class Deformable:
    """An object's surface and what constrains it."""

    surface: Surface
    handles: Handles

    @classmethod
    def read(cls, obj: bpy.types.Object) -> "Deformable":
        """Read ``obj``; raises Refusal or spectral_tv.MeshError if it cannot be deformed."""
        return cls(Surface.read(obj), Handles.read(obj))

    @property
    def indices(self) -> np.ndarray:
        """The constrained vertices of the surface's mesh, (K,)."""
        return self.surface.place[self.handles.indices]

    def targets(self, obj: bpy.types.Object) -> np.ndarray:
        """Where they go now, in the space of the surface, (K, 3)."""
        return self.handles.targets(obj) @ self.surface.matrix.T

    def softness(self, percent: float) -> float:
        """A percentage of the object's size as a length."""
        return percent / 100 * float(np.sqrt(self.surface.mesh.area))

    def deformer(self, obj: bpy.types.Object) -> spectral_tv.Deformer:
        """What deforms the surface again and again, as soft as ``obj`` says.

        Raises Refusal if ``obj`` asks for an algorithm that does not.
        """
        if deformation_of(obj).algorithm != "CONVEX":
            raise Refusal(ONE_AFTER_ANOTHER)
        softness = self.softness(deformation_of(obj).softness)
        return spectral_tv.Deformer(self.surface.mesh, self.indices, self.handles.weights, softness)

    def displacement(self, result: spectral_tv.Deformation) -> np.ndarray:
        """What a result moves every vertex of the object by, in object space, (V, 3)."""
        moved = result.vertices - self.surface.mesh.vertices
        return self.surface.to_object(moved[np.newaxis])[0]


def deform_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why ``obj`` cannot be deformed now, in a sentence for the user; None if it can."""
    reason = refusal(obj)
    if reason is None and not deformation_of(obj).constraints:
        reason = "The object has no constraints; add a pin and a handle"
    return reason


def follow_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why ``obj`` cannot be deformed again and again, as :func:`deform_refusal`."""
    reason = deform_refusal(obj)
    if reason is None and deformation_of(obj).algorithm != "CONVEX":
        reason = ONE_AFTER_ANOTHER
    return reason


def prepare(
    obj: bpy.types.Object, algorithm: str, softness: float
) -> tuple[Deformable, dict[str, Any]]:
    """What is read of ``obj``, and the keyword arguments of spectral_tv.deform.

    ``softness`` is in percent. Raises Refusal or spectral_tv.MeshError if it cannot be deformed.
    """
    deformable = Deformable.read(obj)
    return deformable, {
        "indices": deformable.indices,
        "targets": deformable.targets(obj),
        "weights": deformable.handles.weights,
        "softness": deformable.softness(softness) if algorithm == "CONVEX" else 0.0,
        "algorithm": algorithm.lower(),
    }


def result_key(obj: bpy.types.Object) -> bpy.types.ShapeKey | None:
    """The shape key that holds the last deformation, renamed or not; None if it is gone."""
    keys, deformation = obj.data.shape_keys, deformation_of(obj)
    if keys is None or not deformation.key:
        return None
    found = keys.key_blocks.get(deformation.key)
    if found is None and deformation.digest:
        for key in keys.key_blocks:
            if digest(coordinates(key.data)) == deformation.digest:
                found = key
    return found


def write(obj: bpy.types.Object, displacement: np.ndarray) -> bpy.types.ShapeKey:
    """Write a displacement (V, 3) as the shape key of the deformation, at full value if new."""
    key = result_key(obj)
    if key is None:
        (key,) = add_displacements(obj, [NAME], displacement[np.newaxis])
        key.value = 1.0
    else:
        set_displacement(obj, key, displacement)
    deformation = deformation_of(obj)
    deformation.key, deformation.digest = key.name, digest(coordinates(key.data))
    return key


def message(result: spectral_tv.Deformation, algorithm: str) -> str:
    """What a result says about itself, for the user."""
    text = "deformed"
    if algorithm == "CONVEX":
        text += f" to within {max(result.gap, 1e-4):.2%} of the optimum"
    if len(result.unconstrained):
        text += f"; {len(result.unconstrained)} vertices of parts without a constraint came along"
    return text
