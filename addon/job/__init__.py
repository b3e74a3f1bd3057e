"""Work beside Blender: the thread it runs in, what it will take, and what it refused."""

import bpy
from bpy.props import PointerProperty

from . import faults, jobs, operator, select_faulty, timers

CLASSES = (operator.SpectralTVWindowManager, *operator.CLASSES, *select_faulty.CLASSES)
PROPERTIES = (
    (
        bpy.types.WindowManager,
        "spectral_tv",
        PointerProperty(type=operator.SpectralTVWindowManager),
    ),
)
FORGET = (jobs.finish, faults.forget)
WITHDRAW = (timers.remove_all,)
