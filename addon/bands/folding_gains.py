"""Gains on the command line that fold faces: told, and clamped if that is asked for."""

import argparse
from collections.abc import Sequence

import bpy
from spectral_tv.bands.counts import Counts
from spectral_tv.bands.guard import GuardSettings, advice_of
from spectral_tv.command_line.progress import progress
from spectral_tv.notes import gathered, listed, note

from ..scene.records import bands_of
from .bands import set_values
from .clamping import Clamping
from .guard import Reference


class FoldingGains:
    """What is to be said of the gains; over frames, all at once in the end."""

    def __init__(self, choices: argparse.Namespace) -> None:
        """Take what was chosen."""
        self._is_safe, self._is_moving = choices.safe, choices.frames is not None
        self._counts: list[Counts] = []
        self._left = 0

    def look(
        self, objects: Sequence[bpy.types.Object], label: str
    ) -> list[list[bpy.types.ShapeKey]]:
        """Count, and clamp, what the bands of objects do that are one surface.

        Returns the keys of each that do it now. Raises Refusal or spectral_tv.MeshError.
        """
        bands = [[key for key in bands_of(obj) if key is not None] for obj in objects]
        pairs = zip(objects, bands, strict=True)
        found = sum((Reference().counts(*pair) for pair in pairs), Counts())
        self._counts.append(found)
        is_added = any(key.value > 0 for keys in bands for key in keys)
        if self._is_safe and found and is_added:
            safe = self._clamp(objects, label)
            return [[*keys, key] for keys, key in zip(bands, safe, strict=True)]
        if found and not self._is_moving:
            note(f"at these gains {found.told()}{advice_of(is_added)}")
        return bands

    def note_frames(self) -> None:
        """Note what was found in frames."""
        bad = [each for each in self._counts if each]
        if bad:
            most = Counts(max(each.folded for each in bad), max(each.stretched for each in bad))
            clamped = ", before they are clamped" if self._is_safe else ""
            note(
                f"at these gains {most.told()} at most in a frame{clamped}, and some in "
                f"{len(bad)} of {len(self._counts)}"
            )
        if self._left:
            note(f"in {self._left} frames faces still fold, stretch or cross others")

    def _clamp(self, objects: Sequence[bpy.types.Object], label: str) -> list[bpy.types.ShapeKey]:
        with gathered() as left:
            clamping = Clamping.read(objects, GuardSettings(), every=False)
            with progress(f"{label}, clamping") as show:
                result = clamping.start().result(show)
            keys, done = clamping.write(objects, result)
        for obj, key in zip(objects, keys, strict=True):
            set_values(obj, [0.0] * len(bands_of(obj)))
            key.value = 1.0
        if self._is_moving:
            self._left += bool(left)
            return keys
        for text in left:
            note(text)
        note(f"{done}; the bands are at gain 1, and {listed(key.name for key in keys)} is shown")
        return keys
