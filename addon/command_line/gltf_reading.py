"""Mending what Blender's importer of glTF reads wrongly or leaves out."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from types import ModuleType
from typing import Any

import bpy
import numpy as np
from spectral_tv.notes import note

from ..scene.surface import NOWHERE
from .digits import FAR

# Of a primitive, as is the default.
TRIANGLES = 4


@contextmanager
def read_right() -> Iterator[None]:
    """Mend the importer: custom attributes keep their values, bad coordinates do not become 0.

    Triangles that it leaves out are noted. The importer goes through a set of the names of
    attributes, in another order every time, and at the same time through a list of their values.
    So the set is exchanged for one that keeps its order.
    """
    module = ModuleType("absent")
    for name in ("gltf2_blender_mesh", "mesh"):  # up to Blender 4.2, and since
        with suppress(ImportError):
            module = import_module(f"io_scene_gltf2.blender.imp.{name}")
    names = vars(module)
    names["set"] = _Ordered
    before = names.get("BinaryData")
    numbers = _Numbers(before)
    if before is not None:
        names["BinaryData"] = numbers
    try:
        yield
        numbers.tell_lost()
    finally:
        del names["set"]
        if before is not None:
            names["BinaryData"] = before


class _Ordered(dict[str, None]):
    """A set that keeps the order in which things were added to it."""

    def __init__(self, items: Any = ()) -> None:
        super().__init__(dict.fromkeys(items))

    def update(self, items: Any) -> None:
        super().update(dict.fromkeys(items))


class _Numbers:
    """The importer's reader of numbers; it moves vertices without a finite place far away."""

    def __init__(self, reader: Any) -> None:
        self._reader = reader
        self._triangles = 0

    def decode_accessor(self, gltf: Any, place: int, *arguments: Any, **options: Any) -> np.ndarray:
        """The numbers of an accessor."""
        values = self._reader.decode_accessor(gltf, place, *arguments, **options)
        primitives = [each for mesh in gltf.data.meshes or () for each in mesh.primitives]
        has_points = [each for each in primitives if place == each.attributes.get("POSITION")]
        # Without indices the corners are the vertices in turn.
        corners = [each for each in primitives if place == each.indices]
        corners += [each for each in has_points if each.indices is None]
        if any(each.mode in (None, TRIANGLES) for each in corners):
            self._triangles += len(values) // 3
        if has_points:
            return np.where(np.abs(values) < NOWHERE, values, np.float32(FAR))
        return values

    def tell_lost(self) -> None:
        """Note how many triangles did not come in; of strips and fans it is not known."""
        meshes = {obj.data for obj in bpy.data.objects if obj.type == "MESH"}
        lost = self._triangles - sum(len(mesh.polygons) for mesh in meshes)
        if lost > 0:
            note(
                f"{lost} of {self._triangles} faces were left out, as Blender does not read those "
                "that have a vertex twice or the vertices of another face"
            )

    def __getattr__(self, name: str) -> Any:
        return getattr(self._reader, name)
