"""The kinds of results on a sphere, and what users do to them."""

from __future__ import annotations

from typing import ClassVar

import bpy
import numpy as np
import pytest
from ball import object_of
from shapes import icosphere

VERTICES, FACES = icosphere(3)
CAP = VERTICES[:, 2] > 0.5
flow = bpy.ops.spectral_tv.flow_attribute
FEW = {"steps": 4}


@pytest.fixture
def sphere():
    """A unit sphere with a vertex group, a float attribute and a shape key, each of its cap."""
    obj = object_of("Sphere", VERTICES, FACES)
    mesh = obj.data
    obj.vertex_groups.new(name="Cap").add(np.flatnonzero(CAP).tolist(), 1, "REPLACE")
    mesh.attributes.new("Mask", "FLOAT", "POINT").data.foreach_set("value", CAP.astype(np.float32))
    obj.shape_key_add(name="Basis")
    lift = obj.shape_key_add(name="Lift", from_mix=False)
    for vertex in np.flatnonzero(CAP).tolist():
        lift.data[vertex].co.z += 0.5
    yield obj
    bpy.data.batch_remove([*bpy.data.texts, *bpy.data.images])


def told(capfd) -> str:
    return capfd.readouterr().out


class Group:
    """Vertex groups, as the three kinds of results are handled below."""

    source: ClassVar = {"kind": "GROUP", "source": "Cap"}
    result = "Cap Flow"

    @staticmethod
    def all(obj):
        return obj.vertex_groups

    @staticmethod
    def new(obj, name):
        group = obj.vertex_groups.new(name=name)
        group.add([0, 1], 0.25, "REPLACE")
        return group

    @staticmethod
    def values(obj, name):
        index = obj.vertex_groups[name].index
        return [sum(m.weight for m in v.groups if m.group == index) for v in obj.data.vertices]

    @staticmethod
    def change(obj, name):
        obj.vertex_groups[name].add([5], 0.75, "REPLACE")

    @staticmethod
    def lock(obj, name):
        obj.vertex_groups[name].lock_weight = True


class Attribute:
    """Float attributes."""

    source: ClassVar = {"kind": "ATTRIBUTE", "source": "Mask"}
    result = "Mask Flow"

    @staticmethod
    def all(obj):
        return obj.data.attributes

    @staticmethod
    def new(obj, name):
        attribute = obj.data.attributes.new(name, "FLOAT", "POINT")
        attribute.data[0].value = 0.25
        return attribute

    @staticmethod
    def values(obj, name):
        return [point.value for point in obj.data.attributes[name].data]

    @staticmethod
    def change(obj, name):
        obj.data.attributes[name].data[5].value = 0.75


class Key:
    """Shape keys."""

    source: ClassVar = {"kind": "KEY", "source": "Lift"}
    result = "Lift Flow"

    @staticmethod
    def all(obj):
        return obj.data.shape_keys.key_blocks

    @staticmethod
    def new(obj, name):
        key = obj.shape_key_add(name=name, from_mix=False)
        key.data[0].co.z += 0.25
        return key

    @staticmethod
    def values(obj, name):
        return [tuple(point.co) for point in obj.data.shape_keys.key_blocks[name].data]

    @staticmethod
    def change(obj, name):
        obj.data.shape_keys.key_blocks[name].data[5].co.x += 0.01

    @staticmethod
    def lock(obj, name):
        obj.data.shape_keys.key_blocks[name].lock_shape = True


each_kind = pytest.mark.parametrize("kind", [Group, Attribute, Key])
