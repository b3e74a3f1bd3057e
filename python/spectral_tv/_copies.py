"""Copying and pickling the classes of the native module."""

from typing import Any

from spectral_tv._native import Decomposition, Deformer, Flow, Mesh, Poser, _reduced


def _reduce(thing: Any) -> Any:
    """What `pickle` asks for: how the thing is made again of its parts."""
    return _reduced(thing)


def _itself(thing: Any, *_: object) -> Any:
    """What nothing can change is its own copy."""
    return thing


def prepare() -> None:
    """Have objects be pickled by their parts, and copied."""
    copies = {"__copy__": _itself, "__deepcopy__": _itself}
    for kind in (Decomposition, Deformer, Flow, Mesh, Poser):
        ways = {"__reduce__": _reduce} | ({} if kind in (Deformer, Poser) else copies)
        for name, way in ways.items():
            setattr(kind, name, way)
