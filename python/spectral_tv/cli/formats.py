"""Which formats there are, which library has each, and how it holds bands."""

from collections.abc import Mapping
from enum import Enum

from spectral_tv.dataclass import dataclass


class Holds(Enum):
    """How a format holds bands beside the shape."""

    NOT = "the filtered shape alone"
    MORPHS = "bands as morph targets"
    VECTORS = "bands as vectors at the points"
    NUMBERS = "bands as three numbers at each vertex"
    ARRAYS = "all arrays"


@dataclass(frozen=True)
class Format:
    """Who reads it and who writes it, "" where nobody does; how it holds bands; what else of a
    surface it keeps; and about how many bytes a vertex and its two triangles take at least."""

    reads: str
    writes: str
    bands: Holds = Holds.NOT
    keeps: tuple[str, ...] = ()
    vertex: int = 36

    @property
    def has_numbers(self) -> bool:
        """Whether it holds numbers at the vertices."""
        return self.bands in (Holds.VECTORS, Holds.NUMBERS, Holds.ARRAYS)


# What a surface has beside its shape.
COLORS, TEXTURES = "vertex colors", "textures"
TRIMESH, MESHIO, OWN = "trimesh", "meshio", "this package"
FORMATS: Mapping[str, Format] = {
    ".3mf": Format(TRIMESH, TRIMESH, vertex=12),
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


def readable() -> list[str]:
    """The suffixes of what is read."""
    return [suffix for suffix, each in FORMATS.items() if each.reads]


def writable() -> list[str]:
    """The suffixes of what is written."""
    return [suffix for suffix, each in FORMATS.items() if each.writes]


def with_numbers() -> list[str]:
    """Those of them that hold numbers at the vertices."""
    return [suffix for suffix in writable() if FORMATS[suffix].has_numbers]


def with_colors() -> list[str]:
    """Those of them that hold vertex colors."""
    return [suffix for suffix in writable() if COLORS in FORMATS[suffix].keeps]


def told() -> str:
    """Lines for the help."""
    lines = [f"reads:  {' '.join(readable())}", "writes:"]
    for holds in Holds:
        suffixes = [suffix for suffix in writable() if FORMATS[suffix].bands is holds]
        lines.append(f"  {holds.value}: {' '.join(suffixes)}")
    return "\n".join(lines)
