"""The verbs of the command line without Blender."""

from spectral_tv.cli import PROGRAM
from spectral_tv.cli.decompose import Decompose
from spectral_tv.command_line import program

VERBS = (Decompose,)


def run(arguments: list[str]) -> int:
    """Do what the command line says and return the exit code: 0 only if all succeeded."""
    return program.run(PROGRAM, VERBS, arguments)
