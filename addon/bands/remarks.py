"""What the user has to be told of a change without a button: a panel says it beneath.

Blender reports what operators do alone.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import bpy
from spectral_tv.notes import gathered

from ..drawing.sidebar import say

# By the mesh and what was changed: what it became, and what is to be told of it.
_told: dict[tuple[int, str], tuple[Any, list[str]]] = {}


@contextmanager
def remarked(mesh: bpy.types.Mesh, what: str, state: Callable[[], Any]) -> Iterator[None]:
    """Keep what is noted meanwhile, as long as the mesh has the ``state`` that it has then."""
    with gathered() as notes:
        yield
    _told[mesh.session_uid, what] = state(), notes


def remarks_of(mesh: bpy.types.Mesh, what: str, state: Any) -> list[str]:
    """What is to be told of a mesh in that state."""
    became, notes = _told.get((mesh.session_uid, what), (None, []))
    return notes if became == state else []


def draw(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    mesh: bpy.types.Mesh,
    what: str,
    state: Any,
) -> None:
    """Draw it."""
    for text in remarks_of(mesh, what, state):
        say(layout, context, text[0].upper() + text[1:], "INFO")


def forget() -> None:
    """Let go of all of it."""
    _told.clear()
