"""What is said of a map that was baked."""

from pathlib import Path

from .baking import Map
from .settings import KINDS, NORMAL, MapSettings


def told(baked: Map, asked: MapSettings, target: Path) -> str:
    """Say which map is where."""
    what = "its look" if asked.source == "LOOK" else f"band {asked.band}"
    label = next(label for kind, label, _ in KINDS if kind == baked.kind)
    text = f"{label!r} of {what} in {asked.size} × {asked.size} pixels: {target}"
    if baked.kind == NORMAL:
        return text
    return f"{text}; it moves up to {baked.farthest:.3g} in object space"
