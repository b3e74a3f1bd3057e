"""Which formats there are, which library has each, and how it holds bands."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum


class Holds(Enum):
    """How a format holds bands beside the shape."""

    NOT = "the filtered shape alone"
    MORPHS = "bands as morph targets"
    VECTORS = "bands as vectors at the points"
    NUMBERS = "bands as three numbers at each vertex"
    ARRAYS = "all arrays"


@dataclass(frozen=True)
class Format:
    """Who reads it and who writes it, "" where nobody does; how it holds bands; and what else of a
    surface it keeps."""

    reads: str
    writes: str
    bands: Holds = Holds.NOT
    keeps: tuple[str, ...] = ()


# What a surface has beside its shape.
COLORS, TEXTURES = "vertex colors", "textures"
TRIMESH, MESHIO, OWN = "trimesh", "meshio", "this package"
FORMATS: Mapping[str, Format] = {
    ".3mf": Format(TRIMESH, TRIMESH),
    ".glb": Format(TRIMESH, TRIMESH, Holds.MORPHS, (COLORS, TEXTURES)),
    ".gltf": Format(TRIMESH, ""),
    ".inp": Format(MESHIO, MESHIO),
    ".mesh": Format(MESHIO, MESHIO),
    ".msh": Format(MESHIO, MESHIO, Holds.VECTORS),
    ".npz": Format("", OWN, Holds.ARRAYS),
    ".obj": Format(TRIMESH, TRIMESH, Holds.NOT, (COLORS, TEXTURES)),
    ".off": Format(TRIMESH, TRIMESH),
    ".ply": Format(TRIMESH, MESHIO, Holds.NUMBERS, (COLORS,)),
    ".stl": Format(TRIMESH, TRIMESH),
    ".vtk": Format(MESHIO, MESHIO, Holds.VECTORS),
    ".vtu": Format(MESHIO, MESHIO, Holds.VECTORS),
}


def told() -> str:
    """Lines for the help."""
    reads = " ".join(suffix for suffix, each in FORMATS.items() if each.reads)
    lines = [f"reads:  {reads}", "writes:"]
    for holds in Holds:
        suffixes = [
            suffix for suffix, each in FORMATS.items() if each.writes and each.bands is holds
        ]
        lines.append(f"  {holds.value}: {' '.join(suffixes)}")
    return "\n".join(lines)
