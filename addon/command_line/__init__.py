"""The command line: ``blender --command spectral_tv VERB INPUT -o OUTPUT``."""

from collections.abc import Sequence

import bpy
from spectral_tv.command_line import program
from spectral_tv.command_line.command import Command

NAME = "spectral_tv"
_verbs: list[type[Command]] = []


def run(arguments: list[str]) -> int:
    """Do what the command line says and return the exit code: 0 only if all succeeded."""
    return program.run(f"blender --command {NAME}", _verbs, arguments)


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
