"""The choices in the sidebar that are about bands, kept with the scene."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bpy
from bpy.props import BoolProperty, StringProperty
from spectral_tv.bands.filtering import FilterSettings
from spectral_tv.bands.gains import usual_band
from spectral_tv.bands.settings import ON_NEW_OBJECT, Settings

from ..drawing.sizes import size_of_active
from ..options.properties import choices_of, property_of, sidebar_of
from ..scene.records import record_of
from .filtering import SidebarFilter

DecompositionChoices = choices_of(Settings, "method shape")


# What picks a size in the view.
PICKER = "spectral_tv.pick_size"
# What follows when the user has changed options in the sidebar: it is called with their names.
CHANGED: list[Callable[..., None]] = []


def sidebar_kind() -> str:
    """What bands are kept as, by the choice in the sidebar."""
    return bpy.context.scene.spectral_tv.bands_as


_quiet: list[None] = []


@contextmanager
def quietly() -> Iterator[None]:
    """Change options, and nothing follows."""
    _quiet.append(None)
    try:
        yield
    finally:
        _quiet.pop()


def _changed(choices: "SpectralTVScene", *names: str) -> None:
    for follow in CHANGED if not _quiet else ():
        follow(choices.id_data, *names)


def _size(choices: "SpectralTVScene") -> float | None:
    """That of the active object, unless another one will be made of it."""
    return None if choices.shape in ON_NEW_OBJECT else size_of_active()


class SpectralTVScene(
    sidebar_of(Settings, _changed, _size, PICKER), bpy.types.PropertyGroup
):  # fmt: skip
    """How the active object is decomposed."""

    owner = bpy.types.Scene, "spectral_tv"

    at_once: BoolProperty(
        name="At Once",
        description="Decompose the active object anew whenever one of these settings is changed, "
        "and have the new bands take the place of the active ones",
        update=lambda choices, _context: _changed(choices, "at_once"),
    )
    # Of a change that is not done with, and how far that is; kept so that undo knows.
    change: StringProperty(options={"HIDDEN"})


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
