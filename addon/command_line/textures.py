"""Textures beside a file that cannot hold them."""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import bpy

from ..scene.temporary import Temporary
from .contents import image_nodes


def folder_name(target: Path) -> str:
    """The folder beside a file that holds its textures; no other file's are in it."""
    return f"{target.stem}_textures"


@contextmanager
def beside(objects: Sequence[bpy.types.Object], target: Path, staging: Path) -> Iterator[None]:
    """Have materials refer to images that lie beside ``target``, or will.

    Images that are elsewhere, or in no file, are written to ``staging``, of which all will be put
    beside the target.
    """
    materials = {slot.material: None for obj in objects for slot in obj.material_slots}
    trees = [material.node_tree for material in materials if material is not None]
    nodes = dict.fromkeys(node for tree in trees for node in image_nodes(tree))
    copies: dict[bpy.types.Image, bpy.types.Image | None] = {}
    with Temporary() as now:
        for node in nodes:
            image = node.image
            if image not in copies:
                copies[image] = _copy(image, target, staging, len(copies))
                if copies[image] is not None:
                    now.made(copies[image])
            if copies[image] is not None:
                now.put(node, "image", copies[image])
        yield


def _copy(
    image: bpy.types.Image, target: Path, staging: Path, number: int
) -> bpy.types.Image | None:
    """An image in a file of its own beside the target; None if it is in one, or has no pixels."""
    if image.source not in ("FILE", "GENERATED"):
        return None
    path = Path(bpy.path.abspath(image.filepath, library=image.library) or image.name)
    is_file = image.source == "FILE" and path.is_file() and not image.is_dirty
    if image.packed_file is None and is_file:
        if path.resolve().is_relative_to(target.parent.resolve()):
            return None
    elif image.packed_file is None and not image.has_data and not image.is_dirty:
        return None
    folder = staging / folder_name(target)
    folder.mkdir(exist_ok=True)
    suffix = path.suffix if path.suffix.lower() in bpy.path.extensions_image else ".png"
    place = folder / (bpy.path.clean_name(path.stem) + suffix)
    if place.exists():
        place = place.with_stem(f"{place.stem}_{number}")
    if image.packed_file is not None and not image.is_dirty:
        place.write_bytes(image.packed_file.data)
    elif is_file:
        shutil.copyfile(path, place)
    else:
        image.save(filepath=str(place), save_copy=True)
    copy = bpy.data.images.load(str(place))
    copy.colorspace_settings.name = image.colorspace_settings.name
    copy.alpha_mode = image.alpha_mode
    copy.filepath_raw = str(target.parent / folder.name / place.name)
    return copy
