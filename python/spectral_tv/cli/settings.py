"""The settings of a decomposition of files: Blender's, without what only Blender has."""

from dataclasses import dataclass

from spectral_tv.bands.settings import BASES, Settings
from spectral_tv.options.declaring import redeclared


@dataclass(frozen=True)
class FileSettings(Settings):
    """Arguments of a decomposition; see `Settings`."""

    base: str = redeclared(
        Settings, "base", items=tuple(each for each in BASES if each[0] != "KEY"), other=("", "")
    )
    vertex_group: str = redeclared(
        Settings,
        "vertex_group",
        text="Limits where the bands have an effect: numbers from 0 to 1 at the vertices of the "
        "file, by their name",
    )
    shape: str = redeclared(Settings, "shape", argument="")
