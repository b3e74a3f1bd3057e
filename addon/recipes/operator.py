"""The operator that makes a recipe of the active object."""

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.steps import Steps
from spectral_tv.notes import note

from ..job.jobs import Seen, all_unchanged
from ..job.operator import JobOperator
from ..scene import lengths
from ..scene.objects import selected_meshes
from . import making, own, recipes
from .properties import RecipeChoices


@dataclass(frozen=True)
class Prepared:
    """The object, and what is made of it."""

    seen: Seen
    making: "making.Making"


class SPECTRAL_TV_OT_recipe(JobOperator, RecipeChoices, bpy.types.Operator):
    """Decompose the active object and set its bands in one step, by a strength"""

    bl_idname = "spectral_tv.recipe"
    bl_label = "Recipe"
    working = "Working on"

    @classmethod
    def description(cls, _context, properties) -> str:
        texts = {each.name: each.text for each in recipes.RECIPES}
        return texts.get(properties.recipe, cls.__doc__)

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.label(text=bpy.path.display_name(self.recipe, title_case=False))
        super().draw(context)

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        asked = self.settings()
        recipe = own.find(asked.recipe)
        others = len(selected_meshes(bpy.context)) - 1
        if others:
            left = "mesh stays as it is" if others == 1 else "meshes stay as they are"
            note(f"recipes are of the active object alone: the other selected {left}")
        return Prepared(
            Seen.of(obj), making.Making.prepare([obj], recipe, asked.strength, asked.limit)
        )

    def recall(self, prepared: Prepared) -> "making.Made | None":
        return prepared.making.recall()

    def start(self, prepared: Prepared) -> "Steps[making.Made]":
        return prepared.making.start()

    def write(self, _obj: bpy.types.Object, prepared: Prepared, result: "making.Made") -> str:
        objects = all_unchanged([prepared.seen])
        done = prepared.making.write(objects, result)
        return "; ".join(
            [*(each.told(lengths.told) for each in prepared.making.hold(objects)), done]
        )
