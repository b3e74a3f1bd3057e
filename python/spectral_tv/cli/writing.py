"""Writing surfaces and what came of them to files: whole, or not at all."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import trimesh
from numpy.typing import NDArray

from spectral_tv._surfaces import in_kind
from spectral_tv.cli.formats import COLORS, FORMATS, MESHIO, OWN, TEXTURES, Holds
from spectral_tv.cli.morph_targets import with_morph_targets
from spectral_tv.cli.reading import OWN_NAMES, Read
from spectral_tv.dataclass import dataclass
from spectral_tv.files.whole import written
from spectral_tv.notes import a, listed, note
from spectral_tv.refusal import Refusal

Numbers = NDArray[np.float64]
AXES = "xyz"
# Of several formats with a suffix, the one that is meant, as meshio calls it.
FILE_FORMATS = {".msh": "gmsh"}


@dataclass(frozen=True)
class Result:
    """What came of a file.

    Its vertices are moved by displacements (V, 3), each by its name, times their ``values``.
    ``called`` is what users call them; they are not written beside the shape if it is empty.
    ``numbers``, (V,) or (V, C), are at its vertices, and ``colors`` (V, 4) too, in place of its
    own. ``arrays`` are what a file of arrays has besides.
    """

    displacements: Mapping[str, Numbers] = field(default_factory=dict)
    values: Sequence[float] = ()
    called: str = ""
    numbers: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    colors: NDArray[np.uint8] | None = None
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    @property
    def moves(self) -> Numbers | float:
        """How far the vertices are moved, (V, 3), or 0."""
        pairs = zip(self.values, self.displacements.values(), strict=True)
        return sum((value * each for value, each in pairs), 0.0)

    @property
    def beside(self) -> Mapping[str, Numbers]:
        """The displacements that are written beside the shape."""
        return self.displacements if self.called else {}


def write(read: Read, result: Result, target: Path) -> None:
    """Write the shape, with what else came of it if the format holds that; raises NotWritten."""
    kind = FORMATS[target.suffix.lower()]
    lost = [each for each in read.looks if each not in kind.keeps]
    if kind.bands is Holds.NOT and result.beside:
        lost.insert(0, result.called)
    if not kind.has_numbers and read.values:
        lost.append(f"the numbers {listed(read.values)}")
    if lost:
        note(f"left out, as {a(target.suffix)} does not hold them: {listed(lost)}")
    if result.colors is not None and read.looks:
        note(f"its own {listed(read.looks)} are replaced")
    # Materials and pictures of an .obj are files of their own.
    with written(target, with_others=TEXTURES in kind.keeps) as path:
        try:
            _writer(kind.writes, kind.bands)(read, result, path)
        except (OSError, MemoryError):
            raise
        except Exception as error:  # writers raise anything of what their format does not hold
            reason = str(error) or type(error).__name__
            raise Refusal(f"it cannot be written as {target.suffix}: {reason}") from error


def _writer(library: str, holds: Holds) -> Callable[[Read, Result, Path], None]:
    if library == OWN:
        return _arrays
    if library == MESHIO:
        return _by_meshio
    return _glb if holds is Holds.MORPHS else _by_trimesh


def _arrays(read: Read, result: Result, path: Path) -> None:
    """All of it as NumPy's arrays."""
    found = {"vertices": read.vertices, "triangles": read.triangles}
    with path.open("wb") as file:
        np.savez_compressed(file, **found, **result.numbers, **result.arrays)


def _of_trimesh(read: Read, result: Result) -> trimesh.Trimesh:
    """The surface as trimesh has it: as it was read, with its colors and textures, if it was."""
    made = read.surface
    if not isinstance(made, trimesh.Trimesh):
        made = trimesh.Trimesh(read.vertices, read.triangles, process=False)
    made = in_kind(made, read.vertices)
    made.vertex_attributes.clear()
    if result.colors is not None:
        made.visual = trimesh.visual.ColorVisuals(made, vertex_colors=result.colors)
    return made


def _by_trimesh(read: Read, result: Result, path: Path) -> None:
    made = in_kind(_of_trimesh(read, result), read.vertices + result.moves)
    if path.suffix.lower() != ".obj":
        made.export(path)
        return
    visual: Any = made.visual
    if getattr(visual, "material", None) is not None:  # its files are named after it
        visual.material = visual.material.copy()
        visual.material.name = path.stem
    made.export(path, mtl_name=f"{path.stem}.mtl")


def _glb(read: Read, result: Result, path: Path) -> None:
    """The shape as it was, and the displacements as morph targets with their values."""
    made = _of_trimesh(read, result)
    if not result.beside:
        made = in_kind(made, read.vertices + result.moves)
    content: Any = made.export(file_type="glb", include_normals=True)
    if result.beside:
        content = with_morph_targets(content, result.beside, result.values)
    path.write_bytes(content)


def _by_meshio(read: Read, result: Result, path: Path) -> None:
    kind = FORMATS[path.suffix.lower()]
    values = {**read.values, **result.beside, **result.numbers} if kind.has_numbers else {}
    if kind.bands is Holds.NUMBERS:
        values = _in_columns(values)
        colors = read.colors if result.colors is None else result.colors
        if colors is not None and COLORS in kind.keeps:
            values |= dict(zip(("red", "green", "blue", "alpha"), colors.T, strict=True))
    shape = read.vertices + result.moves
    if isinstance(read.surface, meshio.Mesh):
        made = in_kind(read.surface, shape)
        made.point_data = values
        own = [name for name in made.cell_data if name.startswith(OWN_NAMES)]
        for name in own:  # they belong to numbers at the vertices that are not kept
            del made.cell_data[name]
    else:
        made = meshio.Mesh(shape, [("triangle", read.triangles.astype(np.int32))], values)
    made.write(path, file_format=FILE_FORMATS.get(path.suffix.lower()))


def _in_columns(values: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """The same as single numbers at each vertex."""
    found = {}
    for name, each in values.items():
        if each.ndim == 1:
            found[name] = each
            continue
        for place, column in enumerate(each.T):
            end = AXES[place] if len(each.T) == len(AXES) else str(place + 1)
            found[f"{name}_{end}"] = column
    return found
