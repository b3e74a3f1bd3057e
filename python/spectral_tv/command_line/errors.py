"""Errors in one line."""

import re

from spectral_tv.files.whole import PREFIX

TEMPORARY = re.compile(rf"{re.escape(PREFIX)}[0-9a-f]{{12}}/?")
PYTHONS = re.compile(r"^\w+Error: (\[Errno \d+\] )?")


def reason(error: Exception) -> str:
    """The message of an error; Blender's own begin with a label, and may have many lines."""
    lines = [line.strip() for line in str(error).splitlines()]
    told = [line for line in lines if line and not line.startswith("Location:")]
    if any(line.startswith("Traceback") or "Python: Traceback" in line for line in told):
        told = [PYTHONS.sub("", told[-1])]
    text = "; ".join(line.removeprefix("Error: ") for line in told)
    text = TEMPORARY.sub("", text)
    if isinstance(error, MemoryError) and "memory" not in text.lower():
        return f"memory ran out: {text}".removesuffix(": ")
    return text or type(error).__name__


# What the sidebar calls Join Within.
JOIN = re.compile(r"set Join Within to (\S+) %")


def in_options(text: str) -> str:
    """A message with the option of the command line instead of the property in the sidebar."""
    found = JOIN.sub(r"pass --weld \1", text).replace("raise Join Within", "raise --weld")
    return found.replace("Elements: Edges", "--elements edges")
