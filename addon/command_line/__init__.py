"""The command line: ``blender --command spectral_tv VERB INPUT -o OUTPUT``."""

import argparse
from collections.abc import Sequence
from typing import NoReturn

import bpy
from spectral_tv.command_line import signals, streams

from .verb import Command

NAME = "spectral_tv"
_verbs: list[type[Command]] = []


def run(arguments: list[str]) -> int:
    """Do what the command line says and return the exit code: 0 only if all succeeded."""
    try:
        with streams.may_be_lost(), signals.heeded():
            return _run(arguments)
    except SystemExit as end:  # it would close Blender, and the code would be lost
        return end.code if isinstance(end.code, int) else 1
    except KeyboardInterrupt:  # also one that came at the beginning or the end of heeding
        return signals.code()


class _Parser(argparse.ArgumentParser):
    """One that says in a line what is wrong."""

    def error(self, message: str) -> NoReturn:
        """Say it, and where more is said, and end with 2."""
        self.exit(2, f"{self.prog}: error: {message} (--help tells all arguments)\n")


def _run(arguments: list[str]) -> int:
    parser = _Parser(
        prog=f"blender --command {NAME}",
        description="Filter the detail of meshes or pictures, or move parts of meshes.",
    )
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for verb in _verbs:
        verb.add_to(commands)
    choices = parser.parse_args(arguments)
    return choices.run(choices).run()


_handle = None


def register(verbs: Sequence[type[Command]]) -> None:
    """Make the command, with these verbs, known to Blender."""
    _verbs[:] = verbs
    global _handle  # noqa: PLW0603 - it lives as long as the module
    _handle = bpy.utils.register_cli_command(NAME, run)


def unregister() -> None:
    """Withdraw the command."""
    global _handle  # noqa: PLW0603 - it lives as long as the module
    bpy.utils.unregister_cli_command(_handle)
    _handle = None
