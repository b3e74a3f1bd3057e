"""Jobs: long work in a thread beside Blender, its estimates, and what it refused."""

FILES = (
    "operator",
    "select_faulty",
)
FORGET = (
    "jobs.finish",
    "faults.forget",
)
WITHDRAW = ("timers.remove_all",)
