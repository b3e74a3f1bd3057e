"""The panel and the command that take the place of all else if the native module cannot be used."""

import sys

import bpy

from . import native
from .drawing.sidebar import Sidebar, say


class SPECTRAL_TV_PT_unavailable(Sidebar, bpy.types.Panel):  # noqa: N801 - Blender's convention
    """Says what is missing"""

    bl_label = "Spectral TV"

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draw the one sentence."""
        say(layout, context, _problem, "ERROR")


def run(_arguments: list[str]) -> int:
    """Say what is missing; the exit code of a command that could not start."""
    print(f"spectral_tv: {_problem}", file=sys.stderr)
    return 1


_problem = ""
_handle = None


def register() -> None:
    """Show the panel, and have the command say the same."""
    global _problem, _handle  # noqa: PLW0603 - it lives as long as the module
    _problem = native.problem() or ""
    print(f"Spectral TV: {_problem}", file=sys.stderr)
    bpy.utils.register_class(SPECTRAL_TV_PT_unavailable)
    _handle = bpy.utils.register_cli_command("spectral_tv", run)


def unregister() -> None:
    """Withdraw both."""
    global _handle  # noqa: PLW0603 - it lives as long as the module
    bpy.utils.unregister_cli_command(_handle)
    bpy.utils.unregister_class(SPECTRAL_TV_PT_unavailable)
    _handle = None
