"""What limits hold back on the command line; over frames it is told all at once in the end."""

import argparse
from collections.abc import Sequence

from spectral_tv.bands.limits import Limited
from spectral_tv.notes import note

from ..scene import lengths


class Held:
    """What is to be said of limits."""

    def __init__(self, choices: argparse.Namespace) -> None:
        """Take what was chosen."""
        self._is_moving = choices.frames is not None
        # Over frames there would be figures of each.
        self.is_measured = choices.report is not None and not self._is_moving
        self._found: list[Limited] = []

    def add(self, found: Sequence[Limited]) -> None:
        """Note what was held back, or keep it for the end."""
        self._found += found
        if not self._is_moving:
            for each in found:
                note(each.told(lengths.told))

    def note_frames(self) -> None:
        """Note what was held back in frames."""
        held = [each for each in self._found if each.held]
        if self._is_moving and held:
            most = max(each.held for each in held)
            limit = lengths.told(held[0].limit)
            note(
                f"held back at {limit}: {most} vertices at most in a frame, and some in "
                f"{len(held)} of {len(self._found)}"
            )
