"""Objects of files of before: they keep the algorithm that they had."""

import bpy

from .constraints import deformation_of

# Until Pose came it was the first choice, which files do not hold where nothing else was chosen.
FORMER = "CONVEX"


def keep_algorithms() -> None:
    """Choose what objects had by default whose constraints are of before.

    Constraints of today write the algorithm down.
    """
    for obj in bpy.data.objects:
        deformation = deformation_of(obj)
        if deformation.constraints and not deformation.is_property_set("algorithm"):
            deformation.algorithm = FORMER
            for constraint in deformation.constraints:
                if constraint.follows_bone and not constraint.is_property_set("turns"):
                    constraint.turns = True
