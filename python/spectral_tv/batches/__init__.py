"""Many files: which ones, who works on them, and what became of each.

A task is a file and what to do with it. A worker is a process that does one task after the other;
what a file does to it, the others do not notice. Any executor can hand the tasks to workers.
"""
