"""``decompose``: files in, bands or filtered shapes out."""

import argparse
from collections.abc import Sequence
from dataclasses import replace

import bpy
from spectral_tv.bands.filtering import KEEPS_ALL
from spectral_tv.bands.gain_arguments import add_gains, band_values, complaint_of_gains
from spectral_tv.bands.guard import add_safe
from spectral_tv.bands.limits import LimitSettings
from spectral_tv.bands.settings import Settings
from spectral_tv.command_line.frames import add_scales, complaint_of_scales
from spectral_tv.command_line.progress import progress
from spectral_tv.notes import listed, note
from spectral_tv.options.arguments import add_arguments as add_options
from spectral_tv.options.arguments import complaint, read
from spectral_tv.refusal import Refusal

from ..command_line.formats import BLEND, FORMATS
from ..command_line.frames import look_at_frames
from ..command_line.frames_verb import FramesVerb
from ..scene import applied, multires
from ..scene.records import all_bands_of, record_of
from . import figures, limiting, shown_shape
from .adding import Part, add_bands
from .apply_argument import add_apply, apply_each, complaint_of_apply
from .bands import prepare_together, set_values, start_split
from .folding_gains import FoldingGains
from .held import Held
from .shapes import told_groups
from .split_frames import SplitFrames
from .write_back import write_back


class Decompose(FramesVerb):
    """Splits objects into bands, and filters them."""

    name = "decompose"
    summary = "split meshes into bands of detail"
    result = "filtered"
    description = """\
Split the meshes of files into bands of detail, filter them, and write them.

A .blend keeps the bands as shape keys, set to the gains; .glb, .gltf and .fbx carry them too.
All other formats hold the filtered shape. With --bands-as attributes a .blend has a modifier
that adds the bands; all other files hold the filtered shape, and .glb, .gltf, .usd and .ply
the bands as attributes too."""
    examples = """\
  {program} decompose dragon.ply -o dragon.blend --bands 5
  {program} decompose scan.obj -o smooth.obj --gain 1=0 --gain 2=0.5
  {program} decompose *.ply -o results --curve 0:0,0.5:1,1:2 --render results"""

    options = Settings

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what is split off, and how it is filtered."""
        super().add_arguments(parser)
        add_options(parser, Settings)
        add = parser.add_argument
        add(
            "--apart",
            action="store_true",
            help="split every object by itself, even where the open edges of several meet",
        )
        FramesVerb.add_frames(parser, "split and filter what is seen")
        add_scales(parser)
        add_gains(parser)
        add_safe(parser, "the result is a shape key, and the bands are at gain 1")
        add_options(parser, LimitSettings)
        add_apply(parser)

    def complaint(self) -> str | None:
        """What is wrong with them together."""
        asked, reason = self.asked, super().complaint()
        if reason is None and 0 < asked.largest <= asked.finest:
            return "--largest has to be larger than --finest"
        reason = reason or complaint_of_scales(self.choices)
        if reason is None and asked.shape == "MULTIRES" and self.choices.frames is not None:
            return "--shape multires is at rest, so it is not for --frames"
        if reason is None and asked.shape == "MULTIRES" and self.choices.apply:
            return "--apply is not for --shape multires, whose bands are on an object of their own"
        reason = reason or complaint_of_apply(self.choices)
        reason = reason or complaint(self.choices, Settings, asked) or asked.complaint()
        return reason or complaint_of_gains(self.choices, asked.band_count)

    def treat_all(self, objects: list[bpy.types.Object]) -> None:
        """Give objects their bands; over frames, have them play their filtered shapes."""
        self._folding, self._held = FoldingGains(self.choices), Held(self.choices)
        self._frames = SplitFrames(self.asked)
        super().treat_all(objects)
        self._held.note_frames()
        if self.choices.frames is not None:
            self._folding.note_frames()

    def look_ahead(self, objects: list[bpy.types.Object], frames: Sequence[int]) -> None:
        """Measure all frames, if sizes of bands go by them."""
        if self.choices.scales != "all":
            return

        def look(copies: list[bpy.types.Object], _frame: int) -> None:
            for group in self.groups(copies) if copies else ():
                self._frames.measure(group)

        look_at_frames(objects, frames, look)

    def choose(self) -> list[bpy.types.Object]:
        """The objects to split where none is named: those with levels, if these are asked for."""
        objects = super().choose()
        if self.asked.shape != "MULTIRES":
            return objects
        found = [obj for obj in objects if multires.modifier_of(obj) is not None]
        if not found:
            raise Refusal("there is no Multiresolution sculpt in it")
        if len(found) < len(objects):
            others = [obj.name for obj in objects if obj not in found]
            note(f"left as they are, without Multiresolution: {listed(others)}")
        return found

    def groups(self, objects: list[bpy.types.Object]) -> list[list[bpy.types.Object]]:
        """The objects, those together whose open edges meet."""
        if self.choices.apart:
            return super().groups(objects)
        return told_groups(objects, self.asked, "; --apart splits each")

    def treat(self, objects: Sequence[bpy.types.Object], label: str) -> None:
        """Give objects their bands."""
        # What a file shows is split and filtered, not what it was split of before.
        asked, choices = replace(self.asked, into="ADD"), self.choices
        if asked.shape == "APPLIED":
            for obj in objects:
                applied.apply(obj)
        values = band_values(choices, asked.band_count)
        is_filtered = bool(choices.gains) or choices.curve is not None
        if not any(values) and (is_filtered or not self._holds_bands()):
            note(KEEPS_ALL)
        surfaces, arguments = prepare_together(objects, asked, self._frames.area(objects))
        with progress(label) as show:
            if choices.frames is None:
                split = start_split(surfaces[0].mesh, asked, arguments).result(show)
            else:
                surfaces, split = self._frames.split(objects, surfaces, arguments, show)
        if asked.shape == "MULTIRES":
            objects = [shown_shape.new_object(objects[0], asked.shape, surfaces[0])]
        pairs = zip(objects, surfaces, strict=True)
        add_bands([Part(*pair, arguments, split) for pair in pairs], asked)
        for obj in objects:
            set_values(obj, values)
        shown = self._folding.look(objects, label)
        self._hold(objects, shown)
        if asked.shape == "MULTIRES":
            self._put_back(objects[0])
        if self.choices.apply:
            others = [all_bands_of(obj) for obj in objects]  # those that were in the file too
            every = [list({*keys, *mine}) for keys, mine in zip(shown, others, strict=True)]
            apply_each(objects, every)

    def _hold(
        self, objects: Sequence[bpy.types.Object], shown: Sequence[Sequence[bpy.types.ShapeKey]]
    ) -> None:
        """Hold what the keys that are shown of objects do within the limit, and measure it."""
        limit = read(self.choices, LimitSettings).limit
        found = []
        for obj, keys in zip(objects, shown, strict=True):
            found.append(limiting.limit(obj, keys, limit, [record_of(obj)]))
        self._held.add([each for each in found if each is not None])
        if self._held.is_measured:
            for obj, keys in zip(objects, shown, strict=True):
                self.measured[obj.name] = figures.figures(obj, keys)

    def _put_back(self, work: bpy.types.Object) -> None:
        """Give the levels the shape of a work object; only a .blend keeps that, with its bands."""
        source = work.spectral_tv_work.source
        write_back(work)
        if self.file is not None and self.file.suffix.lower() == BLEND:
            work.hide_set(True)
            note(f"the bands are on {work.name!r}, which is hidden")
            return
        bpy.data.meshes.remove(work.data)  # and the object with it
        modifier = multires.modifier_of(source)
        if modifier.levels < modifier.total_levels:
            note(
                f"{source.name} is written as it is shown, at level {modifier.levels} of "
                f"{modifier.total_levels}"
            )

    def _holds_bands(self) -> bool:
        """Whether bands can still be dialled in what is written."""
        if self.file is None:
            return False
        suffix = self.file.suffix.lower()
        return suffix == BLEND or (FORMATS[suffix].keys and self.asked.bands_as == "KEYS")
