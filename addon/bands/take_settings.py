"""The operator that gives the sidebar the settings that the active bands were made by."""

from dataclasses import replace

import bpy
from spectral_tv.bands.settings import Settings

from ..job.operator import ChangeOperator
from ..scene.objects import is_mesh
from ..scene.records import record_of
from .bands import settings_of
from .properties import quietly


class SPECTRAL_TV_OT_take_settings(ChangeOperator, bpy.types.Operator):
    """Set the sidebar to what the active decomposition was made by"""

    bl_idname = "spectral_tv.take_settings"
    bl_label = "Use Its Settings"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.active_object
        if not is_mesh(obj) or record_of(obj) is None:
            return "The active object has no bands; decompose it first"
        return None

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> None:
        choices, record = context.scene.spectral_tv, record_of(obj)
        settings = replace(settings_of(record), keep_limbs=Settings.keep_limbs, into=choices.into)
        if settings.by.has_bands:
            settings = replace(settings, bands=len(record.bands))
        with quietly():
            choices.fill(settings)
