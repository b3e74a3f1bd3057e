"""Reading and writing files by their suffix, with whatever operators this Blender has."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy

from ..scene.objects import Refusal


@dataclass(frozen=True)
class Format:
    """The operators of a format, the first that exists is used, and what they are told."""

    importers: tuple[str, ...]
    exporters: tuple[str, ...]
    selection: str
    options: dict[str, Any] = field(default_factory=dict)


_GLTF = ("import_scene.gltf",), ("export_scene.gltf",), "use_selection"
# Without shape keys the exporter writes the filtered shape; with them it drops their values.
_USD = Format(
    ("wm.usd_import",),
    ("wm.usd_export",),
    "selected_objects_only",
    {"export_shapekeys": False},
)
BLEND = ".blend"
FORMATS = {
    ".ply": Format(("wm.ply_import",), ("wm.ply_export",), "export_selected_objects"),
    ".stl": Format(("wm.stl_import",), ("wm.stl_export",), "export_selected_objects"),
    ".obj": Format(("wm.obj_import",), ("wm.obj_export",), "export_selected_objects"),
    ".glb": Format(*_GLTF, {"export_format": "GLB"}),
    ".gltf": Format(*_GLTF, {"export_format": "GLTF_SEPARATE"}),
    ".fbx": Format(("wm.fbx_import", "import_scene.fbx"), ("export_scene.fbx",), "use_selection"),
    ".usd": _USD,
    ".usda": _USD,
    ".usdc": _USD,
    ".usdz": _USD,
    ".abc": Format(("wm.alembic_import",), ("wm.alembic_export",), "selected"),
    ".dae": Format(
        ("wm.collada_import",),
        ("wm.collada_export",),
        "selected",
        {"apply_modifiers": True, "include_shapekeys": False},  # the filtered shape
    ),
}


def importable() -> list[str]:
    """Suffixes of the formats that this Blender reads."""
    return [BLEND, *(suffix for suffix, form in FORMATS.items() if _first(form.importers))]


def exportable() -> list[str]:
    """Suffixes of the formats that this Blender writes."""
    return [BLEND, *(suffix for suffix, form in FORMATS.items() if _first(form.exporters))]


def load(path: Path) -> None:
    """Open a .blend, or import another file into an empty scene.

    Raises Refusal or RuntimeError if it cannot be read.
    """
    suffix = path.suffix.lower()
    if not path.is_file():
        raise Refusal("there is no such file")
    if suffix not in importable():
        raise Refusal(f"this Blender reads no {suffix or 'files without suffix'}")
    if suffix == BLEND:
        bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
        if bpy.context.object is not None and bpy.context.object.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        return
    # The preferences, and with them this extension, stay.
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    form = FORMATS[suffix]
    _call(_first(form.importers), "Blender cannot import it", filepath=str(path))
    for obj in bpy.context.scene.objects:
        _freeze(obj)
    bpy.context.view_layer.update()


def save(path: Path, only: Iterable[bpy.types.Object] | None) -> None:
    """Write the scene, or the objects ``only`` of it, in the format of the path's suffix.

    A .blend always holds everything. Raises Refusal or RuntimeError if it cannot be written.
    """
    before = path.stat().st_mtime_ns if path.exists() else None
    if path.suffix.lower() == BLEND:
        bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    else:
        _export(path, only)
    if not path.exists() or path.stat().st_mtime_ns == before:
        raise Refusal(f"Blender did not write {path}")


def _export(path: Path, only: Iterable[bpy.types.Object] | None) -> None:
    form = FORMATS[path.suffix.lower()]
    options = dict(form.options)
    if path.suffix.lower() == ".abc":  # otherwise a copy of the shape for every frame
        options["start"] = options["end"] = bpy.context.scene.frame_current
    if path.suffix.lower() == ".fbx" and any(keys.animation_data for keys in bpy.data.shape_keys):
        # One take for all of the animation: takes of single actions leave out shape keys.
        options["bake_anim_use_nla_strips"] = options["bake_anim_use_all_actions"] = False
    if only is not None:
        for obj in bpy.context.view_layer.objects:
            obj.select_set(False)
        for obj in only:
            obj.select_set(True)
            if not obj.select_get():
                raise Refusal(f"{obj.name} is hidden, so it cannot be exported alone")
        options[form.selection] = True
    _call(_first(form.exporters), f"Blender could not write {path}", filepath=str(path), **options)


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


def _call(name: str, failure: str, **options: Any) -> None:
    if _operator(name)(**options) != {"FINISHED"}:
        raise Refusal(failure)


def _freeze(obj: bpy.types.Object) -> None:
    """Keep the first frame of an animated shape, whose playback would undo every filter."""
    for modifier in list(obj.modifiers):
        if modifier.type == "MESH_SEQUENCE_CACHE":
            obj.modifiers.remove(modifier)
