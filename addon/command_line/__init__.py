"""The command line: ``blender --command spectral_tv VERB INPUT -o OUTPUT``."""

import sys
from collections.abc import Sequence
from importlib import import_module

import bpy

NAME = "spectral_tv"
# The module that a verb is in, and its class.
Named = tuple[str, str]
_verbs: list[Named] = []


def run(arguments: list[str]) -> int:
    """Do what the command line says and return the exit code: 0 only if all succeeded.

    What does so is imported here, as Blender's window makes no use of it.
    """
    program = import_module("spectral_tv.command_line.program")
    verbs = [getattr(import_module(module), name) for module, name in _verbs]
    return program.run(f"blender --command {NAME}", verbs, arguments, _child())


def _child() -> list[str] | None:
    """What starts this program again; None if it is not Blender's command line."""
    for place, argument in enumerate(sys.argv):
        if argument in ("-c", "--command") and sys.argv[place + 1 : place + 2] == [NAME]:
            return [bpy.app.binary_path, *sys.argv[1 : place + 2]]
    return None


_handle = None


def register(verbs: Sequence[Named]) -> None:
    """Make the command, with these verbs, known to Blender."""
    _verbs[:] = verbs
    global _handle  # noqa: PLW0603 - it lives as long as the module
    _handle = bpy.utils.register_cli_command(NAME, run)


def unregister() -> None:
    """Withdraw the command."""
    global _handle  # noqa: PLW0603 - it lives as long as the module
    bpy.utils.unregister_cli_command(_handle)
    _handle = None
