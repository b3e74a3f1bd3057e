"""Writing surfaces and their bands to files: whole, or not at all."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import trimesh
from numpy.typing import NDArray

from spectral_tv._surfaces import in_kind
from spectral_tv.cli.formats import COLORS, FORMATS, MESHIO, OWN, TEXTURES, Holds
from spectral_tv.cli.morph_targets import with_morph_targets
from spectral_tv.cli.reading import Read
from spectral_tv.files.whole import written
from spectral_tv.notes import listed, note

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Bands:
    """What came of a file: displacements (K, V, 3) of its vertices, their values (K,), and where
    they begin and end, t (K + 1,)."""

    displacements: Numbers
    values: Sequence[float]
    edges: Numbers

    @property
    def moves(self) -> Numbers:
        """How far they move the vertices, (V, 3)."""
        return np.tensordot(np.asarray(self.values), self.displacements, 1)

    @property
    def named(self) -> dict[str, Numbers]:
        """The bands by their names."""
        return {f"band_{number}": band for number, band in enumerate(self.displacements, 1)}


def write(read: Read, bands: Bands, target: Path) -> None:
    """Write the filtered shape, with the bands if the format holds them; raises NotWritten."""
    kind = FORMATS[target.suffix.lower()]
    lost = [each for each in _looks(read.surface) if each not in kind.keeps]
    if kind.bands is Holds.NOT:
        lost.insert(0, "the bands")
    if lost:
        note(f"left out, as a {target.suffix} does not hold them: {listed(lost)}")
    # Materials and pictures of an .obj are files of their own.
    with written(target, with_others=TEXTURES in kind.keeps) as path:
        _writer(kind.writes, kind.bands)(read, bands, path)


def _looks(surface: Any) -> list[str]:
    """What it has beside its shape."""
    visual = getattr(surface, "visual", None)
    kind = getattr(visual, "kind", None)
    return {"vertex": [COLORS], "face": ["face colors"], "texture": [TEXTURES]}.get(kind or "", [])


def _writer(library: str, holds: Holds) -> Callable[[Read, Bands, Path], None]:
    if library == OWN:
        return _arrays
    if library == MESHIO:
        return _by_meshio
    return _glb if holds is Holds.MORPHS else _by_trimesh


def _arrays(read: Read, bands: Bands, path: Path) -> None:
    """All of it as NumPy's arrays."""
    with path.open("wb") as file:
        np.savez_compressed(
            file,
            vertices=read.vertices,
            triangles=read.triangles,
            bands=bands.displacements,
            values=np.asarray(bands.values),
            edges=bands.edges,
            filtered=read.vertices + bands.moves,
        )


def _of_trimesh(read: Read) -> trimesh.Trimesh:
    """The surface as trimesh has it: as it was read, with its colors and textures, if it was."""
    if isinstance(read.surface, trimesh.Trimesh):
        return read.surface
    return trimesh.Trimesh(read.vertices, read.triangles, process=False)


def _by_trimesh(read: Read, bands: Bands, path: Path) -> None:
    made = in_kind(_of_trimesh(read), read.vertices + bands.moves)
    made.vertex_attributes.clear()
    if path.suffix.lower() != ".obj":
        made.export(path)
        return
    visual: Any = made.visual
    if getattr(visual, "material", None) is not None:  # its files are named after it
        visual.material = visual.material.copy()
        visual.material.name = path.stem
    made.export(path, mtl_name=f"{path.stem}.mtl")


def _glb(read: Read, bands: Bands, path: Path) -> None:
    """The shape as it was, and the bands as morph targets with their values."""
    made = _of_trimesh(read).copy()
    made.vertex_attributes.clear()
    content: Any = made.export(file_type="glb", include_normals=True)
    path.write_bytes(with_morph_targets(content, bands.named, bands.values))


def _by_meshio(read: Read, bands: Bands, path: Path) -> None:
    holds = FORMATS[path.suffix.lower()].bands
    found = bands.named if holds is not Holds.NOT else {}
    if holds is Holds.NUMBERS:
        found = {
            f"{name}_{axis}": band[:, place]
            for name, band in found.items()
            for place, axis in enumerate("xyz")
        }
    values = {**read.values, **found} if holds is not Holds.NOT else {}
    shape = read.vertices + bands.moves
    if isinstance(read.surface, meshio.Mesh):
        made = in_kind(read.surface, shape, values)
    else:
        if path.suffix.lower() == ".ply" and COLORS in _looks(read.surface):
            colors = np.asarray(read.surface.visual.vertex_colors, np.uint8)
            values |= dict(zip(("red", "green", "blue", "alpha"), colors.T, strict=True))
        made = meshio.Mesh(shape, [("triangle", read.triangles.astype(np.int32))], values)
    made.write(path)
