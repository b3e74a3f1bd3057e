"""Exaggerating all selected meshes alike: options, operator and panel."""

from functools import partial
from typing import Any

import bpy
import spectral_tv
from spectral_tv.bands.gains import caricature_values
from spectral_tv.bands.methods import METHODS, OF_THE_PAPER
from spectral_tv.bands.settings import INTO, INTO_TEXT, STEPS, Settings
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.steps import Steps, in_turn
from spectral_tv.notes import about, note
from spectral_tv.options.declaring import choice, in_force, integer, number, options_of
from spectral_tv.refusal import Refusal

from ..drawing.work import MeshPanel, draw_button, draw_selection
from ..job.jobs import Seen, read_each, unchanged
from ..job.operator import JobOperator
from ..options.properties import choices_of
from ..scene.surface import Surface
from . import adding, replacing
from .bands import prepare, recall, set_values, start_split
from .properties import sidebar_kind

LIMBS = options_of(Settings)["keep_limbs"]
# How much of limbs is kept, relative to what the method does: limbs are part of a caricature.
PART = 0.5


@dataclass(frozen=True)
class CaricatureSettings:
    """Which bands of all meshes are exaggerated, and which are smoothed away."""

    method: str = choice(
        "Method", "What the bands split off", [each.item for each in OF_THE_PAPER], "M1",
        place="method"
    )  # fmt: skip
    bands: int = integer("Bands", "Number of bands", 5, 2, 32, place="method")
    steps: int = integer("Steps", STEPS, 32, 3, 1000, soft_most=128, place="method")
    keep_limbs: float = number(
        LIMBS.label, LIMBS.text, None, LIMBS.least, LIMBS.most, soft_most=LIMBS.soft_most,
        digits=LIMBS.digits, own=lambda asked: PART * METHODS[asked.method].keep_limbs
    )  # fmt: skip
    first: int = integer(
        "From", "First exaggerated band; 1 is the finest", 3, 1, None, place="range"
    )
    last: int = integer("To", "Last exaggerated band; 1 is the finest", 5, 1, None, place="range")
    amount: float = number(
        "Exaggerate by",
        "How much is added to these bands: 1 doubles them", 1.5, None, None, soft_least=-1,
        soft_most=4, place="amount"
    )  # fmt: skip
    smooth: int = integer(
        "Smooth",
        "So many of the finest bands are removed; 0 keeps the skin", 1, 0, None, place="amount"
    )  # fmt: skip
    into: str = choice("Former Bands", INTO_TEXT, INTO, argument="")

    def of_bands(self) -> Settings:
        """What the bands are made by."""
        keep_limbs = in_force(self)["keep_limbs"]
        more = {"keep_limbs": keep_limbs, "into": self.into, "bands_as": sidebar_kind()}
        return Settings(self.method, self.bands, self.steps, **more)


CaricatureChoices = choices_of(CaricatureSettings, "method", "range", "amount")


class SpectralTVCaricature(CaricatureChoices, bpy.types.PropertyGroup):
    """The choices in the sidebar, kept with the scene."""

    owner = bpy.types.Scene, "spectral_tv_caricature"


@dataclass(frozen=True)
class Pose:
    """What is to be decomposed of an object, and by what."""

    seen: Seen
    surface: Surface
    arguments: dict[str, Any]
    # Of the decomposition whose place the new one will take.
    former: str


class SPECTRAL_TV_OT_caricature(JobOperator, CaricatureChoices, bpy.types.Operator):
    """Split all selected meshes into bands alike, and exaggerate the same bands of each; the
    finest ones can be smoothed away. Different poses then keep one character"""

    bl_idname = "spectral_tv.caricature"
    bl_label = "Exaggerate Selected"
    working = "Exaggerating"

    def prepare(self, _obj: bpy.types.Object) -> list[Pose]:
        if self.smooth >= self.bands:
            raise Refusal(f"smoothing {self.smooth} of {self.bands} bands leaves none")
        settings = self.settings().of_bands()

        def read(obj: bpy.types.Object) -> Pose:
            (former,) = replacing.replaced_identifiers([obj], settings)
            return Pose(Seen.of(obj), *prepare(obj, settings), former)

        return read_each(bpy.context, read)

    def recall(self, prepared: list[Pose]) -> list[spectral_tv.Decomposition] | None:
        splits = [recall(pose.surface, pose.arguments) for pose in prepared]
        return None if None in splits else splits

    def start(self, prepared: list[Pose]) -> Steps[list[spectral_tv.Decomposition]]:
        return Steps(
            in_turn(
                [
                    partial(
                        start_split, pose.surface.mesh, self.settings().of_bands(), pose.arguments
                    )
                    for pose in prepared
                ]
            )
        )

    def write(
        self, _obj: bpy.types.Object, prepared: list[Pose], result: list[spectral_tv.Decomposition]
    ) -> str:
        settings = self.settings().of_bands()
        values = caricature_values(self.bands, self.first, self.last, self.amount, self.smooth)
        if not any(values):
            note("the filter changes nothing: the amount is 0, and no band is smoothed")
        objects, skipped = unchanged([pose.seen for pose in prepared])
        there = [obj for obj in objects if obj is not None]
        rows = [*zip(objects, prepared, result, strict=True)]
        parts = [
            adding.Part(obj, pose.surface, pose.arguments, split)
            for obj, pose, split in rows
            if obj is not None
        ]
        former = [pose.former for obj, pose, _ in rows if obj is not None]
        replacing.check_replaced(there, settings, former)
        if parts:
            adding.add_bands(parts, settings)
        for obj in there:
            with about(obj.name):
                set_values(obj, values)
        label = METHODS[self.method].label
        done = f"{self.bands} bands of {label} exaggerated alike in {len(there)} meshes"
        if any(former):
            done += ", in the place of their former bands"
        return done + skipped


class SPECTRAL_TV_PT_caricature(MeshPanel, bpy.types.Panel):
    """One exaggeration for many poses"""

    bl_label = "Caricature"
    bl_order = 2
    kept = "spectral_tv_caricature"

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        choices = context.scene.spectral_tv_caricature
        draw_selection(layout, context, "filter", choices.settings().of_bands().needs)
        draw_button(layout, SPECTRAL_TV_OT_caricature, "OUTLINER_OB_ARMATURE", choices)
