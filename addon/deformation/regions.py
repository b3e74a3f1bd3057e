"""Parts of an object, named on the command line: vertex groups and regions."""

import bpy
import numpy as np
from spectral_tv.deformation.regions import EXAMPLES, Region
from spectral_tv.refusal import Refusal

from ..scene.coordinates import basis_coordinates
from ..scene.weights import add_group


def group_of(obj: bpy.types.Object, where: str) -> str:
    """The vertex group of that name, or a new one that holds the region.

    Raises Refusal if there is neither.
    """
    region = Region.read(where)
    for name in (where, where.strip(), region.name if region else where):
        if name in obj.vertex_groups:
            return name
    if region is None:
        raise Refusal(f"there is no vertex group {where!r}; {EXAMPLES}")
    row = np.array(obj.matrix_world)[region.place]
    members = region.members(basis_coordinates(obj.data) @ row[:3])
    if not len(members):
        raise Refusal(f"the region {region.name!r} holds no vertex")
    group = add_group(obj, region.name)
    group.add(members.tolist(), 1.0, "REPLACE")
    return group.name
