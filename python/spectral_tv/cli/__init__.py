"""The command line without Blender: ``spectral-tv VERB INPUT -o OUTPUT``.

It needs trimesh and meshio, which read and write the files: ``pip install "spectral-tv[cli]"``.
"""

import sys

PROGRAM = "spectral-tv"
ADVICE = 'pip install "spectral-tv[cli]"'


def main() -> None:
    """Do what the command line says, and exit with its code."""
    try:
        from spectral_tv.cli.verbs import run  # noqa: PLC0415 - needs what may be missing
    except ModuleNotFoundError as error:
        sys.exit(f"{PROGRAM}: {error.name} is missing: {ADVICE}")
    sys.exit(run(sys.argv[1:]))
