"""Having Blender's importer of glTF read what is in a file."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from ..scene.surface import NOWHERE
from .digits import FAR


@contextmanager
def read_right() -> Iterator[None]:
    """Have it not mix up custom attributes, and not make 0 of coordinates that are no numbers.

    It goes through a set of the names of attributes, in another order every time, and through a
    list of their values at once.
    """
    module = ModuleType("absent")
    for name in ("gltf2_blender_mesh", "mesh"):  # up to Blender 4.2, and since
        with suppress(ImportError):
            module = import_module(f"io_scene_gltf2.blender.imp.{name}")
    names = vars(module)
    names["set"] = _Ordered
    before = names.get("BinaryData")
    if before is not None:
        names["BinaryData"] = _Numbers(before)
    try:
        yield
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
    """The reader of numbers, which puts vertices far away that are nowhere."""

    def __init__(self, reader: Any) -> None:
        self._reader = reader

    def decode_accessor(self, gltf: Any, place: int, *arguments: Any, **options: Any) -> np.ndarray:
        """The numbers of an accessor."""
        values = self._reader.decode_accessor(gltf, place, *arguments, **options)
        if any(
            place == primitive.attributes.get("POSITION")
            for mesh in gltf.data.meshes or ()
            for primitive in mesh.primitives
        ):
            return np.where(np.abs(values) < NOWHERE, values, np.float32(FAR))
        return values

    def __getattr__(self, name: str) -> Any:
        return getattr(self._reader, name)
