"""Reading surfaces from files, by trimesh or meshio."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import trimesh
from numpy.typing import NDArray

import spectral_tv
from spectral_tv._surfaces import arrays_of
from spectral_tv.cli.formats import FORMATS, TRIMESH
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Read:
    """What a file holds: vertices (V, 3), triangles (F, 3), numbers at the vertices by name, and
    the object of the library, for writing. ``counts`` tells of it.
    """

    vertices: Numbers
    triangles: NDArray[np.int64]
    surface: Any
    values: Mapping[str, Numbers] = field(default_factory=dict)
    parts: int = 1

    @property
    def counts(self) -> dict[str, Any]:
        """For the report."""
        return {
            "vertices": len(self.vertices), "faces": len(self.triangles), "parts": self.parts
        }  # fmt: skip


def read(path: Path) -> Read:
    """Read a file; raises Refusal if that cannot be done."""
    kind = FORMATS.get(path.suffix.lower())
    if kind is None or not kind.reads:
        known = " ".join(suffix for suffix, each in FORMATS.items() if each.reads)
        raise Refusal(f"files {path.suffix or 'without suffix'} are not read; {known} are")
    try:
        found = _by_trimesh(path) if kind.reads == TRIMESH else _by_meshio(path)
    except (Refusal, spectral_tv.MeshError, MemoryError):
        raise
    except ModuleNotFoundError as error:
        raise Refusal(f"{error.name} is missing, which reads {path.suffix}") from error
    except Exception as error:  # readers of files that are no such files raise anything
        reason = str(error) or type(error).__name__
        raise Refusal(f"it cannot be read as {path.suffix}: {reason}") from error
    if not len(found.triangles):
        raise Refusal("there is no mesh with faces in it")
    return found


def _by_trimesh(path: Path) -> Read:
    # Nothing is merged or dropped on the way.
    scene = trimesh.load_scene(path, process=False, maintain_order=True)
    parts = [each for each in scene.dump() if isinstance(each, trimesh.Trimesh)]
    others = len(scene.geometry) - len({id(each) for each in scene.geometry.values()
                                        if isinstance(each, trimesh.Trimesh)})  # fmt: skip
    if others:
        note(f"left out: {others} that are no meshes")
    if not parts:
        raise Refusal("there is no mesh with faces in it")
    if len(parts) > 1:
        note(f"its {len(parts)} meshes are one surface")
    surface = parts[0] if len(parts) == 1 else trimesh.util.concatenate(parts)
    vertices, triangles = arrays_of(surface)
    values = _ply_values(surface, len(vertices)) if path.suffix.lower() == ".ply" else {}
    return Read(np.asarray(vertices, float), triangles, surface, values, len(parts))


def _ply_values(surface: Any, count: int) -> dict[str, Numbers]:
    """The numbers that a PLY file has at its vertices, besides places, normals and colors."""
    raw = surface.metadata.get("_ply_raw", {}).get("vertex", {}).get("data")
    names = getattr(getattr(raw, "dtype", None), "names", None) or ()
    known = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha"}
    return {
        name: np.asarray(raw[name], float).ravel()
        for name in names
        if name not in known and np.size(raw[name]) == count
    }


def _by_meshio(path: Path) -> Read:
    surface = meshio.read(path)
    vertices, triangles = arrays_of(surface)
    values = {
        name: np.asarray(each, float)
        for name, each in surface.point_data.items()
        if len(each) == len(vertices) and np.asarray(each).ndim == 1
    }
    return Read(np.asarray(vertices, float), triangles, surface, values)
