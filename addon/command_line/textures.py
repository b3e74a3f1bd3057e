"""Textures beside a file that cannot hold them."""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import bpy


def folder_name(target: Path) -> str:
    """The folder beside a file that holds its textures; no other file's are in it."""
    return f"{target.stem}_textures"


@contextmanager
def beside(objects: Sequence[bpy.types.Object], target: Path, staging: Path) -> Iterator[None]:
    """Have materials refer to images that lie beside ``target``, or will.

    Images that are elsewhere, or in no file, are written to ``staging``, of which all will be put
    beside the target.
    """
    trees = _trees(objects)
    swapped: list[tuple[bpy.types.Node, bpy.types.Image]] = []
    made: dict[bpy.types.Image, bpy.types.Image | None] = {}
    try:
        for tree in trees:
            for node in tree.nodes:
                if node.type != "TEX_IMAGE" or node.image is None:
                    continue
                if node.image not in made:
                    made[node.image] = _copy(node.image, target, staging, len(made))
                if (copy := made[node.image]) is not None:
                    swapped.append((node, node.image))
                    node.image = copy
        yield
    finally:
        for node, image in swapped:
            node.image = image
        bpy.data.batch_remove([copy for copy in made.values() if copy is not None])


def _trees(objects: Sequence[bpy.types.Object]) -> list[bpy.types.NodeTree]:
    """The trees of nodes of all materials of objects, and the groups in them."""
    found: dict[bpy.types.NodeTree, None] = {}
    left = [
        slot.material.node_tree
        for obj in objects
        for slot in obj.material_slots
        if slot.material is not None and slot.material.node_tree is not None
    ]
    while left:
        tree = left.pop()
        if tree not in found:
            found[tree] = None
            groups = [node for node in tree.nodes if node.type == "GROUP"]
            left += [node.node_tree for node in groups if node.node_tree is not None]
    return list(found)


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
    place = folder / (bpy.path.clean_name(path.stem) + (path.suffix if is_suffix(path) else ".png"))
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


def is_suffix(path: Path) -> bool:
    """Whether a path ends like one of a picture."""
    return path.suffix.lower() in bpy.path.extensions_image
