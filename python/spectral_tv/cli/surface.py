"""The surface of a file as a mesh whose corners are joined where they belong together."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

import spectral_tv
from spectral_tv.bands.joining import joined
from spectral_tv.bands.settings import Settings
from spectral_tv.cli.reading import Read
from spectral_tv.dataclass import dataclass
from spectral_tv.means import means

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Surface:
    """``place`` (V,) tells where every vertex of the file is among the N of the mesh, −1 for one
    that is left out."""

    mesh: spectral_tv.Mesh
    place: NDArray[np.int64]

    @classmethod
    def of(cls, read: Read, asked: Any) -> "Surface":
        """Join what was read, as the settings ask with ``weld`` and ``leaves_out``.

        Raises spectral_tv.MeshError if it cannot be used.
        """
        mesh = joined(read.vertices, read.triangles, asked.weld, asked.leaves_out)
        return cls(mesh, mesh.weld_map)

    def merge(self, values: Numbers) -> Numbers:
        """Values of the file's vertices (V, C) as those of the mesh's (N, C): their means."""
        is_there = self.place >= 0
        return means(self.place[is_there], values[is_there], len(self.mesh.vertex_areas))

    def to_vertices(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values at the mesh's vertices (N, …) as those of the file's (V, …); 0 if left out."""
        found = np.zeros((len(self.place), *values.shape[1:]), dtype=values.dtype)
        is_there = self.place >= 0
        found[is_there] = values[self.place[is_there]]
        return found

    def base(self, asked: Settings) -> Numbers | None:
        """The base that a method measures from, (N, 3), if it is not one that it makes."""
        if asked.base != "FLAT":
            return None
        vertices = self.mesh.vertices  # pressed flat along the Z axis
        vertices[:, 2] = vertices[:, 2].min()
        return vertices
