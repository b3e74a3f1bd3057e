"""How bands and masks of one object become those of another."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from functools import cached_property

import bpy
import spectral_tv
from spectral_tv.bands.taking import TakeSettings, told_fit
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene import lengths, mix, results
from ..scene.applied import SELECTED
from ..scene.contents import topology_digest
from ..scene.modes import show_vertices
from ..scene.records import all_bands_of, bands_of, record_of
from ..scene.surface import Surface

# What shape keys that were taken are results of: bands by their numbers.
TAKEN = "TAKEN"


def corresponding(
    obj: bpy.types.Object, source: bpy.types.Object, settings: TakeSettings
) -> SameVertices | NearestSurface:
    """The way from ``source`` to ``obj``: by the vertices if they are the same, or by the surface.

    Raises Refusal, or spectral_tv.MeshError if one of them cannot be read.
    """
    if topology_digest(obj.data) == topology_digest(source.data):
        return SameVertices(obj, source)
    return NearestSurface.found(obj, source, settings)


@dataclass(frozen=True)
class SameVertices:
    """Of two objects with the same vertices and faces. Directions are kept in the world, lengths
    relative to the sizes of the objects."""

    obj: bpy.types.Object
    source: bpy.types.Object

    @cached_property
    def area(self) -> float:
        """That of the object, in the world."""
        record = record_of(self.obj)
        return Surface.read(self.obj).mesh.area if record is None else record.area

    @property
    def scale(self) -> float:
        """How much longer things of the source become in the world."""
        return float(np.sqrt(self.area / record_of(self.source).area))

    def vectors(self, moved: np.ndarray) -> np.ndarray:
        """Displacements (V, 3) of the source in its space, as those of the object in its own."""
        own, other = (each.matrix_world.to_3x3() for each in (self.obj, self.source))
        return moved @ (self.scale * np.array(own.inverted_safe() @ other)).T

    def values(self, values: np.ndarray) -> np.ndarray:
        """Values (V,) of the source's vertices at those of the object."""
        return values

    def tell(self, _sizes: Mapping[int, float]) -> str:
        """Note what was lost, and say what was done."""
        return ""


@dataclass(frozen=True)
class NearestSurface:
    """Of two objects in about the same place: by the nearest surface, turned as that is."""

    obj: bpy.types.Object
    source: bpy.types.Object
    own: Surface
    other: Surface
    taken: spectral_tv.Transfer
    reach: float
    is_fitted: bool

    @classmethod
    def found(
        cls, obj: bpy.types.Object, source: bpy.types.Object, settings: TakeSettings
    ) -> NearestSurface:
        """Look for the surface of one at the vertices of the other, both without their bands."""
        before = [*all_bands_of(obj), *(key for _, key, _ in results.keys_written(obj, TAKEN))]
        own = Surface.read(obj, mix.shown(obj, before))
        bands = [band for band in bands_of(source) if band is not None]
        other = Surface.read(source, mix.shown(source, bands))
        shift = source.matrix_world.translation - obj.matrix_world.translation
        reach = settings.within / 100 * float(np.sqrt(own.mesh.area))
        with warnings.catch_warnings():  # reading it has told them
            warnings.simplefilter("ignore", spectral_tv.MeshWarning)
            there = spectral_tv.Mesh(other.mesh.vertices + np.array(shift), other.mesh.triangles)
        taken = spectral_tv.transfer(there, own.mesh, reach, settings.fit)
        if taken.missed[own.place[own.place >= 0]].all():
            hint = "" if settings.fit != "none" else ", or have it fitted first"
            raise Refusal(
                f"{source.name} is nowhere within {lengths.told(reach)} of it facing as it does; "
                f"raise Within, bring them together{hint}"
            )
        return cls(obj, source, own, other, taken, reach, settings.fit != "none")

    @property
    def area(self) -> float:
        """That of the object, in the world."""
        return self.own.mesh.area

    @property
    def scale(self) -> float:
        """How much longer things of the source become in the world."""
        return self.taken.scale

    def vectors(self, moved: np.ndarray) -> np.ndarray:
        """Displacements (V, 3) of the source in its space, as those of the object in its own."""
        found = self.taken.vectors(self.other.merge_vectors(moved))
        return self.own.to_object(found[np.newaxis])[0]

    def values(self, values: np.ndarray) -> np.ndarray:
        """Values (V,) of the source's vertices at those of the object."""
        found = self.taken.values(self.other.merge(values[:, np.newaxis]))
        return self.own.to_vertices(found)[:, 0]

    def tell(self, sizes: Mapping[int, float]) -> str:
        """Note what was lost, select it, and say what was done.

        ``sizes`` are those of the largest features of the bands, by their numbers.
        """
        missed = self.own.to_vertices(self.taken.missed.astype(float)) > 0
        missed |= self.own.place < 0
        count = np.count_nonzero(missed)
        if count:
            _select(self.obj.data, missed)
            what = "1 vertex is" if count == 1 else f"{count} vertices are"
            note(
                f"{what} missed, as {self.source.name} is farther than {lengths.told(self.reach)} "
                "there or faces another way: selected, and the bands fade there"
            )
        edge = _edge(self.own.mesh)
        finer = [band for band, size in sizes.items() if self.scale * size < edge]
        if finer:
            what = "band {0} is" if len(finer) == 1 else "bands {0} to {1} are"
            note(
                f"{what.format(finer[0], finer[-1])} finer than the faces of {self.obj.name}, "
                f"whose edges are {lengths.told(edge)} long in the mean and show it in part"
            )
        if not self.is_fitted:
            return ", by the nearest surface"
        deviation = lengths.told(self.taken.deviation)
        return (
            f", by the nearest surface, {told_fit(self.taken)} to within {deviation} in the median"
        )


def _edge(mesh: spectral_tv.Mesh) -> float:
    """The mean length of the edges of triangles."""
    corners = mesh.vertices[mesh.triangles]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())


def _select(mesh: bpy.types.Mesh, chosen: np.ndarray) -> None:
    """Have vertices (V,) be selected, and no others, once Edit Mode begins."""
    show_vertices()
    for name in SELECTED:
        # The fields of vertices and edges would do, but Blender 5.0 ends at those of edges that the
        # evaluated mesh shares.
        if name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[name])
    mesh.attributes.new(SELECTED[0], "BOOLEAN", "POINT").data.foreach_set("value", chosen)
