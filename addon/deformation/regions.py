"""Parts of an object, named on the command line: vertex groups and regions."""

import re
from dataclasses import dataclass

import bpy
import numpy as np
from spectral_tv.refusal import Refusal

from ..scene.coordinates import basis_coordinates
from ..scene.weights import add_group

AXES = "xyz"
REGION = re.compile(rf"([{AXES}])\s*([<>])\s*(\d+(?:\.\d*)?)\s*%", re.IGNORECASE)


@dataclass(frozen=True)
class Region:
    """What lies beyond a percentage of an object's bounding box, along an axis of the world."""

    axis: str
    side: str
    percent: float

    @classmethod
    def read(cls, text: str) -> "Region | None":
        """Read such as ``z<10%``; None if it is something else."""
        found = REGION.fullmatch(text.strip())
        if found is None or float(found[3]) > 100:
            return None
        return cls(found[1].lower(), found[2], float(found[3]))

    @property
    def name(self) -> str:
        """The same for every way to write it."""
        return f"{self.axis}{self.side}{self.percent:g}%"

    def members(self, obj: bpy.types.Object) -> np.ndarray:
        """Indices of the vertices of ``obj`` in it."""
        row = np.array(obj.matrix_world)[AXES.index(self.axis)]
        along = basis_coordinates(obj.data) @ row[:3]
        low, high = along.min(), along.max()
        edge = low + self.percent / 100 * (high - low)
        return np.flatnonzero(along < edge if self.side == "<" else along > edge)


def group_of(obj: bpy.types.Object, where: str) -> str:
    """The vertex group of that name, or a new one that holds the region.

    Raises Refusal if there is neither.
    """
    region = Region.read(where)
    for name in (where, where.strip(), region.name if region else where):
        if name in obj.vertex_groups:
            return name
    if region is None:
        raise Refusal(f"there is no vertex group {where!r}; regions are such as 'z<10%' or 'x>90%'")
    members = region.members(obj)
    if not len(members):
        raise Refusal(f"the region {region.name!r} holds no vertex")
    group = add_group(obj, region.name)
    group.add(members.tolist(), 1.0, "REPLACE")
    return group.name
