"""Work of the extension: short and endless, started as by its buttons, and over without a trace."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import bpy
from screen import PICTURES, Steps, in_view, until

# Steps of work that outlasts every wait, and of work that is soon done.
ENDLESS, FEW = 1000, 8
# What is cancelled at random moments.
LONG_WORK = (
    ("decompose", {"method": "M1", "steps": ENDLESS}),
    ("decompose", {"method": "M2", "steps": ENDLESS}),
    ("decompose", {"method": "M3", "steps": ENDLESS}),
    ("decompose", {"method": "LB", "steps": ENDLESS, "eigenpairs": 3000}),
    ("measure_accuracy", {"steps": ENDLESS}),
    ("caricature", {"steps": ENDLESS}),
    ("cosegment", {"steps": ENDLESS}),
    ("flow_attribute", {"kind": "GROUP", "source": "Half", "steps": ENDLESS}),
    ("plot_values", {"kind": "GROUP", "source": "Half", "steps": ENDLESS}),
)

# One for every operator that runs a job.
SHORT_WORK = {
    "bake_deformation": {"frame_end": 3},
    "bake_filter": {"frame_end": 3, "filepath": str(PICTURES / "cache.pc2")},
    "bake_safe": {},
    "blur_mask": {"radius": 10},
    "caricature": {"steps": FEW + 1},  # another flow than that of decompose
    "cosegment": {"steps": FEW},
    "decompose": {"steps": FEW},
    "deform": {},
    "filter_image": {"image": "Photo", "steps": FEW},
    "flow_attribute": {"kind": "GROUP", "source": "Half", "steps": FEW},
    "measure_accuracy": {"bands": 3, "steps": FEW},
    "measure_thickness": {},
    "plot_values": {"kind": "GROUP", "source": "Half", "steps": FEW},
    "recipe": {"recipe": "Stylize"},
    "rig_from_pose": {},
    "test_eigenset": {"group": "Cap"},
}


def start(name: str, window: bpy.types.Window | None = None, **arguments: object) -> None:
    """Start an operator as its button does."""
    with in_view(window):
        status = getattr(bpy.ops.spectral_tv, name)("INVOKE_DEFAULT", **arguments)
    runs_a_job = name in SHORT_WORK or name == "deform_live"
    assert status == ({"RUNNING_MODAL"} if runs_a_job else {"FINISHED"}), f"{name}: {status}"


def all_ended() -> Steps[None]:
    """Wait until no job runs, none is left, and the window has seen it."""
    yield from until(lambda: not is_running(), "the job to be over")
    yield from until(lambda: not workers(), "the threads to end")
    yield 0.1


def is_running() -> bool:
    return bpy.ops.spectral_tv.cancel.poll()


def workers() -> list[str]:
    """Threads of jobs; those that short work shares stay."""
    names = []
    for path in Path("/proc/self/task").glob("*/comm"):
        with suppress(OSError):  # it has ended since
            names.append(path.read_text())
    return [name for name in names if name.startswith("spectral_tv")]


def megabytes() -> float:
    """Memory of this process."""
    status = Path("/proc/self/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024
