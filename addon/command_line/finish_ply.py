"""Rewriting PLY files that Blender wrote: vertices in their order, with doubles, relative to 0."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from spectral_tv.dataclass import dataclass
from spectral_tv.files import ply_table
from spectral_tv.files.ply import AXES
from spectral_tv.files.ply_table import Table
from spectral_tv.notes import note

from ..scene.arrays import corner_vertices, numbers
from ..scene.coordinates import coordinates
from .contents import loose_edges
from .digits import Digits, are_coarse, are_nowhere, decimals_of, fine_decimals

NORMALS = ("nx", "ny", "nz")
# Relative to the largest coordinate, how far what is in a file may be from what is seen.
SAME = 1e-5


@dataclass(frozen=True)
class Exact:
    """The vertices of a file in double precision, (V, 3), and as Blender holds them."""

    points: np.ndarray
    held: np.ndarray

    def of(self, count: int) -> "Exact | None":
        """That of so many vertices: all, or those that are somewhere; None if it is neither."""
        if count == len(self.points):
            return self
        is_there = ~are_nowhere(self.points)
        found = Exact(self.points[is_there], self.held[is_there])
        return found if len(found.points) == count else None

    def placed(self, points: np.ndarray) -> np.ndarray:
        """Vertices in the axes of the file with the digits that Blender lost."""
        lost = np.where(np.isfinite(self.points), self.points - self.held, np.nan)
        is_there = (points == self.held) | ~np.isfinite(points)
        return np.where(is_there, self.points, points + lost)


@dataclass(frozen=True)
class Look:
    """A PLY file that was read: its format and comments, and what its vertices have.

    ``exact`` is where they are, if Blender read them into one object.
    """

    format: str
    comments: tuple[bytes, ...] = ()
    columns: frozenset[str] = frozenset()
    exact: Exact | None = None


def finish(path: Path, digits: Digits, look: Look | None, is_single: bool) -> None:
    """Write a PLY file of what is seen anew, like the one that it came from, if there is one.

    Vertices come in their order, those that are split at the seams of UV maps behind all others.
    ``is_single`` says that there is one object in it.
    """
    table = ply_table.read(path)
    scene = _seen(table)
    if scene is not None:
        _put_in_order(table, scene)
        _set_normals(table, scene)
    elif "s" in table.columns:
        note("its vertices may be in another order")
    if look is not None and "red" in look.columns and "alpha" not in look.columns:
        table.columns.pop("alpha", None)
    if digits.is_moved or digits.is_double:
        _set_points(table, digits, look.exact if look is not None and is_single else None)
    elif scene is not None and are_coarse(scene.points) is not None:
        points = scene.points[scene.sources].round(fine_decimals(scene.points))
        table.columns |= dict(zip(AXES, points.T, strict=True))
    table.write(path, look.format if look is not None else None, look.comments if look else ())


@dataclass(frozen=True)
class _Seen:
    """What is seen of all meshes as one: where vertices are, those of corners and loose edges.

    ``sources`` (N,) tells which vertex each in the file is. ``normals`` (V, 3) are the custom
    ones, 0 where there are none.
    """

    points: np.ndarray
    corners: np.ndarray
    sizes: np.ndarray
    edges: np.ndarray
    normals: np.ndarray
    sources: np.ndarray


def _seen(table: Table) -> _Seen | None:
    """What a file shows; None if it is not known."""
    tries: tuple[Callable[[bpy.types.DepsgraphObjectInstance], bool], ...] = (
        lambda _item: True,
        lambda item: not item.is_instance,
        lambda item: not item.is_instance and item.object.original.select_get(),
    )
    for is_wanted in tries:
        found = _together(is_wanted)
        if found is not None and np.array_equal(found.sizes, table.faces.sizes):
            sources = _sources(table, found)
            if sources is not None:
                return replace(found, sources=sources)
    return None


def _together(is_wanted: Callable[[bpy.types.DepsgraphObjectInstance], bool]) -> _Seen | None:
    points, corners, sizes, edges, normals, count = [], [], [], [], [], 0
    for item in bpy.context.evaluated_depsgraph_get().object_instances:
        if item.object.type != "MESH" or not item.show_self or not is_wanted(item):
            continue
        mesh, matrix = item.object.data, np.array(item.matrix_world)
        own = coordinates(mesh.vertices).reshape(-1, 3).astype(np.float64)
        points.append(own @ matrix[:3, :3].T + matrix[:3, 3])
        corner = corner_vertices(mesh)
        size = numbers(mesh.polygons, "loop_total")
        normals.append(_normals(mesh, corner, matrix))
        corners.append(corner.astype(np.int64) + count)
        sizes.append(size)
        edges.append(loose_edges(mesh) + count)
        count += len(own)
    if not points:
        return None
    joined = (np.concatenate(each) for each in (points, corners, sizes, edges, normals))
    return _Seen(*joined, np.zeros(0, dtype=np.int64))


def _normals(mesh: bpy.types.Mesh, corners: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """The custom normals of a mesh, one for each vertex, in the world; 0 where there are none."""
    sums = np.zeros((len(mesh.vertices), 3))
    if not mesh.has_custom_normals:
        return sums
    flat = np.empty(3 * len(corners), dtype=np.float32)
    mesh.corner_normals.foreach_get("vector", flat)
    for axis, values in enumerate(flat.reshape(-1, 3).T):
        sums[:, axis] = np.bincount(corners, values, len(sums))
    turned = sums @ np.linalg.pinv(matrix[:3, :3])
    length = np.linalg.norm(turned, axis=1, keepdims=True)
    return np.divide(turned, length, out=np.zeros_like(turned), where=length > 0)


def _sources(table: Table, seen: _Seen) -> np.ndarray | None:
    """Which vertex of those seen each in the file is; None if that cannot be told."""
    count = len(table.columns["x"])
    sources = np.full(count, -1, dtype=np.int64)
    sources[table.faces.corners] = seen.corners
    if not np.array_equal(sources[table.faces.corners], seen.corners):
        return None
    loose = np.ones(len(seen.points), dtype=bool)
    loose[seen.corners] = False
    if loose.sum() != (sources < 0).sum():
        return None
    sources[sources < 0] = np.flatnonzero(loose)
    there = np.column_stack([table.columns[axis] for axis in AXES]).astype(np.float64)
    apart = np.abs(there - seen.points[sources])
    largest = np.abs(there[np.isfinite(there)]).max(initial=0.0)
    return None if (apart > SAME * largest + 1e-30).any() else sources


def _put_in_order(table: Table, seen: _Seen) -> None:
    _, firsts = np.unique(seen.sources, return_index=True)
    more = np.ones(len(seen.sources), dtype=bool)
    more[firsts] = False
    doubled = np.flatnonzero(more)
    doubled = doubled[np.argsort(seen.sources[doubled], kind="stable")]
    if len(doubled):
        note(
            f"{len(doubled)} vertices were doubled at the seams of UV maps, behind all others, as "
            "a .ply holds one place in them for each"
        )
    order = np.concatenate([firsts, doubled])
    if np.array_equal(order, np.arange(len(order))):
        return
    new = np.empty(len(order), dtype=np.int64)
    new[order] = np.arange(len(order))
    table.columns = {name: values[order] for name, values in table.columns.items()}
    table.faces.corners[:] = new[table.faces.corners]
    # With UV maps Blender writes edges as if no vertex had been doubled.
    table.edges = seen.edges if len(seen.edges) == len(table.edges) else new[table.edges]
    seen.sources[:] = seen.sources[order]


def _set_normals(table: Table, seen: _Seen) -> None:
    if not set(NORMALS) <= set(table.columns):
        return
    normals = seen.normals[seen.sources]
    is_own = normals.any(axis=1)
    for own, name in zip(normals.astype(np.float32).T, NORMALS, strict=True):
        table.columns[name] = np.where(is_own, own, table.columns[name])


def _set_points(table: Table, digits: Digits, exact: Exact | None) -> None:
    read = np.column_stack([table.columns[axis] for axis in AXES]).astype(np.float64)
    points = read + digits.offset
    if digits.is_moved:
        points = points.round(decimals_of(read))
    exact = exact.of(len(read)) if exact is not None else None
    if exact is not None:
        placed = exact.placed(read)
        is_rounded = digits.is_moved & (placed != exact.points) & np.isfinite(read)
        points = np.where(is_rounded, points, placed)
    for axis, name in enumerate(AXES):
        table.columns[name] = points[:, axis]
