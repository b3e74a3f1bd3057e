"""Where a command reads and writes: the arguments, and what is wrong with them."""

import argparse
import os
from collections.abc import Iterable
from pathlib import Path

from spectral_tv.files.names import file_keys
from spectral_tv.refusal import Refusal

EXIT_CODES = "exit codes: 0 if everything succeeded, 1 if an input failed, 2 for wrong arguments"


def add_places(
    parser: argparse.ArgumentParser,
    read: str,
    written: str,
    suffix: str,
    *,
    is_required: bool,
    default: str = "as the input",
) -> None:
    """Declare what is read and where the result goes, in words, with a suffix as an example.

    ``default`` is the format if none is given, in words.
    """
    add = parser.add_argument
    add(
        "inputs",
        metavar="INPUT",
        nargs="*",
        type=path,
        help=f"{read}, a folder of such files, or a pattern such as 'scans/*'",
    )
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
        help=f"what to write into the folder, such as {suffix}; {default} if not given",
    )


def add_report(parser: argparse.ArgumentParser) -> None:
    """Declare where what became of every input is written."""
    parser.add_argument(
        "--report",
        metavar="FILE",
        type=target_path,
        help="add a line of JSON for every input to this file, such as report.jsonl",
    )


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


def target_of(choices: argparse.Namespace, source: Path) -> Path:
    """The file to write for an input: the output itself, or one in that folder."""
    output: Path = choices.output
    if not is_folder(output):
        return output
    return beneath(choices, output, source) / f"{source.stem}{choices.format or source.suffix}"


def beneath(choices: argparse.Namespace, folder: Path, source: Path) -> Path:
    """Where in a folder the result of an input goes: as deep as it was in the folder named."""
    deeper: Path = choices.beneath.get(source, Path())
    return folder / deeper


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


def is_folder(place: Path) -> bool:
    """Whether there is a folder of that name, whatever the name."""
    try:
        return place.is_dir()
    except (OSError, ValueError):  # a name that is too long
        return False


def ensure_file(place: Path) -> None:
    """Raise Refusal if there is no file to read."""
    if is_folder(place):
        raise Refusal(f"it is a folder; name the files in it, such as {place / '*'}")
    if not place.is_file():
        raise Refusal("there is no such file")


def target_path(text: str) -> Path:
    """A type of argument: a file to write, or a folder that is there if it ends like one."""
    place = path(text)
    if text.endswith(("/", os.sep)) and not is_folder(place):
        raise argparse.ArgumentTypeError(f"there is no folder {text}")
    return place


def path(text: str) -> Path:
    """A type of argument: a file or a folder."""
    return Path(text).expanduser()
