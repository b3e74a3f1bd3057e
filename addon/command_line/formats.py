"""The table of what each format holds; exports, messages and docs/formats.md follow it."""

from collections.abc import Iterator, Mapping
from dataclasses import field
from typing import Any

import bpy
from spectral_tv.dataclass import dataclass

# All of it; none of it; that which is active; it is seen in the shape, and no longer apart.
YES, NO, ONE, APPLIED = "yes", "–", "one", "applied"
# What files hold besides the shape, as docs/formats.md has it. Other words tell what of it is kept.
TABLE = """\
| | .blend | .glb .gltf | .fbx | .usd .usda .usdc .usdz | .abc | .dae | .obj | .ply | .stl |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
| vertex colors | yes | yes | yes | yes | 8 bits | 8 bits | one | one | – |
| UV maps | yes | yes | yes | yes | yes | yes | one | one | – |
| materials | yes | yes | yes | yes | names | yes | yes | – | – |
| textures | yes | yes | yes | yes | – | yes | yes | – | – |
| custom normals | yes | yes | yes | yes | yes | – | yes | per vertex | – |
| custom attributes | yes | not of edges | – | not of edges | – | – | – | of vertices | – |
| vertex groups | yes | – | – | as attributes | – | – | – | as attributes | – |
| shape keys | yes | yes | yes | the file's own | applied | applied | applied | applied | applied |
| armatures | yes | yes | yes | yes | applied | applied | applied | applied | applied |
| animation | yes | keyframes | keyframes | yes | yes | – | – | – | – |
| objects apart | yes | yes | yes | yes | yes | yes | yes | – | – |
| object names | yes | yes | yes | yes | yes | yes | yes | – | – |
| parents | yes | yes | yes | yes | yes | yes | – | – | – |
| collections | yes | – | – | – | – | – | – | – | – |
| quads, n-gons | yes | – | yes | yes | yes | yes | yes | yes | – |
| loose edges, points | yes | yes | yes | points | points | – | edges | yes | – |
| cameras | yes | yes | yes | yes | yes | yes | – | – | – |
| lights | yes | yes | yes | yes | – | yes | – | – | – |
| curves, texts | yes | meshes | meshes | yes | curves | – | meshes | meshes | meshes |
| other objects | yes | – | – | – | – | – | – | – | – |
| modifiers | yes | applied | applied | applied | applied | applied | applied | applied | applied |
| custom properties | yes | yes | yes | yes | – | – | – | – | – |
"""


def _columns() -> Iterator[tuple[str, dict[str, str]]]:
    """Of every suffix, the word for each kind."""
    head, _, *rows = ([cell.strip() for cell in line.split("|")] for line in TABLE.splitlines())
    for place, suffixes in enumerate(head[2:-1], 2):
        for suffix in suffixes.split():
            yield suffix, {row[1]: row[place] for row in rows}


HOLDS: Mapping[str, Mapping[str, str]] = dict(_columns())


@dataclass(frozen=True)
class Format:
    """How Blender reads and writes a format.

    Of operators the first that exists is used; options that it lacks are left out. ``keys`` says
    that shape keys are stored with their values, ``attributes`` on which domains custom
    attributes can be, ``others`` that a file comes with more files, and ``by_selection`` that
    what it holds is always selected.
    """

    importers: tuple[str, ...]
    exporters: tuple[str, ...]
    selection: str
    options: Mapping[str, Any] = field(default_factory=dict)
    reading: Mapping[str, Any] = field(default_factory=dict)
    keys: bool = False
    attributes: tuple[str, ...] = ()
    others: bool = False
    by_selection: bool = False

    @property
    def importer(self) -> str | None:
        """The operator that reads the format in this Blender, if there is one."""
        return _first(self.importers)

    @property
    def exporter(self) -> str | None:
        """The operator that writes the format in this Blender, if there is one."""
        return _first(self.exporters)


BLEND = ".blend"
_GLTF: Mapping[str, Any] = {
    "importers": ("import_scene.gltf",), "exporters": ("export_scene.gltf",),
    "selection": "use_selection", "reading": {"disable_bone_shape": True}, "keys": True,
    "attributes": ("POINT", "CORNER", "FACE"),
}  # fmt: skip
_GLTF_OPTIONS = {
    "export_all_influences": True, "export_attributes": True, "export_cameras": True,
    "export_extras": True, "export_lights": True, "export_vertex_color": "ACTIVE",
    "use_mesh_edges": True, "use_mesh_vertices": True, "use_visible": True,
}  # fmt: skip
_USD = Format(
    ("wm.usd_import",), ("wm.usd_export",), "selected_objects_only",
    {"evaluation_mode": "VIEWPORT", "export_subdivision": "TESSELLATE"},
    attributes=("POINT", "CORNER", "FACE"), others=True,
)  # fmt: skip
FORMATS = {
    ".ply": Format(
        ("wm.ply_import",), ("wm.ply_export",), "export_selected_objects", attributes=("POINT",),
        by_selection=True,  # Blender 5.2 writes what will be rendered
    ),
    ".stl": Format(
        ("wm.stl_import",), ("wm.stl_export",), "export_selected_objects",
        {"evaluation_mode": "DAG_EVAL_VIEWPORT"},
    ),
    ".obj": Format(
        ("wm.obj_import",), ("wm.obj_export",), "export_selected_objects",
        {"export_colors": True}, others=True,
    ),
    ".glb": Format(**_GLTF, options={**_GLTF_OPTIONS, "export_format": "GLB"}),
    ".gltf": Format(
        **_GLTF, options={**_GLTF_OPTIONS, "export_format": "GLTF_SEPARATE"}, others=True
    ),
    ".fbx": Format(
        ("wm.fbx_import", "import_scene.fbx"), ("export_scene.fbx",), "use_selection",
        {
            "add_leaf_bones": False, "bake_anim_simplify_factor": 0.0, "embed_textures": True,
            "path_mode": "COPY", "use_custom_props": True, "use_mesh_edges": True,
            "use_mesh_modifiers": False,  # they are applied before
            "use_visible": True,
        },
        {"anim_offset": 0.0},  # otherwise every round trip is a frame late
        keys=True,
    ),
    **dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), _USD),
    ".abc": Format(
        ("wm.alembic_import",), ("wm.alembic_export",), "selected",
        {"apply_subdiv": True, "evaluation_mode": "VIEWPORT", "vcolors": True,
         "visible_objects_only": True},
    ),
    ".dae": Format(
        ("wm.collada_import",), ("wm.collada_export",), "selected",
        {
            "apply_modifiers": True,
            "include_animations": False,  # would leave keys as in the last frame
            "include_armatures": False, "include_shapekeys": False, "triangulate": False,
        },
        others=True,
        by_selection=True,  # hidden objects would end the process
    ),
}  # fmt: skip


def importable() -> list[str]:
    """Suffixes of the formats that this Blender reads."""
    return [BLEND, *(suffix for suffix, form in FORMATS.items() if form.importer)]


def exportable() -> list[str]:
    """Suffixes of the formats that this Blender writes."""
    return [BLEND, *(suffix for suffix, form in FORMATS.items() if form.exporter)]


def call(name: str, **options: Any) -> bool:
    """Call an operator with those of the options that it has; False if it gives up."""
    operator = _operator(name)
    known = operator.get_rna_type().properties
    return operator(**{key: value for key, value in options.items() if key in known}) == {
        "FINISHED"
    }


def has_option(name: str, option: str) -> bool:
    """Whether an operator of this Blender takes an option."""
    return option in _operator(name).get_rna_type().properties


def _operator(name: str) -> Any:
    module, _, function = name.partition(".")
    return getattr(getattr(bpy.ops, module), function)


def _first(names: tuple[str, ...]) -> str | None:
    """The first of several operators that this Blender has."""
    for name in names:
        module, _, function = name.partition(".")
        if function in dir(getattr(bpy.ops, module)):
            return name
    return None
