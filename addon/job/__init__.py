"""Work beside Blender: the thread it runs in, what it will take, and what it refused."""

from . import faults, jobs, operator, select_faulty, timers

FILES = (operator, select_faulty)
FORGET = (jobs.finish, faults.forget)
WITHDRAW = (timers.remove_all,)
