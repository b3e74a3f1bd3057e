"""Reading and checking the arguments that every verb takes."""

import argparse
import os
from collections.abc import Iterable
from pathlib import Path

from spectral_tv.files.names import file_keys
from spectral_tv.refusal import Refusal

from .formats import exportable

EXIT_CODES = "exit codes: 0 if everything succeeded, 1 if an input failed, 2 for wrong arguments"


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


def add_places(
    parser: argparse.ArgumentParser, read: str, written: str, suffix: str, *, is_required: bool
) -> None:
    """Declare what is read and where the result goes, in words, with a suffix as an example."""
    add = parser.add_argument
    add("inputs", metavar="INPUT", nargs="+", type=_path, help=read)
    add(
        "-o",
        "--output",
        type=target_path,
        required=is_required,
        help=f"{written} to write, or a folder that exists",
    )
    add(
        "--format",
        metavar="SUFFIX",
        type=lambda text: "." + text.lower().lstrip("."),
        help=f"what to write into the folder, such as {suffix}; as the input if not given",
    )


def add_report(parser: argparse.ArgumentParser) -> None:
    """Declare where what became of every input is written."""
    parser.add_argument(
        "--report",
        metavar="FILE",
        type=target_path,
        help="add a line of JSON for every input to this file, such as report.jsonl",
    )


def complaint(choices: argparse.Namespace) -> str | None:
    """What is wrong with the arguments together; None if nothing is."""
    if choices.output is None and choices.render is None:
        return "say where the result goes: -o, --render or both"
    places = (("-o", choices.output), ("--render", choices.render))
    return complaint_of_places(choices, places) or _complaint_of_targets(choices)


def complaint_of_places(
    choices: argparse.Namespace, places: Iterable[tuple[str, Path | None]]
) -> str | None:
    """What is wrong with the files or folders to write to, by their arguments."""
    if choices.format is not None and not (choices.output and is_folder(choices.output)):
        return "--format goes with -o and a folder that exists"
    for name, place in places:
        if place is None or is_folder(place):
            continue
        if len(choices.inputs) > 1:
            return f"several inputs need a folder that exists: {name} {place}"
        if not is_folder(place.parent):
            return f"there is no folder {place.parent}"
    return None


def outputs(choices: argparse.Namespace, source: Path) -> tuple[Path | None, Path | None]:
    """The file and the picture to write for an input."""
    file, picture = choices.output, choices.render
    if file is not None and is_folder(file):
        file = file / f"{source.stem}{choices.format or source.suffix}"
    if picture is not None and is_folder(picture):
        picture = picture / f"{source.stem}.png"
    return file, picture


def _complaint_of_targets(choices: argparse.Namespace) -> str | None:
    writable = exportable()
    targets: list[Path] = []
    for source in choices.inputs:
        file, picture = outputs(choices, source)
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


def complaint_of_clashes(
    choices: argparse.Namespace, targets: list[Path], is_replaced: bool = True
) -> str | None:
    """What is wrong with writing these files, and the report, beside the inputs.

    An input that is named as output is replaced if ``is_replaced``.
    """
    count = len(choices.inputs)
    report = [] if choices.report is None else [choices.report]
    keys = file_keys([*choices.inputs, *targets, *report])
    inputs, taken = set(keys[:count]), set()
    for target, key in zip(targets, keys[count:], strict=False):
        if key in taken:
            return f"two inputs would become {target}"
        if key in inputs and not is_replaced:
            return f"an input would be overwritten: {target}"
        if key in inputs and target != choices.output:
            return f"{target} is an input; name it with -o, or choose another folder"
        taken.add(key)
    if report and keys[-1] in inputs | taken:
        return f"--report {choices.report} is an input or an output too"
    return None


def is_folder(path: Path) -> bool:
    """Whether there is a folder of that name, whatever the name."""
    try:
        return path.is_dir()
    except (OSError, ValueError):  # a name that is too long
        return False


def ensure_file(path: Path) -> None:
    """Raise Refusal if there is no file to read."""
    if is_folder(path):
        raise Refusal(f"it is a folder; name the files in it, such as {path / '*'}")
    if not path.is_file():
        raise Refusal("there is no such file")


def target_path(text: str) -> Path:
    """A type of argument: a file to write, or a folder that is there if it ends like one."""
    path = _path(text)
    if text.endswith(("/", os.sep)) and not is_folder(path):
        raise argparse.ArgumentTypeError(f"there is no folder {text}")
    return path


def _path(text: str) -> Path:
    return Path(text).expanduser()
