"""Reading surfaces from files, by trimesh or meshio."""

import sys
from collections.abc import Mapping
from contextlib import redirect_stdout
from dataclasses import field
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import trimesh
from numpy.typing import NDArray

import spectral_tv
from spectral_tv._surfaces import arrays_of
from spectral_tv.attributes.flows import ensure_finite
from spectral_tv.cli.formats import COLORS, FORMATS, TEXTURES, TRIMESH, readable
from spectral_tv.dataclass import dataclass
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

Numbers = NDArray[np.float64]
# How names begin that a library has for itself.
OWN_NAMES = "gmsh:"


@dataclass(frozen=True)
class Read:
    """What a file holds: vertices (V, 3), triangles (F, 3), numbers at the vertices by name, (V,)
    or (V, C), and the object of the library, for writing. ``counts`` tells of it.
    """

    vertices: Numbers
    triangles: NDArray[np.int64]
    surface: Any
    values: Mapping[str, Numbers] = field(default_factory=dict)
    parts: int = 1

    @property
    def looks(self) -> list[str]:
        """What it has beside its shape."""
        kind = getattr(getattr(self.surface, "visual", None), "kind", None)
        known = {"vertex": [COLORS], "face": ["face colors"], "texture": [TEXTURES]}
        return known.get(kind or "", [])

    @property
    def colors(self) -> NDArray[np.uint8] | None:
        """The colors of its vertices, red, green, blue and alpha (V, 4), if it has some."""
        if COLORS not in self.looks:
            return None
        return np.asarray(self.surface.visual.vertex_colors, np.uint8)

    def numbers(self, name: str) -> Numbers:
        """Its numbers of this name, (V,) or (V, C); raises Refusal if there are none."""
        if name not in self.values:
            there = ", ".join(self.values) or "none"
            raise Refusal(f"there are no numbers {name!r} at its vertices; there are: {there}")
        return self.values[name]

    def weights(self, name: str) -> Numbers:
        """The same as weights from 0 to 1, (V,); notes those that are not, and are cut off."""
        found = self.numbers(name)
        if found.ndim != 1:
            raise Refusal(f"{name!r} has {found.shape[1]} numbers at each vertex; weights are one")
        ensure_finite(name, found[:, np.newaxis])
        beyond = int(((found < 0) | (found > 1)).sum())
        if beyond:
            note(f"{beyond} numbers {name!r} are cut off at 0 and 1")
        return np.clip(found, 0, 1)

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
        known = " ".join(readable())
        raise Refusal(f"files {path.suffix or 'without suffix'} are not read; {known} are")
    try:
        with redirect_stdout(sys.stderr):  # readers print empty lines
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
        if not name.startswith(OWN_NAMES)
        and len(each) == len(vertices)
        and np.asarray(each).ndim in (1, 2)
    }
    return Read(np.asarray(vertices, float), triangles, surface, values)
