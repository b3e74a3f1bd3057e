"""A verb that treats what is seen, or what is seen in each of some frames."""

import argparse
from collections.abc import Sequence
from pathlib import Path

import bpy
from spectral_tv.command_line.frames import ALL, METAVAR, all_or_frames
from spectral_tv.command_line.places import is_folder
from spectral_tv.files.numbered import Numbered

from .arguments import outputs
from .formats import HOLDS, NO, importable
from .frames import frames_of, plays, treat_frames
from .load import Source, freeze
from .load_frames import load_frames
from .verb import Verb


class FramesVerb(Verb):
    """One with the argument --frames."""

    @staticmethod
    def add_frames(parser: argparse.ArgumentParser, deed: str) -> None:
        """Declare --frames; ``deed`` says what is done to what is seen in them."""
        parser.add_argument(
            "--frames",
            metavar=METAVAR,
            type=all_or_frames,
            help=f"{deed} in each of these frames, or in all. The file plays them; of a format "
            "that cannot, there is a file for each",
        )

    def complaint(self) -> str | None:
        """What is wrong with the arguments together; a subclass looks at its own."""
        reason, choices = super().complaint(), self.choices
        if reason is None and choices.skip_existing and choices.frames is not None:
            files = [outputs(choices, source)[0] for source in choices.inputs]
            if any(file is not None and not plays(file) for file in files):
                return "--skip-existing is not for --frames where each frame has a file of its own"
        return reason

    def treat_all(self, objects: list[bpy.types.Object]) -> None:
        """Treat objects; over frames, have them play what came of it."""
        if self.choices.frames is None:
            self.is_remeshed = False
            freeze(self.read, "; --frames all takes each as it is seen")
            self.treat_groups(objects)
            return

        def treat(copies: list[bpy.types.Object], frame: int) -> None:
            self.treat_groups(copies, f", frame {frame}")

        frames = frames_of(self.choices.frames, self.read)
        self.look_ahead(objects, frames)
        self.is_remeshed = treat_frames(objects, frames, treat)

    def look_ahead(self, objects: list[bpy.types.Object], frames: Sequence[int]) -> None:
        """Look at frames before they are treated; a subclass may."""

    def load(self, source: Path) -> Source:
        """Read an input, or the numbered files of a folder as its frames."""
        if not is_folder(source):
            return super().load(source)
        asked = self.choices.frames
        return load_frames(source, None if asked == ALL else asked)

    def is_one(self, folder: Path) -> bool:
        """Whether a folder is one input: over frames, if it has numbered files of still meshes."""
        still = [suffix for suffix in importable() if HOLDS[suffix]["animation"] == NO]
        return self.choices.frames is not None and Numbered.are_in(folder, still)
