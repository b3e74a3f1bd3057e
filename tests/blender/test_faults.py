"""Vertices that are refused are named, and can be selected."""

from __future__ import annotations

import math

import bmesh
import bpy
import pytest

NAN = math.nan


def select():
    return bpy.ops.spectral_tv.select_faulty


def selected(obj) -> set[int]:
    """Indices of the selected vertices in Edit Mode."""
    assert obj.mode == "EDIT"
    edited = bmesh.from_edit_mesh(obj.data)
    return {vertex.index for vertex in edited.verts if vertex.select}


def test_vertices_without_a_place_are_selected_and_can_be_given_one(monkey):
    places = {index: monkey.data.vertices[index].co.copy() for index in (7, 20)}
    monkey.data.vertices[7].co.x = NAN
    monkey.data.vertices[20].co.z = NAN
    monkey.data.vertices[20].hide = True
    assert not select().poll()
    with pytest.raises(RuntimeError, match=r"vertex 7 has a coordinate .*so it is with 1 more"):
        bpy.ops.spectral_tv.decompose(method="M1", steps=8)
    assert monkey.data.shape_keys is None
    assert select()() == {"FINISHED"}
    assert selected(monkey) == {7, 20}

    edited = bmesh.from_edit_mesh(monkey.data)
    edited.verts.ensure_lookup_table()
    for index, place in places.items():
        edited.verts[index].co = place
    bmesh.update_edit_mesh(monkey.data)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.spectral_tv.decompose(method="M1", steps=8) == {"FINISHED"}
    assert not select().poll()


def test_vertices_are_no_longer_selected_once_the_mesh_has_others(monkey):
    monkey.data.vertices[3].co.y = NAN
    with pytest.raises(RuntimeError, match="vertex 3 has a coordinate"):
        bpy.ops.spectral_tv.decompose(method="M1", steps=8)
    assert select().poll()
    monkey.data.vertices.add(1)
    assert not select().poll()


def test_a_shape_key_without_a_place_is_no_base(monkey):
    monkey.shape_key_add(name="Basis")
    key = monkey.shape_key_add(name="Smooth", from_mix=False)
    key.data[11].co.x = NAN
    with pytest.raises(RuntimeError, match="shape key 'Smooth' is not finite at vertex 11"):
        bpy.ops.spectral_tv.decompose(method="M3", base="KEY", base_key="Smooth", steps=8)
    select()()
    assert selected(monkey) == {11}


def test_values_that_are_no_numbers_are_selected(monkey):
    attribute = monkey.data.attributes.new("Heat", "FLOAT", "POINT")
    for index in range(len(monkey.data.vertices)):
        attribute.data[index].value = index
    attribute.data[5].value = NAN
    with pytest.raises(RuntimeError, match="'Heat' is not a finite number at vertex 5"):
        bpy.ops.spectral_tv.flow_attribute(kind="ATTRIBUTE", source="Heat")
    select()()
    assert selected(monkey) == {5}


def test_vertices_are_those_of_the_object_that_has_them(monkey):
    other = monkey.copy()
    other.data = monkey.data.copy()
    other.name = "Other"
    bpy.context.collection.objects.link(other)
    other.select_set(True)
    monkey.select_set(True)
    other.data.vertices[9].co.x = NAN
    with pytest.raises(RuntimeError, match="Other: vertex 9 has a coordinate"):
        bpy.ops.spectral_tv.cosegment(segments=2, steps=8)
    assert not select().poll()
    bpy.context.view_layer.objects.active = other
    select()()
    assert selected(other) == {9}
