"""Writing each format by Blender's exporter, from a scene that is prepared for the format."""

import os
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import Any

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.files import stl
from spectral_tv.files.checks import check
from spectral_tv.files.room import with_room
from spectral_tv.files.torn import require
from spectral_tv.refusal import Refusal

from ..scene.animation import curves_of
from ..scene.channels import drivers_of
from ..scene.temporary import Temporary
from . import finish_obj, finish_ply, ply_names
from .alembic import alembic_size
from .contents import armatures, is_animated
from .copies import dressed, own_materials
from .digits import Digits, decimals_of
from .dress import dress_of
from .formats import FORMATS, call
from .given import write_stl
from .load import Source
from .metres import in_metres
from .moving_curves import moving_alone
from .rendered import rendered_as_shown
from .shown import Kept, shown
from .textures import beside, folder_name


@dataclass
class Export:
    """One file to be written: where it goes, what is in it, what it came from, and how."""

    target: Path
    suffix: str
    objects: list[bpy.types.Object]
    source: Source
    options: dict[str, Any]

    @property
    def meshes(self) -> list[bpy.types.Object]:
        """The objects with meshes."""
        return [obj for obj in self.objects if obj.type == "MESH"]

    def call(self, place: Path) -> None:
        """Have Blender write the file."""
        name = FORMATS[self.suffix].exporter
        if not call(name, filepath=str(place), check_existing=False, **self.options):
            raise Refusal(f"Blender could not write {self.target}")

    def dressed(self) -> AbstractContextManager[None]:
        """Have meshes be copies with the changes that the format asks for, if it does."""
        dress = dress_of(self.suffix)
        return nullcontext() if dress is None else dressed(self.meshes, dress)


def write(place: Path, export: Export) -> None:
    """Write a file in a scene that is laid out for its format."""
    WRITERS.get(export.suffix, _export_usd)(place, export)


def is_text(suffix: str, source: Source) -> bool:
    """Whether a .ply or .stl is to be one of text, as the input is."""
    return source.suffix == suffix and source.digits.is_text


def _shown(
    export: Export, objects: Sequence[bpy.types.Object], kept: Kept = lambda _obj, _key: True
) -> AbstractContextManager[None]:
    rigs = {obj for obj in export.objects if obj.type == "ARMATURE"}
    return shown(objects, kept, rigs, dress_of(export.suffix))


def _export_gltf(place: Path, export: Export) -> None:
    rigs = [obj for obj in export.objects if obj.type == "ARMATURE"]
    # Without animation the pose is seen where it is the rest.
    export.options["export_rest_position_armature"] = not rigs or any(map(is_animated, rigs))
    if not _has_takes():
        export.options["export_animation_mode"] = "ACTIVE_ACTIONS"  # they are played together
    if export.suffix == ".gltf":
        export.options["export_texture_dir"] = folder_name(place)
    with _shown(export, export.meshes), in_metres(export.suffix):
        export.call(place)


def _export_fbx(place: Path, export: Export) -> None:
    export.options["bake_anim"] = _moves()
    if not _has_takes():
        # One take of all that moves: takes of single actions begin at 0, without shape keys.
        export.options["bake_anim_use_nla_strips"] = False
        export.options["bake_anim_use_all_actions"] = False
    with _shown(export, export.meshes), own_materials(export.meshes), moving_alone():
        export.call(place)


def _has_takes() -> bool:
    """Whether there is more animation than what is played."""
    data = [*bpy.context.scene.objects, *bpy.data.shape_keys]
    animations = [item.animation_data for item in data if item.animation_data]
    played = {animation.action for animation in animations}
    return any(animation.nla_tracks for animation in animations) or any(
        action not in played and action.users > 0 for action in bpy.data.actions
    )


def _export_abc(place: Path, export: Export) -> None:
    scene = bpy.context.scene
    frames = scene.frame_start, scene.frame_end
    if not _moves():  # otherwise a copy of the shape for every frame
        frames = scene.frame_current, scene.frame_current
    export.options["start"], export.options["end"] = frames
    # Without materials it would write one of its own.
    has_materials = any(slot.material for obj in export.meshes for slot in obj.material_slots)
    export.options["face_sets"] = has_materials
    graph = bpy.context.evaluated_depsgraph_get()
    most = alembic_size([obj.evaluated_get(graph).data for obj in export.meshes])
    # A disk that gets full would end the process.
    with export.dressed(), with_room(place, most * (frames[1] - frames[0] + 1)) as path:
        export.call(path)


def _export_obj(place: Path, export: Export) -> None:
    # Beside the target, so that textures are found from there.
    first = place.parent.with_suffix(".obj")
    with export.dressed(), _beside(place, export):
        export.call(first)
        finish_obj.finish(first, place, export.source.digits, export.meshes)
    materials = first.with_suffix(".mtl")
    if materials.exists():
        _ensure_materials(place, materials)
        os.replace(materials, place.with_suffix(".mtl"))


def _ensure_materials(place: Path, materials: Path) -> None:
    """Raise Torn if a material that is used is not whole."""
    with materials.open("rb") as file:
        lines = list(file)
    defined = {line.removeprefix(b"newmtl ") for line in lines if line.startswith(b"newmtl ")}
    with place.open("rb") as file:
        used = {line.removeprefix(b"usemtl ") for line in file if line.startswith(b"usemtl ")}
    used -= {b"\n"}  # of an empty slot of what nodes make
    is_whole = used <= defined and (not lines or lines[-1].endswith(b"\n"))
    require(is_whole, "its materials are not all there")


def _export_ply(place: Path, export: Export) -> None:
    source, look = export.source, export.source.ply
    has_normals = look is not None and set(finish_ply.NORMALS) <= look.columns
    export.options["export_normals"] = has_normals or any(
        obj.data.has_custom_normals for obj in export.meshes
    )
    export.options["ascii_format"] = is_text(".ply", source)
    with export.dressed():
        with rendered_as_shown():  # Blender 5.2 writes what is rendered
            export.call(place)
        ply_names.mend(place)
        check(place)
        finish_ply.finish(place, source.digits, look, len(export.meshes) == 1)


def _export_stl(place: Path, export: Export) -> None:
    source = export.source
    export.options["ascii_format"] = is_text(".stl", source)
    export.call(place)
    check(place)
    if source.digits.is_moved and export.options["ascii_format"]:
        _move_stl(place, source.digits)


def _move_stl(place: Path, digits: Digits) -> None:
    """Write an STL file of text anew, relative to 0."""
    points = stl.points(place)
    target = place.with_stem(f"{place.stem}_moved")
    write_stl(place, target, (points + digits.offset).round(decimals_of(points)))
    os.replace(target, place)


def _export_usd(place: Path, export: Export) -> None:
    own = export.source.keys

    def is_kept(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> bool:
        return key.name in own.get(obj.name, ()) or _is_animated_key(obj, key)

    keyed = [obj for obj in export.meshes if obj.data.shape_keys is not None]
    has_kept = any(is_kept(obj, key) for obj in keyed for key in obj.data.shape_keys.key_blocks[1:])
    # What has a skeleton is written as it is without its keys and its other modifiers.
    rigged = [obj for obj in export.meshes if armatures(obj)]
    laid_out = [*dict.fromkeys([*(keyed if has_kept else ()), *rigged])]
    export.options["export_shapekeys"] = has_kept
    # Without animation Blender 4.2 leaves poses out.
    has_rigs = any(obj.type == "ARMATURE" for obj in export.objects)
    is_old = bpy.app.version < (4, 3)
    export.options["export_animation"] = has_kept or _moves() or (is_old and has_rigs)
    # Beside the target, so that textures are found from there; an archive has a file of its name.
    is_archive = export.suffix == ".usdz"
    first = place if is_archive else place.parent.with_suffix(export.suffix)
    export.options["export_textures_mode"] = "NEW" if is_archive else "KEEP"
    textures = nullcontext() if is_archive else _beside(place, export)
    laid = _shown(export, laid_out, is_kept)
    with _parented(export), laid, textures, _frames_that_move(), in_metres(export.suffix):
        export.call(first)
    if first != place:
        os.replace(first, place)


@contextmanager
def _parented(export: Export) -> Iterator[None]:
    """Have meshes be children of the armatures that move them.

    Blender's importer takes others to be where the armature's own space begins.
    """
    loose = [(obj, armatures(obj)[0].object) for obj in export.meshes if armatures(obj)]
    loose = [(obj, rig) for obj, rig in loose if obj.parent is None and rig in export.objects]
    with Temporary() as now:
        for obj, rig in loose:
            now.adopt(obj, rig, rig.matrix_world.inverted_safe())
        yield


def _beside(place: Path, export: Export) -> AbstractContextManager[None]:
    return beside(export.objects, export.target, place.parent)


def _is_animated_key(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> bool:
    keys = obj.data.shape_keys
    curves = (*(curves_of(keys) or ()), *drivers_of(keys))
    return any(curve.data_path == key.path_from_id("value") for curve in curves)


def _moves() -> bool:
    """Whether something in the scene moves as frames go by."""
    return any(is_animated(obj) for obj in bpy.context.scene.objects)


@contextmanager
def _frames_that_move() -> Iterator[None]:
    """Have the scene consist of its current frame if nothing moves."""
    scene = bpy.context.scene
    with Temporary() as now:
        for end in () if _moves() else ("frame_start", "frame_end"):
            now.put(scene, end, scene.frame_current)
        yield


def _export_dae(place: Path, export: Export) -> None:
    with export.dressed(), _beside(place, export):
        export.call(place)


WRITERS = {
    ".glb": _export_gltf, ".gltf": _export_gltf, ".fbx": _export_fbx, ".abc": _export_abc,
    ".obj": _export_obj, ".ply": _export_ply, ".stl": _export_stl, ".dae": _export_dae,
}  # fmt: skip
