"""The surface with the UVs, and what a map shows at its texels."""

from __future__ import annotations

from collections.abc import Callable

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..scene import lengths
from ..scene.modifiers import between
from ..scene.places import linear_of, world_scale
from ..scene.temporary import Temporary
from .settings import NORMAL, OBJECT, MapSettings
from .sources import Moved, Seen, mesh_seen
from .texels import Places, distance_between, own_places, places_met
from .triangles import Triangles, flat_share, shaped
from .uv_maps import ensure_usable, tell_overlap, uv_map_of

# How much farther rays look than the surfaces were found to be apart, by some points of both.
LEEWAY = 1.5

Show = Callable[[float], None]


@dataclass(frozen=True)
class Surface:
    """Triangles with UVs in object space, and the places of their texels on them.

    ``shown`` gives what the map shows of some texels, in that space: displacements (N, 3), or
    normals.
    """

    triangles: Triangles
    uv_map: str
    places: Places
    shown: Callable[[slice], np.ndarray]


def own_surface(obj: bpy.types.Object, asked: MapSettings, show: Show) -> Surface:
    """That of an object itself, without its bands; raises Refusal."""
    with Temporary() as now:
        found = Moved.of(obj, asked)
        names = between(obj)
        if names:
            note(f"it is baked before {listed(names)}")
        mesh = now.made(shaped(obj, found.original))
        triangles, uv_map = _with_uvs(mesh, asked)
        show(0.2)
        places = own_places(triangles, asked.size * asked.samples)
        tell_overlap(triangles, places)
        if asked.kind == NORMAL:
            look = now.made(shaped(obj, found.original + found.moved))
            corners = triangles.normals_in(look)
        else:
            corners = found.moved[triangles.vertices]
        _tell_coarse(len(found.original), places, asked)
        return Surface(triangles, uv_map, places, lambda chosen: places.values(corners, chosen))


def other_surface(
    obj: bpy.types.Object, target: bpy.types.Object, asked: MapSettings, show: Show
) -> Surface:
    """That of another object, as it is seen, and the surface of the first around it.

    A displacement leads from a texel's place to where its ray meets the surface; that of a band is
    how the band moves this point. Raises Refusal.
    """
    with Temporary() as now:
        triangles, uv_map = _with_uvs(now.made(mesh_seen(target)), asked)
    matrix = _between(obj, target)
    seen = Seen.of(obj, asked)
    source = seen.triangles.moved(matrix)
    show(0.2)
    distance = _distance(triangles, source, target, asked)
    side = asked.size * asked.samples
    own = own_places(triangles, side)
    tell_overlap(triangles, own)
    show(0.4)
    met = places_met(triangles, source, side, distance)
    texels = np.intersect1d(own.texels, met.texels, assume_unique=True)
    _tell_missed(obj, own, texels, lengths.told(distance * world_scale(target)))
    own, met = own.among(texels), met.among(texels)
    _tell_coarse(len(source.positions), own, asked)
    if asked.kind == NORMAL:
        return Surface(triangles, uv_map, own, lambda each: met.values(source.normals, each))
    if seen.moved is not None:
        moved = (seen.moved @ matrix[:3, :3].T)[source.vertices]
        return Surface(triangles, uv_map, own, lambda each: met.values(moved, each))
    start, end = triangles.positions[triangles.vertices], source.positions[source.vertices]
    return Surface(
        triangles, uv_map, own, lambda each: met.values(end, each) - own.values(start, each)
    )


def _between(obj: bpy.types.Object, target: bpy.types.Object) -> np.ndarray:
    """What leads from the space of one object to that of another, (4, 4)."""
    for each in (target, obj):
        linear_of(each.matrix_world, each.name)
    matrices = [np.array(each.matrix_world, dtype=np.float64) for each in (target, obj)]
    return np.linalg.solve(*matrices)


def _with_uvs(mesh: bpy.types.Mesh, asked: MapSettings) -> tuple[Triangles, str]:
    """The triangles of a mesh with its UVs, and the name of these; raises Refusal."""
    uv_map = uv_map_of(mesh)
    triangles = Triangles.of(mesh, uv_map)
    ensure_usable(triangles)
    flat = flat_share(mesh)
    if flat and asked.kind != OBJECT:
        note(
            f"{flat:.0%} of the faces that have the UVs are shaded flat: the map jumps at their "
            "edges, as normals do; Shade Smooth goes without"
        )
    return triangles, uv_map


def _distance(
    triangles: Triangles, source: Triangles, target: bpy.types.Object, asked: MapSettings
) -> float:
    """How far rays look on both sides, in the space of the target."""
    if asked.distance > 0:
        return asked.distance / world_scale(target)
    found = LEEWAY * distance_between(triangles, source)
    size = float(np.ptp(triangles.positions, axis=0).max())
    distance = max(found, 1e-6 * size)
    told = lengths.told(distance * world_scale(target))
    note(f"rays look for the surface up to {told} from the mesh, by how far some points are apart")
    return distance


def _tell_missed(obj: bpy.types.Object, own: Places, texels: np.ndarray, distance: str) -> None:
    """Note how many rays met nothing; raises Refusal if none did."""
    missed = len(own.texels) - len(texels)
    if len(texels) == 0:
        raise Refusal(
            f"no ray from it meets {obj.name!r} within {distance}; are both in the same place?"
        )
    if missed:
        note(
            f"{missed / len(own.texels):.2%} of the texels have rays that meet nothing within "
            f"{distance}: they are filled by the margin as far as it goes, and left as they would "
            "be without a map"
        )


def _tell_coarse(count: int, places: Places, asked: MapSettings) -> None:
    """Note if the map has fewer texels than the surface has vertices."""
    texels = len(places.texels) // asked.samples**2
    if texels < count:
        note(
            f"{texels} texels for {count} vertices: the finest detail is not in the map; a larger "
            "one holds more"
        )
