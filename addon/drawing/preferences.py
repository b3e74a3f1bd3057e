"""The preferences of the extension: the tab of its panels, and which of them there are."""

from collections.abc import Callable

import bpy
from bpy.props import BoolProperty, StringProperty

# The extension's own name among Blender's.
EXTENSION = __package__.rpartition(".")[0]
TAB = "Spectral TV"
# Are called when the tab was given another name.
RENAMED: list[Callable[[], None]] = []


def _renamed(_preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    for follow in RENAMED:
        follow()


class SpectralTVPreferences(bpy.types.AddonPreferences):
    """What is the user's rather than a file's."""

    bl_idname = EXTENSION

    tab: StringProperty(
        name="Tab",
        description="The tab of the sidebar that has the panels; one of other extensions will do",
        default=TAB,
        maxlen=40,
        update=_renamed,
    )
    research_tools: BoolProperty(
        name="Research Tools",
        description="Show what measures rather than shapes: the spectrum, Accuracy, Values over "
        "Time, Eigenset Test",
    )

    def draw(self, _context: bpy.types.Context) -> None:
        """Lay them out in Blender's preferences."""
        self.layout.use_property_split = True
        self.layout.prop(self, "tab")
        self.layout.prop(self, "research_tools")


def tab() -> str:
    """The name of the tab."""
    own = _own()
    return (own.tab.strip() if own is not None else "") or TAB


def shows_research() -> bool:
    """Whether panels for research are shown."""
    own = _own()
    return own is not None and own.research_tools


def _own() -> bpy.types.AddonPreferences | None:
    """None where Blender does not know the extension, as in scripts that register it themselves."""
    addon = bpy.context.preferences.addons.get(EXTENSION)
    return None if addon is None else addon.preferences
