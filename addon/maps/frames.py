"""The tangent spaces of texels, as Cycles' nodes have them."""

from __future__ import annotations

from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from .texels import Places
from .triangles import Triangles


@dataclass(frozen=True)
class Frames:
    """Of the corners of triangles: normals, tangents (F, 3, 3), and signs of bitangents (F, 3)."""

    normals: np.ndarray
    tangents: np.ndarray
    signs: np.ndarray

    @classmethod
    def of(cls, triangles: Triangles) -> Frames:
        """Those of triangles with UVs."""
        return cls(triangles.normals, *triangles.tangents())

    def displacement(self, moved: np.ndarray, places: Places, chosen: slice) -> np.ndarray:
        """What Cycles' node Vector Displacement takes for displacements (N, 3) in object space.

        X is along the tangent, Y along the normal, Z along the bitangent.
        """
        normal = unit(places.values(self.normals, chosen))
        tangent = places.values(self.tangents, chosen)
        return _solved((tangent, normal, self._bitangent(normal, tangent, places, chosen)), moved)

    def normal(self, normals: np.ndarray, places: Places, chosen: slice) -> np.ndarray:
        """What Cycles' node Normal Map takes for normals (N, 3) in object space, from −1 to 1.

        X is along the tangent, Y along the bitangent, Z along the normal.
        """
        normal = places.values(self.normals, chosen)
        tangent = places.values(self.tangents, chosen)
        bitangent = self._bitangent(normal, tangent, places, chosen, is_unit=False)
        return unit(_solved((tangent, bitangent, normal), normals))

    def _bitangent(
        self,
        normal: np.ndarray,
        tangent: np.ndarray,
        places: Places,
        chosen: slice,
        is_unit: bool = True,
    ) -> np.ndarray:
        across = np.cross(normal, tangent)
        signs = places.values(self.signs[..., np.newaxis], chosen)
        return signs * (unit(across) if is_unit else across)


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (N, 3) at length 1; those of no length stay."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(lengths > 0, lengths, 1)


def _solved(axes: tuple[np.ndarray, np.ndarray, np.ndarray], vectors: np.ndarray) -> np.ndarray:
    """Components (N, 3) of vectors (N, 3) along axes that need not be at right angles; 0 where the
    axes have no volume."""
    one, two, three = axes
    duals = np.cross(two, three), np.cross(three, one), np.cross(one, two)
    volume = np.einsum("nc,nc->n", one, duals[0])
    found = np.stack([np.einsum("nc,nc->n", dual, vectors) for dual in duals], axis=-1)
    inverse = np.where(
        np.abs(volume) > np.finfo(np.float32).tiny, 1 / np.where(volume, volume, 1), 0
    )
    return found * inverse[:, np.newaxis]
