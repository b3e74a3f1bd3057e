"""A verb that treats what is seen, or what is seen in each of some frames."""

import argparse

import bpy

from .frames import all_or_frames, frames_of, treat_frames
from .load import freeze
from .verb import Verb


class FramesVerb(Verb):
    """One with the argument --frames."""

    @staticmethod
    def add_frames(parser: argparse.ArgumentParser, deed: str) -> None:
        """Declare --frames; ``deed`` says what is done to what is seen in them."""
        parser.add_argument(
            "--frames",
            metavar="START-END[:STEP]",
            type=all_or_frames,
            help=f"{deed} in each of these frames, or in all. The file plays them; of a format "
            "that cannot, there is a file for each",
        )

    def treat_all(self, objects: list[bpy.types.Object]) -> None:
        """Treat objects; over frames, have them play what came of it."""
        if self.choices.frames is None:
            freeze(self.read, "; --frames all takes each as it is seen")
            self.treat_groups(objects)
            return

        def treat(copies: list[bpy.types.Object], frame: int) -> None:
            self.treat_groups(copies, f", frame {frame}")

        treat_frames(objects, frames_of(self.choices.frames, self.read), treat)
