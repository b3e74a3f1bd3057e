"""Options as rows of panels; options that have no effect have no row."""

from typing import Any

import bpy
from spectral_tv.options.declaring import Option, options_of


def draw(layout: bpy.types.UILayout, choices: Any, *columns: str, obj: Any = None) -> None:
    """Lay out the options of some places, by the fields' order: a column for each, of one or more.

    ``obj`` is the object that has what names are searched in.
    """
    settings = choices.settings()
    options = options_of(type(settings))
    for places in columns:
        column = layout.column()
        for place in places.split():
            for name, option in options.items():
                if option.place == place:
                    _row(column, choices, settings, name, obj)


def is_shown(choices: Any, place: str) -> bool:
    """Whether one of the options of a place has an effect."""
    settings = choices.settings()
    options = options_of(type(settings)).values()
    return any(each.place == place and each.is_in_force(settings) for each in options)


def _row(column: bpy.types.UILayout, choices: Any, settings: Any, name: str, obj: Any) -> None:
    options = options_of(type(settings))
    option = options[name]
    is_in_force = option.is_in_force(settings)
    if not is_in_force and not option.dims:
        return
    others = [each for each, other in options.items() if other.instead_of == name]
    if others and options[others[0]].is_in_force(settings):
        switch = options[others[0]].switch[0]
        row = column.row(align=True)
        row.prop(choices, others[0] if getattr(choices, switch) else name)
        row.prop(choices, switch, text="", icon="DRIVER_DISTANCE")
    elif option.own:
        _share(column, choices, options, name)
    elif isinstance(option.search, str):
        _search(column, choices, name, option, obj)
    else:
        # The values of several stand below one another.
        row = column.row() if option.dims else column.column(align=option.kind == "several")
        row.active = is_in_force
        row.prop(choices, _shown(choices, name, option, name))


def _shown(choices: Any, name: str, option: Option, otherwise: str) -> str:
    """The property that shows an option: a length, if it is the size of something that is known."""
    is_length = option.is_size and choices.object_size() is not None
    return f"length_{name}" if is_length else otherwise


def _share(column: bpy.types.UILayout, choices: Any, options: dict[str, Option], name: str) -> None:
    """A share, with its switch unless it has that in common with others."""
    switch = options[name].switch[0]
    shown = _shown(choices, name, options[name], f"shown_{name}")
    if sum(each.switch[0] == switch for each in options.values()) > 1:
        row = column.row(align=True)
        row.prop(choices, shown)
        _picker(row, choices, name, options[name])
        return
    row = column.row(heading=options[name].label)
    row.prop(choices, switch, text="")
    field = row.row(align=True)
    field.enabled = getattr(choices, switch)
    field.prop(choices, shown, text="")
    _picker(field, choices, name, options[name])


def _picker(row: bpy.types.UILayout, choices: Any, name: str, option: Option) -> None:
    """The button that picks a size in the view."""
    if option.is_size and choices.picker:
        row.operator(choices.picker, text="", icon="EYEDROPPER").option = name


def _search(column: bpy.types.UILayout, choices: Any, name: str, option: Option, obj: Any) -> None:
    if obj is None or obj.type != "MESH":
        return
    owner = obj.data.shape_keys if option.search == "key_blocks" else obj
    if owner is None:
        column.label(text="The mesh has no shape keys", icon="INFO")
    else:
        column.prop_search(choices, name, owner, option.search)
