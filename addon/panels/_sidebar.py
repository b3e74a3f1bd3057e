"""Where the panels are."""


class Sidebar:
    """The tab in the 3D view's sidebar."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Spectral TV"
