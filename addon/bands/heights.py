"""How far bands move the surface along its normals, as attributes: for masks and shading."""

import bpy
from spectral_tv.later import np

from ..scene import results
from ..scene.coordinates import basis_coordinates, triangles
from ..scene.decomposition import NAMED, SpectralTVRecord
from ..scene.normals import vertex_normals
from ..scene.records import bands_of, keeping_of
from ..scene.results import Piece

KIND, LABEL = "HEIGHT", "Height"


def write(obj: bpy.types.Object, record: SpectralTVRecord) -> list[str]:
    """Write an attribute for each band of a decomposition, over that of the last time; returns
    their names.

    It is the dot product of the band and the normal of the base, in object space: positive where
    the band moves the surface outwards. The base is Basis without these bands.
    """
    keeping = keeping_of(record)
    bands = [band for band in bands_of(obj, record) if band is not None]
    moves = {band.name: keeping.displacement(band) for band in bands}
    base = basis_coordinates(obj.data) - sum(moves.values(), np.zeros(3))
    normals = vertex_normals(base, triangles(obj.data, base))
    pieces = {
        name: Piece("ATTRIBUTE", np.einsum("ij,ij->i", moved, normals), "FLOAT")
        for name, moved in moves.items()
    }
    names = results.write(
        obj,
        KIND,
        record.name,
        pieces,
        stale=lambda _label: True,
        wanted=lambda _source, label: (label, LABEL),
    )
    obj.data.update_tag()
    return names


def renew(obj: bpy.types.Object, record: SpectralTVRecord, is_asked: bool) -> None:
    """Write those of new bands if that is asked for, or if the bands before had some."""
    if is_asked or names_of(obj, record.name):
        write(obj, record)


def hand_over(obj: bpy.types.Object, former: str, source: str) -> None:
    """Have the heights of a decomposition be those of one of another name."""
    for each in obj.data.spectral_tv.results:
        if (each.kind, each.source) == (KIND, former):
            each.source = source


def names_of(obj: bpy.types.Object, source: str) -> list[str]:
    """The attributes with the heights of a decomposition that are there unchanged."""
    kept, known = obj.data.spectral_tv.results, results.known(obj, "ATTRIBUTE").items()
    own = [(place, name) for place, name in known if kept[place].kind == KIND]
    return [name for place, name in own if kept[place].source == source]


def _follow_name(record: SpectralTVRecord) -> None:
    """Have those of a decomposition be so by its name today, which its bands have not so far."""
    mesh = record.id_data
    if not isinstance(mesh, bpy.types.Mesh):
        return
    kept = mesh.spectral_tv
    bands = {name for band in record.bands for name in (band.key, band.given)}
    for each in kept.results:
        if each.kind == KIND and each.source not in kept.decompositions and each.label in bands:
            each.source = record.name


NAMED.insert(0, _follow_name)  # before its bands are renamed
