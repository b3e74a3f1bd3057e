"""What happens when Blender loads a file."""

import bpy
from bpy.app.handlers import persistent

from .decomposition.bands import forget_flows
from .job import faults, jobs
from .operators import live


@persistent
def _before_load(*_arguments: object) -> None:
    jobs.finish()
    live.end()
    forget_flows()
    faults.forget()


def register() -> None:
    """Listen for files being loaded."""
    bpy.app.handlers.load_pre.append(_before_load)


def unregister() -> None:
    """End what still runs, and stop listening."""
    bpy.app.handlers.load_pre.remove(_before_load)
    _before_load()
