"""--apply on the command line: files whose meshes have the look as their shape, and no bands."""

import argparse
from collections.abc import Sequence

import bpy
from spectral_tv.notes import note

from .apply_look import become_look


def add_apply(parser: argparse.ArgumentParser) -> None:
    """Declare it."""
    parser.add_argument(
        "--apply",
        action="store_true",
        help="make the result the shape of the mesh, as Apply Look does: .blend, .glb, .gltf and "
        ".fbx files then have no bands. Other shape keys stay",
    )


def complaint_of_apply(choices: argparse.Namespace) -> str | None:
    """What is wrong with it beside others; None if nothing is."""
    if choices.apply and choices.frames is not None:
        return "--apply is not for --frames: there the file has no bands anyway"
    return None


def apply_each(
    objects: Sequence[bpy.types.Object], keys: Sequence[Sequence[bpy.types.ShapeKey]]
) -> None:
    """Do it to objects, with the keys that are the bands of each and what was made of them."""
    for obj, mine in zip(objects, keys, strict=True):
        count = len(mine)
        become_look(obj, mine)
        note(f"{count} shape keys became the shape of {obj.name!r}")
