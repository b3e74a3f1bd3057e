"""Blender's Laplacian Deform modifier on a mesh one end of which is turned."""

from __future__ import annotations

import time

import bpy
import numpy as np
from mathutils import Matrix

from .turn import Turn


class LaplacianDeform:
    """An object with the modifier; a hook before it moves the handle along with an empty."""

    def __init__(self, turn: Turn, iterations: int) -> None:
        """Take the mesh of a task."""
        self.turn, self.iterations = turn, iterations
        self.name = f"Laplacian Deform, {iterations}"
        self.object = self.empty = None

    def prepare(self) -> float:
        """Make the object anew, and have the modifier take its shape; the seconds of the latter."""
        self.remove()
        turn = self.turn
        mesh = bpy.data.meshes.new(self.name)
        mesh.from_pydata(turn.vertices.astype(np.float32), [], turn.triangles)
        self.object = bpy.data.objects.new(self.name, mesh)
        self.empty = bpy.data.objects.new("Handle", None)
        for each in (self.object, self.empty):
            bpy.context.scene.collection.objects.link(each)
        handle = turn.indices[turn.is_handle]
        for name, members in (("Anchors", turn.indices), ("Handle", handle)):
            self.object.vertex_groups.new(name=name).add(members.tolist(), 1.0, "REPLACE")
        hook = self.object.modifiers.new("Hook", "HOOK")
        hook.object, hook.vertex_group, hook.falloff_type = self.empty, "Handle", "NONE"
        hook.matrix_inverse = Matrix.Identity(4)
        modifier = self.object.modifiers.new("Deform", "LAPLACIANDEFORM")
        modifier.vertex_group, modifier.iterations = "Anchors", self.iterations
        bpy.context.view_layer.update()
        started = time.perf_counter()
        with bpy.context.temp_override(object=self.object, active_object=self.object):
            bpy.ops.object.laplaciandeform_bind(modifier=modifier.name)
        seconds = time.perf_counter() - started
        if not modifier.is_bind:
            raise RuntimeError("the modifier could not be bound")
        return seconds

    def step(self, targets: np.ndarray) -> None:
        """Move the handle rigidly to its targets (K, 3), and have Blender evaluate the object."""
        self.empty.matrix_world = Matrix(self.turn.motion(targets))
        bpy.context.view_layer.update()

    solve = step  # it starts from the bound shape each time

    @property
    def shape(self) -> np.ndarray:
        """What Blender shows, (V, 3)."""
        data = self.object.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        flat = np.empty(3 * len(data.vertices), dtype=np.float32)
        data.vertices.foreach_get("co", flat)
        return flat.reshape(-1, 3).astype(float)

    def remove(self) -> None:
        """Take the object away."""
        if self.object is not None:
            bpy.data.meshes.remove(self.object.data)  # the object goes along
            bpy.data.objects.remove(self.empty)
            self.object = self.empty = None
