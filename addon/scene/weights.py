"""Weights of vertex groups as arrays."""

import bpy
import numpy as np


def weights_of(obj: bpy.types.Object, group: bpy.types.VertexGroup) -> np.ndarray:
    """The weight of every vertex in a group, (V,); 0 outside."""
    weights = np.zeros(len(obj.data.vertices))
    index = group.index
    for vertex in obj.data.vertices:
        for membership in vertex.groups:
            if membership.group == index:
                weights[vertex.index] = membership.weight
    return weights
