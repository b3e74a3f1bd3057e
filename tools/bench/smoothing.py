"""Blender's Laplacian Smooth modifier on the same object."""

from __future__ import annotations

import bpy
import numpy as np
import spectral_tv

from .meshes import Shape
from .page import Page
from .timing import RUNS, interleaved

REPEATS = (1, 10, 30)
# Larger meshes would take Blender many minutes.
LARGE = 500_000


def report(page: Page, shapes: list[tuple[str, Shape]]) -> None:
    """Print the table."""
    names = " | ".join(f"{count} repeats" for count in REPEATS)
    with page.table(
        "smoothing",
        f"Blender {bpy.app.version_string}'s Laplacian Smooth, and 32 default steps of M1 with "
        f"five bands; medians of {RUNS} interleaved runs",
        f"mesh | vertices | {names} | M1 and bands | ratio to {REPEATS[-1]} repeats",
    ) as row:
        for name, shape in shapes:
            if len(shape[0]) >= LARGE:
                continue
            modifier = LaplacianSmooth(shape)

            def bands(shape: Shape = shape) -> None:
                split = spectral_tv.decompose(spectral_tv.Mesh(*shape), "m1")
                split.bands(split.band_edges(5))

            *smoothed, seconds = interleaved(
                *(lambda count=count, it=modifier: it.evaluate(count) for count in REPEATS), bands
            )
            row(
                name, len(shape[0]), *(f"{taken:.2f} s" for taken in smoothed),
                f"{seconds:.2f} s", f"{smoothed[-1] / seconds:.1f}",
            )  # fmt: skip


class LaplacianSmooth:
    """An object with the modifier, alone in Blender's scene."""

    def __init__(self, shape: Shape) -> None:
        """Make the object."""
        bpy.ops.wm.read_factory_settings(use_empty=True)
        vertices, triangles = shape
        mesh = bpy.data.meshes.new("Shape")
        mesh.from_pydata(vertices.astype(np.float32), [], triangles)
        self.object = bpy.data.objects.new("Shape", mesh)
        bpy.context.collection.objects.link(self.object)
        self.modifier = self.object.modifiers.new("Smooth", "LAPLACIANSMOOTH")

    def evaluate(self, repeats: int) -> None:
        """Have Blender evaluate the object anew."""
        self.modifier.iterations = repeats
        self.object.update_tag()
        graph = bpy.context.evaluated_depsgraph_get()
        graph.update()
        evaluated = self.object.evaluated_get(graph).data
        if len(evaluated.vertices) != len(self.object.data.vertices):
            raise RuntimeError("the modifier was not evaluated")
