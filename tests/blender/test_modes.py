"""In the modes of Blender: what is written stays, or is refused."""

from __future__ import annotations

import bpy
import pytest
from ball import ball
from contents import contents


@pytest.mark.parametrize("mode", ["SCULPT", "WEIGHT_PAINT", "VERTEX_PAINT"])
def test_results_outlive_modes_of_painting(mode):
    ball("Ball")
    bpy.ops.object.mode_set(mode=mode)
    bpy.ops.ed.undo_push(message="before")
    before = contents()
    decompose, cosegment = bpy.ops.spectral_tv.decompose, bpy.ops.spectral_tv.cosegment
    decompose("EXEC_DEFAULT", True, bands=3, steps=8)
    middle = contents()
    cosegment("EXEC_DEFAULT", True, segments=3, steps=8, outputs={"FACE_SETS", "GROUPS", "COLOR"})
    after = contents()
    bpy.ops.ed.undo()
    assert contents() == middle
    bpy.ops.ed.undo()
    assert contents() == before
    assert bpy.context.object.mode == mode
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert contents() == after
    bpy.ops.object.mode_set(mode="OBJECT")
    assert contents() == after


def test_dyntopo_is_refused():
    """It has vertices of its own, and makes the mesh anew of them in the end."""
    ball("Ball")
    bpy.ops.object.mode_set(mode="SCULPT")
    bpy.ops.sculpt.dynamic_topology_toggle()
    with pytest.raises(RuntimeError, match="Turn Dyntopo off first"):
        bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    bpy.ops.sculpt.dynamic_topology_toggle()
    assert bpy.ops.spectral_tv.decompose(bands=3, steps=8) == {"FINISHED"}


@pytest.mark.parametrize("name", ["decompose", "cosegment", "constraint_add", "split_segments"])
def test_a_mesh_in_edit_mode_as_that_of_another_object_is_refused(name):
    """Leaving Edit Mode writes that mode's own mesh over all that came meanwhile."""
    obj = ball("Ball")
    twin = bpy.data.objects.new("Twin", obj.data)
    bpy.context.scene.collection.objects.link(twin)
    bpy.context.view_layer.objects.active = twin
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.view_layer.objects.active = obj
    assert obj.mode == "OBJECT"
    before = contents()
    with pytest.raises(RuntimeError, match="in Edit Mode as that of another object"):
        getattr(bpy.ops.spectral_tv, name)()
    assert contents() == before
    bpy.context.view_layer.objects.active = twin
    bpy.ops.object.mode_set(mode="OBJECT")
