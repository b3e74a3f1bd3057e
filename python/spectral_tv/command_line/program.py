"""Running a command line: its arguments, signals, streams and exit code."""

import argparse
from collections.abc import Iterable
from typing import Any, NoReturn

from spectral_tv.command_line import signals, streams
from spectral_tv.command_line.command import Command

DESCRIPTION = "Filter the detail of meshes or pictures, or move parts of meshes."


def run(program: str, verbs: Iterable[type[Command]], arguments: list[str]) -> int:
    """Do what the command line says and return the exit code: 0 only if all succeeded.

    ``program`` is what users write before the verb.
    """
    try:
        with streams.may_be_lost(), signals.heeded():
            choices = _parser(program, verbs).parse_args(arguments)
            return choices.run(choices).run()
    except SystemExit as end:  # it would close Blender, and the code would be lost
        return end.code if isinstance(end.code, int) else 1
    except KeyboardInterrupt:  # also one that came at the beginning or the end of heeding
        return signals.code()


class _Parser(argparse.ArgumentParser):
    """One that says in a line what is wrong."""

    def error(self, message: str) -> NoReturn:
        """Say it, and where more is said, and end with 2."""
        self.exit(2, f"{self.prog}: error: {message} (--help tells all arguments)\n")


def _parser(program: str, verbs: Iterable[type[Command]]) -> argparse.ArgumentParser:
    parser = _Parser(prog=program, description=DESCRIPTION)
    commands: Any = parser.add_subparsers(metavar="COMMAND", required=True)
    for verb in verbs:
        verb.add_to(commands, program)
    return parser
