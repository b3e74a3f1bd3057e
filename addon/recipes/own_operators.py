"""Operators of one's own recipes: kept, removed, exported and imported."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, StringProperty
from spectral_tv.notes import gathered, note
from spectral_tv.refusal import Refusal

from ..bands.bands import settings_of
from ..bands.set_bands import bands_refusal
from ..job.operator import REFUSALS, Refusing
from ..scene.records import bands_of, record_of
from . import own, recipes
from .recipe import Recipe


class SPECTRAL_TV_OT_recipe_preset(Refusing, bpy.types.Operator):
    """Keep the active decomposition as a recipe of yours: its settings, and the values of its bands
    at strength 1"""

    bl_idname = "spectral_tv.recipe_preset"
    bl_label = "Keep as Recipe"
    bl_options = {"REGISTER", "INTERNAL"}

    # Blender's menu of presets sets these.
    name: StringProperty(name="Name", description="Of the recipe", options={"SKIP_SAVE"})
    remove_name: BoolProperty(
        name="Remove", description="Remove the recipe of this name", options={"SKIP_SAVE"}
    )

    @classmethod
    def refusal(cls, _context: bpy.types.Context) -> str | None:
        return None

    @classmethod
    def description(cls, _context, properties) -> str:
        return f"Remove the recipe {properties.name}" if properties.remove_name else cls.__doc__

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            with gathered() as notes:
                if self.remove_name:
                    own.remove(self.name)
                    done = f"removed the recipe {self.name!r}"
                else:
                    path = own.keep(present(context.active_object, self.name))
                    done = f"kept the recipe {self.name!r} in {path}"
        except (*REFUSALS, OSError) as error:
            return self.refuse(error, None)
        return _report(self, done, notes)


class FileOperator(Refusing):
    """One that asks for a file."""

    bl_options = {"REGISTER"}

    filepath: StringProperty(
        name="File", description="Of the recipe", subtype="FILE_PATH", options={"SKIP_SAVE"}
    )
    filter_glob: StringProperty(
        name="Shown Files",
        description="Which files are shown",
        default=f"*{own.EXTENSION}",
        options={"HIDDEN", "SKIP_SAVE"},
    )

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def change(self, context: bpy.types.Context, path: Path) -> str:
        """Do it, and say what was done."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Do it, and tell."""
        try:
            with gathered() as notes:
                done = self.change(context, Path(bpy.path.abspath(self.filepath)))
        except (*REFUSALS, OSError) as error:
            return self.refuse(error, None)
        return _report(self, done, notes)


class SPECTRAL_TV_OT_recipe_export(FileOperator, bpy.types.Operator):
    """Write the active decomposition as a recipe into a file, for others"""

    bl_idname = "spectral_tv.recipe_export"
    bl_label = "Export Recipe"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return bands_refusal(context.active_object)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        name = record_of(context.active_object).name
        self.filepath = bpy.path.clean_name(name) + own.EXTENSION
        return super().invoke(context, event)

    def change(self, context: bpy.types.Context, path: Path) -> str:
        if path.suffix.lower() != own.EXTENSION:
            path = path.with_name(path.name + own.EXTENSION)
        name = bpy.path.display_name(path.name, title_case=False)
        own.save(present(context.active_object, name), path)
        return f"wrote the recipe {name!r} to {path}"


class SPECTRAL_TV_OT_recipe_import(FileOperator, bpy.types.Operator):
    """Add the recipe of a file to yours. It is read as data, and nothing in it is run"""

    bl_idname = "spectral_tv.recipe_import"
    bl_label = "Import Recipe"

    @classmethod
    def refusal(cls, _context: bpy.types.Context) -> str | None:
        return None

    def change(self, _context: bpy.types.Context, path: Path) -> str:
        recipe = own.read(path)
        own.keep(recipe)
        return f"added the recipe {recipe.name!r}"


def present(obj: bpy.types.Object | None, name: str) -> Recipe:
    """The active decomposition of an object as a recipe; raises Refusal if it has none."""
    reason = bands_refusal(obj)
    if reason is not None:
        raise Refusal(reason)
    record = record_of(obj)
    if any(each.cleans and each.name == record.recipe for each in recipes.RECIPES):
        note("the recipe does not look for noise: sizes and values are those of this object")
    bands = bands_of(obj)
    values = tuple(0.0 if band is None else round(band.value, 4) for band in bands)
    if not any(values):
        note("all of its bands are at 0, so the recipe changes nothing")
    masks = {band.vertex_group for band in bands if band is not None and band.vertex_group}
    if masks:
        names = ", ".join(map(repr, sorted(masks)))
        note(f"of masks nothing goes into a recipe: this one is without {names}")
    settings = own.shareable(settings_of(record), len(bands))
    return Recipe(name.strip(), f"{settings.by.label} with a filter of yours", settings, values)


def _report(operator: bpy.types.Operator, done: str, notes: list[str]) -> set[str]:
    operator.report({"INFO"}, done[0].upper() + done[1:])
    for text in notes:
        operator.report({"WARNING"}, text)
    return {"FINISHED"}
