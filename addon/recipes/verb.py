"""``recipe``: files in, a look in one step out."""

import argparse
from collections.abc import Sequence
from dataclasses import replace

import bpy
from spectral_tv.command_line.progress import progress
from spectral_tv.notes import note
from spectral_tv.options.arguments import add_arguments as add_options
from spectral_tv.refusal import Refusal

from ..bands import figures
from ..bands.apply_argument import add_apply, apply_each, complaint_of_apply
from ..bands.held import Held
from ..bands.shapes import told_groups
from ..bands.split_frames import SplitFrames
from ..command_line.frames_verb import FramesVerb
from ..scene.records import all_bands_of, bands_of
from . import own
from .making import Making
from .recipes import RECIPES
from .settings import RecipeSettings


class Recipe(FramesVerb):
    """Makes a recipe of objects."""

    name = "recipe"
    summary = "give meshes a look in one step"
    does, result = "change", "changed"
    description = f"""\
Decompose the meshes of files and set their bands in one step, by a strength, and write them.

Recipes: {", ".join(each.name for each in RECIPES)}, those that you kept in Blender, and files
of recipes. A .blend keeps the bands as shape keys; .glb, .gltf and .fbx carry them too. All other
formats hold the shape that is seen."""
    examples = """\
  {program} recipe scan.ply -o clean.ply --recipe "Clean Scan"
  {program} recipe *.obj -o results --recipe Caricature --strength 0.7
  {program} recipe head.blend -o head.glb --recipe mine.json --render results"""

    options = RecipeSettings

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare which recipe, and how strong."""
        super().add_arguments(parser)
        add_options(parser, RecipeSettings)
        FramesVerb.add_frames(parser, "do so to what is seen")
        add_apply(parser)

    def complaint(self) -> str | None:
        """What is wrong with them together."""
        reason = super().complaint()
        if reason is None:
            try:
                own.find(self.asked.recipe)
            except Refusal as error:
                return f"--recipe: {error}"
        return reason or complaint_of_apply(self.choices)

    def groups(self, objects: list[bpy.types.Object]) -> list[list[bpy.types.Object]]:
        """The objects, those together whose open edges meet."""
        return told_groups(objects, own.find(self.asked.recipe).settings)

    def treat_all(self, objects: list[bpy.types.Object]) -> None:
        """Give objects the look, as they are or in frames."""
        self._held = Held(self.choices)
        self._frames = SplitFrames(own.find(self.asked.recipe).settings)
        super().treat_all(objects)
        self._held.note_frames()

    def treat(self, objects: Sequence[bpy.types.Object], label: str) -> None:
        """Give objects the look."""
        asked = self.asked
        making = Making.prepare(objects, own.find(asked.recipe), asked.strength, asked.limit)
        if self.choices.frames is not None:
            with progress(label) as show:
                found = self._frames.split(objects, making.surfaces, making.arguments, show)
            making = replace(making, surfaces=found[0], split=found[1])
        made = making.recall()
        if made is None:
            with progress(label) as show:
                made = making.start().result(show)
        making.write(objects, made)
        if made.told and self.choices.frames is None:
            note(made.told)
        self._held.add(making.hold(objects))
        bands = [[band for band in bands_of(obj) if band is not None] for obj in objects]
        if self._held.is_measured:
            for obj, mine in zip(objects, bands, strict=True):
                self.measured[obj.name] = figures.figures(obj, mine)
        if self.choices.apply:
            every = [all_bands_of(obj) for obj in objects]  # those that were in the file too
            apply_each(objects, every)
