"""The choices in the sidebar that are about bands, kept with the scene."""

import bpy
from spectral_tv.bands.gains import usual_band
from spectral_tv.bands.settings import Settings

from ..options.properties import choices_of, property_of, sidebar_of
from ..scene.records import record_of
from .filtering import FilterSettings, SidebarFilter

DecompositionChoices = choices_of(Settings, "method shape")


class SpectralTVScene(sidebar_of(Settings), bpy.types.PropertyGroup):
    """How the active object is decomposed."""

    owner = bpy.types.Scene, "spectral_tv"


class SpectralTVFilter(SidebarFilter, bpy.types.PropertyGroup):
    """Which bands the common filters are about."""

    owner = bpy.types.Scene, "spectral_tv_filter"

    # That of any of them.
    preset = "BAND_PASS"
    amount: property_of(FilterSettings, "amount")

    def chosen(self, preset: str) -> tuple[int, int]:
        """The first and the last band that a preset is about; the usual one if none is chosen."""
        if self.own_first or self.own_last:
            return self.first, self.last
        return (usual_band(preset, self.band_count()),) * 2

    def band_count(self) -> int:
        """That of the active object."""
        record = record_of(bpy.context.active_object)
        return Settings.bands if record is None else len(record.bands)
