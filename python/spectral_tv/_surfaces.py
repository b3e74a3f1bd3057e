"""Surfaces of other libraries: what is taken of them, and results in kind.

None of these libraries is imported here: an object of one is there only where its own module is.
"""

import sys
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectral_tv._native import MeshError, MeshWarning

Arrays = tuple[NDArray[Any], NDArray[Any]]
Values = Mapping[str, NDArray[Any]]
Surface = TypeVar("Surface")

# Of meshio: cells that are flat polygons, and the volumes whose surface is not at hand.
POLYGONS = ("triangle", "quad", "polygon")
VOLUMES = ("tetra", "hexahedron", "wedge", "pyramid", "polyhedron", "voxel")


@dataclass(frozen=True)
class Kind:
    """A class of another library: its module and its name there, the vertices and triangles of an
    object, and the copy of one that has other vertices and attributes.
    """

    module: str
    name: str
    arrays: Callable[[Any], Arrays]
    changed: Callable[[Any, NDArray[Any], Values], Any]

    def holds(self, surface: object) -> bool:
        """Whether the object is of this class."""
        found: Any = sys.modules.get(self.module)
        for part in self.name.split("."):
            found = getattr(found, part, None)
        return isinstance(found, type) and isinstance(surface, found)

    @property
    def full_name(self) -> str:
        """As users write it."""
        return f"{self.module}.{self.name}"


def arrays_of(surface: object) -> Arrays:
    """The vertices (V, 3) and triangles (F, 3) of an object of another library."""
    return _kind_of(surface).arrays(surface)


def in_kind(
    like: Surface, vertices: ArrayLike, attributes: Mapping[str, ArrayLike] | None = None
) -> Surface:
    """Copy a surface of another library, with other vertices.

    Parameters
    ----------
    like : object
        A `trimesh.Trimesh`, `meshio.Mesh`, `pyvista.PolyData` or Open3D `TriangleMesh`, which stays
        as it is. The copy keeps its faces and what else it has.
    vertices : (V, 3) array
        The positions of its vertices. Where `Mesh.of` welded, `values[mesh.weld_map]` takes values
        of the mesh to these vertices.
    attributes : mapping of (V,) or (V, C) arrays, optional
        Values at the vertices by name, which the copy gets as attributes.

    Returns
    -------
    object
        Of the class of `like`.

    Raises
    ------
    MeshError
        If the vertices or an attribute are not as many as those of `like`, or if `like` is of no
        class that is known, or of one that keeps no attributes.
    """
    kind = _kind_of(like)
    count = len(kind.arrays(like)[0])
    places = _values("vertices", vertices, count)
    if places.shape != (count, 3):
        raise MeshError(f"vertices must have the shape ({count}, 3), not {places.shape}")
    found = {name: _values(name, values, count) for name, values in (attributes or {}).items()}
    changed: Surface = kind.changed(like, places, found)
    return changed


def _values(name: str, values: ArrayLike, count: int) -> NDArray[Any]:
    found = np.asarray(values)
    if found.ndim == 0 or len(found) != count:
        many = len(found) if found.ndim else 0
        raise MeshError(f"{name} must have {count} values, one for each vertex, not {many}")
    return found


def _kind_of(surface: object) -> Kind:
    for kind in KINDS:
        if kind.holds(surface):
            return kind
    given = f"{type(surface).__module__}.{type(surface).__qualname__}"
    *first, last = dict.fromkeys(kind.full_name for kind in KINDS)
    advice = ADVICE.get(given, "Mesh(vertices, triangles) takes arrays")
    raise MeshError(f"{given} is none of {', '.join(first)} and {last}; {advice}")


# Of objects that hold a surface, how to come by it.
ADVICE = {
    "trimesh.scene.scene.Scene": "take scene.to_mesh()",
    "pyvista.core.pointset.UnstructuredGrid": "take grid.extract_surface()",
    "pyvista.core.pointset.StructuredGrid": "take grid.extract_surface()",
    "pyvista.core.grid.ImageData": "take grid.extract_surface()",
    "pyvista.core.composite.MultiBlock": "take blocks.combine().extract_surface()",
}


def _skipped(what: Iterable[str]) -> None:
    told = ", ".join(what)
    if told:
        warnings.warn(f"takes no part: {told}", MeshWarning, stacklevel=4)


def _of_trimesh(surface: Any) -> Arrays:
    return np.asarray(surface.vertices), np.asarray(surface.faces)


def _like_trimesh(surface: Any, vertices: NDArray[Any], values: Values) -> Any:
    made = surface.copy()
    made.vertices = vertices
    made.vertex_attributes.update(values)
    return made


def _of_meshio(surface: Any) -> Arrays:
    found, skipped = [np.empty((0, 3), dtype=np.int64)], []
    for block in surface.cells:
        cells = [np.asarray(cell) for cell in block.data]
        if block.type not in POLYGONS and not block.type.startswith("polygon"):
            skipped.append(f"{len(cells)} cells of the type {block.type}")
            continue
        sizes = {len(cell) for cell in cells}
        for size in sizes:  # a fan around the first corner
            same = np.array([cell for cell in cells if len(cell) == size], dtype=np.int64)
            found += [same[:, [0, corner, corner + 1]] for corner in range(1, size - 1)]
    triangles = np.concatenate(found)
    if not len(triangles):
        has_volume = any(block.type.startswith(VOLUMES) for block in surface.cells)
        advice = "; take the surface of its volume first" if has_volume else ""
        raise MeshError(f"the mesh has no triangles, quads or polygons{advice}")
    _skipped(skipped)
    points = np.asarray(surface.points)
    if points.ndim == 2 and points.shape[1] == 2:  # in the plane
        points = np.column_stack([points, np.zeros(len(points))])
    return points, triangles


def _like_meshio(surface: Any, vertices: NDArray[Any], values: Values) -> Any:
    made = surface.copy()
    made.points = vertices
    made.point_data.update(values)
    return made


def _of_pyvista(surface: Any) -> Arrays:
    counts = [(surface.n_lines, "lines"), (surface.n_verts, "single points")]
    _skipped(f"{count} {name}" for count, name in counts if count)
    made = surface.triangulate()
    return np.asarray(made.points), np.asarray(made.regular_faces)


def _like_pyvista(surface: Any, vertices: NDArray[Any], values: Values) -> Any:
    made = surface.copy()
    made.points = vertices
    for name, each in values.items():
        made.point_data[name] = each
    return made


def _of_open3d(surface: Any) -> Arrays:
    return np.asarray(surface.vertices), np.asarray(surface.triangles)


def _like_open3d(surface: Any, vertices: NDArray[Any], values: Values) -> Any:
    if values:
        names = ", ".join(values)
        raise MeshError(
            f"open3d.geometry.TriangleMesh keeps no attributes such as {names}; "
            "take open3d.t.geometry.TriangleMesh.from_legacy(mesh)"
        )
    open3d = sys.modules["open3d"]
    made = type(surface)(surface)
    made.vertices = open3d.utility.Vector3dVector(np.asarray(vertices, dtype=float))
    if made.has_vertex_normals():
        made.compute_vertex_normals()
    if made.has_triangle_normals():
        made.compute_triangle_normals()
    return made


def _of_open3d_tensors(surface: Any) -> Arrays:
    return surface.vertex.positions.cpu().numpy(), surface.triangle.indices.cpu().numpy()


def _like_open3d_tensors(surface: Any, vertices: NDArray[Any], values: Values) -> Any:
    open3d = sys.modules["open3d"]
    made, old = surface.clone(), surface.vertex.positions
    made.vertex.positions = open3d.core.Tensor(vertices, old.dtype, old.device)
    for name, each in values.items():
        made.vertex[name] = open3d.core.Tensor(each.reshape(len(each), -1), device=old.device)
    if "normals" in made.vertex:
        made.compute_vertex_normals()
    return made


KINDS = (
    Kind("trimesh", "Trimesh", _of_trimesh, _like_trimesh),
    Kind("meshio", "Mesh", _of_meshio, _like_meshio),
    Kind("pyvista", "PolyData", _of_pyvista, _like_pyvista),
    Kind("open3d", "geometry.TriangleMesh", _of_open3d, _like_open3d),
    Kind("open3d", "t.geometry.TriangleMesh", _of_open3d_tensors, _like_open3d_tensors),
)
