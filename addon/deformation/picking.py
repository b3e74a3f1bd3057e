"""Patches of an object around places that are pointed at where the object is shown."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
from mathutils import Vector
from mathutils.interpolate import poly_3d_calc
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..drawing.pointing import shown_mesh
from ..scene import mix
from ..scene.mirroring import mirrored
from ..scene.modifiers import symmetries
from ..scene.surface import Surface
from .constraints import deformation_of
from .geodesics import Links, Spread
from .handles import group_weights

# The radius of a patch that nobody drew, relative to the diagonal of the object's bounding box.
USUAL = 0.1


class Patches:
    """The surface of an object, and what is free on it.

    Patches are masks (N,) of the surface's vertices. Distances are along the Basis shape, in
    units of the scene.
    """

    def __init__(self, obj: bpy.types.Object) -> None:
        """Read ``obj``; raises Refusal or spectral_tv.MeshError if its surface cannot be used."""
        self._surface = Surface.read(obj)
        mesh = self._surface.mesh
        self._links = Links.of(mesh.vertices, mesh.triangles)
        corners = mesh.vertices[mesh.triangles.ravel()]
        self.usual_radius = USUAL * float(np.linalg.norm(np.ptp(corners, axis=0)))
        self._held = self._constrained(obj, ["PIN"])
        self._pulled = self._constrained(obj, ["OBJECT", "KEY"])

    def around(self, obj: bpy.types.Object, polygon: int, point: Vector) -> Spread:
        """The patch around a ``point`` in object space on a polygon of what is shown of ``obj``.

        Raises Refusal if that is on no part of the surface.
        """
        shown = shown_mesh(obj)
        if len(shown.vertices) == len(obj.data.vertices) and (
            len(shown.polygons) == len(obj.data.polygons)
        ):
            return self._around_corners(shown, polygon, point)
        return self._around_nearest(obj, point)

    def nearest(self, obj: bpy.types.Object, point: Vector) -> Spread:
        """The patch around what is shown nearest to a ``point`` in the world."""
        local = obj.matrix_world.inverted_safe() @ point
        graph = bpy.context.evaluated_depsgraph_get()
        shown_mesh(obj)
        is_found, place, _, polygon = obj.closest_point_on_mesh(local, depsgraph=graph)
        if not is_found:
            raise Refusal("no place on it is nearest to that point")
        return self.around(obj, polygon, place)

    def free(self, patch: np.ndarray, is_pulled: bool, others: Iterable[np.ndarray]) -> np.ndarray:
        """What of a patch can be held, or pulled, beside the object's constraints and ``others``.

        What is held can be held twice; what is pulled goes to one place alone.
        """
        taken = self._pulled | self._held if is_pulled else self._pulled
        return patch & ~np.logical_or.reduce([taken, *others])

    def vertices(self, patch: np.ndarray) -> np.ndarray:
        """Indices of the object's vertices in a patch; in its mirror image, too."""
        places = self._surface.copies.places
        return np.flatnonzero((patch[places] & (places >= 0)).any(axis=0))

    def _constrained(self, obj: bpy.types.Object, kinds: Iterable[str]) -> np.ndarray:
        """Where constraints of some kinds have vertices, (N,)."""
        places = self._surface.copies.places
        names = {
            each.vertex_group for each in deformation_of(obj).constraints if each.kind in kinds
        }
        mask = np.zeros(len(self._surface.mesh.vertex_areas), dtype=bool)
        for found, _ in group_weights(obj, names & {*obj.vertex_groups.keys()}).values():
            mine = places[:, found]
            mask[mine[mine >= 0]] = True
        return mask

    def _around_corners(self, shown: bpy.types.Mesh, polygon: int, point: Vector) -> Spread:
        corners = np.array(shown.polygons[polygon].vertices)
        shares = poly_3d_calc([shown.vertices[int(corner)].co for corner in corners], point)
        places = self._surface.place[corners]
        is_there = places >= 0
        if not is_there.any():
            raise Refusal("that face has no finite place")
        rest = self._surface.mesh.vertices[places[is_there]]
        middle = np.average(rest, axis=0, weights=np.maximum(np.array(shares)[is_there], 1e-9))
        return Spread(self._links, places[is_there], np.linalg.norm(rest - middle, axis=1))

    def _around_nearest(self, obj: bpy.types.Object, point: Vector) -> Spread:
        """Modifiers made what is shown: around the vertex, or its mirror image, that is nearest."""
        copies = mirrored(obj, mix.shown(obj), symmetries(obj))
        away = np.linalg.norm(copies.positions - np.array(point), axis=1)
        away[np.setdiff1d(np.arange(len(away)), copies.places[:, self._surface.place >= 0])] = (
            np.inf
        )
        is_nearest = (copies.places == np.nanargmin(away)).any(axis=0)
        seeds = self._surface.place[is_nearest & (self._surface.place >= 0)]
        return Spread(self._links, seeds, np.zeros(len(seeds)))
