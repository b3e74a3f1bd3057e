"""What is chosen of a map: of what it is, which kind, over whose UVs, and how large."""

from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import Only, choice, integer, number, switch

SOURCES = (
    ("LOOK", "Look", "All bands at their present values, against the original"),
    ("BAND", "Band", "One band of the active decomposition: what its slider at 1 adds"),
)
DISPLACEMENT, TANGENT, OBJECT, NORMAL = "DISPLACEMENT", "TANGENT", "OBJECT", "NORMAL"
KINDS = (
    (DISPLACEMENT, "Displacement", "How far the surface moves along its normals"),
    (
        TANGENT,
        "Vectors, Tangent",
        "Vector displacement in the tangent space of the UVs, so that the mesh can bend",
    ),
    (
        OBJECT,
        "Vectors, Object",
        "Vector displacement along the axes of the object, for a mesh that does not bend",
    ),
    (NORMAL, "Normals", "Its normals, in the tangent space of the UVs; Y is up, as in OpenGL"),
)
TARGETS = (
    ("THIS", "This Mesh", "The UVs of the active object"),
    ("OTHER", "Other Selected Mesh", "The UVs of the other selected object, a low-poly mesh"),
)
# Pixels of a side.
LEAST, MOST = 8, 16384


@dataclass(frozen=True)
class MapSettings:
    """A map over UVs; lengths are in the scene's unit."""

    source: str = choice("Map of", "What the map shows", SOURCES, argument="of", place="map")
    band: int = integer(
        "Band", "Its number; 1 is the finest", 1, 1, 32, applies=Only("source", ("BAND",)),
        place="map"
    )  # fmt: skip
    kind: str = choice("Kind", "What a texel holds", KINDS, place="map")
    onto: str = choice("Onto", "Whose UVs the map is for", TARGETS, argument="", place="map")
    distance: float = number(
        "Ray Distance", "How far from the low-poly mesh the surface is looked for, on both sides; "
        "0 measures how far it is", 0, 0, None, unit="DISTANCE", digits=4,
        applies=Only("onto", ("OTHER",)), place="map"
    )  # fmt: skip
    size: int = integer("Size", "Pixels of a side", 2048, LEAST, MOST, place="map")
    samples: int = integer(
        "Samples", "A texel is the mean of so many samples across and down; 1 is its middle. More "
        "suit a surface with more detail than the map", 1, 1, 8, place="map"
    )  # fmt: skip
    margin: int = integer(
        "Margin", "So many pixels around the islands of the UVs go on as their borders are", 16, 0,
        256, place="map"
    )  # fmt: skip
    material: bool = switch(
        "Material", "Give the mesh a material that shows the map. Its slots show it by the object; "
        "those of the mesh stay", argument="", place="map"
    )  # fmt: skip
