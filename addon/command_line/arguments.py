"""The arguments that every verb about meshes takes."""

import argparse
from contextlib import suppress
from pathlib import Path

from spectral_tv.command_line.places import (
    add_places,
    add_report,
    beneath,
    complaint_of_clashes,
    complaint_of_places,
    is_folder,
    target_of,
    target_path,
)
from spectral_tv.files.numbered import Numbered
from spectral_tv.notes import gathered
from spectral_tv.refusal import Refusal

from .formats import exportable, importable


def add_arguments(parser: argparse.ArgumentParser, verb: str, result: str) -> None:
    """Declare the arguments; ``verb`` is what is done to objects, ``result`` what they are then."""
    add_places(parser, "a file that Blender imports", "the file", "glb", is_required=False)
    add = parser.add_argument
    add(
        "--render",
        metavar="PICTURE",
        type=target_path,
        help=f"picture the {result} objects: a .png, or a folder that exists",
    )
    add(
        "--object",
        metavar="NAME",
        dest="objects",
        action="append",
        help=f"{verb} this object instead of all; repeatable. Formats other than .blend then hold "
        "nothing else",
    )
    add_report(parser)


def complaint(choices: argparse.Namespace) -> str | None:
    """What is wrong with the arguments together; None if nothing is."""
    if choices.output is None and choices.render is None:
        return "say where the result goes: -o, --render or both"
    places = (("-o", choices.output), ("--render", choices.render))
    return complaint_of_places(choices, places) or _complaint_of_targets(choices)


def outputs(choices: argparse.Namespace, source: Path) -> tuple[Path | None, Path | None]:
    """The file and the picture to write for an input."""
    if is_folder(source):  # of numbered files
        with suppress(Refusal, OSError), gathered():  # it has its own message
            source = Numbered.of(source, importable()).unnumbered
    file = None if choices.output is None else target_of(choices, source)
    picture = choices.render
    if picture is not None and is_folder(picture):
        picture = beneath(choices, picture, source) / f"{source.stem}.png"
    return file, picture


def _complaint_of_targets(choices: argparse.Namespace) -> str | None:
    writable = exportable()
    targets: list[Path] = []
    for source in choices.inputs:
        file, picture = outputs(choices, source)
        is_among = is_folder(source) and file is not None
        if is_among and file.parent.resolve() == source.resolve():
            return f"the results would be among the frames in {source}; choose another folder"
        # An input without a known suffix has its own message.
        if file is not None and file.suffix.lower() not in writable:
            if is_folder(choices.output) and choices.format is None:
                file = None
            else:
                return f"this Blender writes no {file.suffix or 'files without suffix'}: {file}"
        if picture is not None and picture.suffix.lower() != ".png":
            return f"the picture has to be a .png: {picture}"
        targets += [target for target in (file, picture) if target is not None]
    return complaint_of_clashes(choices, targets)
