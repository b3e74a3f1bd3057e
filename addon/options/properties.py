"""Options as properties of operators and of the sidebar."""

import inspect
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any, ClassVar

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from spectral_tv.later import np
from spectral_tv.options.declaring import OWN, Option, options_of

from . import rows

KINDS = {
    "integer": IntProperty,
    "number": FloatProperty,
    "share": FloatProperty,
    "switch": BoolProperty,
    "choice": EnumProperty,
    "several": EnumProperty,
    "name": StringProperty,
}
PERCENT = 100
# What Blender has to be told of a path since 4.5: that it may begin with "//".
RELATIVE = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5) else set()
# What the texts of lengths end with.
KEPT = "It is kept relative to the size of the active object"
# Which value stands for what suits the method.
OWN_TEXT = {"share": ". 0 is what suits the method", "number": ". −1 is what suits the method"}


class Choices:
    """What a user chooses, as properties; a class of :func:`choices_of`."""

    declared_by: ClassVar[type]
    # The places of the options that are laid out, a column for each text.
    columns: ClassVar[tuple[str, ...]]

    # The operator that picks a size by pointing at something, if there is one.
    picker: ClassVar[str] = ""

    def object_size(self) -> float | None:
        """The length that sizes are relative to, where they are chosen as lengths."""
        return None

    def draw(self, _context: bpy.types.Context) -> None:
        """Lay out Adjust Last Operation."""
        self.layout.use_property_split = True
        rows.draw(self.layout, self, *self.columns)

    def settings(self) -> Any:
        """The properties as they are, in the dataclass that declares them."""
        kind = self.declared_by
        return kind(**{name: _value(self, name, each) for name, each in options_of(kind).items()})

    def fill(self, settings: Any) -> None:
        """Take what ``settings`` say."""
        options = options_of(self.declared_by)
        for name, option in options.items():
            value = getattr(settings, name)
            if option.kind != "share":
                setattr(self, name, value)
            elif value or option.default == 0:
                setattr(self, name, PERCENT * value)
        for switch in {each.switch[0] for each in options.values()} - {""}:
            sharing = [n for n, each in options.items() if each.switch[0] == switch]
            setattr(self, switch, any(getattr(settings, name) for name in sharing))


def choices_of(kind: type, *columns: str, **more: Any) -> type[Choices]:
    """A base of operators and property groups, with a property for each option of ``kind``."""
    annotations = {**dict(_declared(kind)), **more}
    members = {"__annotations__": annotations, "declared_by": kind, "columns": columns}
    return type("Choices", (Choices,), members)


def sidebar_of(
    kind: type,
    changed: Callable[..., None],
    size: Callable[[Any], float | None],
    picker: str = "",
) -> type[Choices]:
    """The same for the sidebar: with ``shown_…``, what a share that is 0 stands for.

    ``changed`` is called with what is chosen, and the names of the options that were just changed.
    ``size`` is given what is chosen, and gives the length that sizes are relative to, None if there
    is none; ``length_…`` are sizes as lengths. ``picker`` is the operator that picks the size of an
    ``option``.
    """
    options = options_of(kind).items()
    shared = [(name, each) for name, each in options if each.own and each.kind == "share"]
    shown = {f"shown_{name}": _shown(name, option) for name, option in shared}
    sizes = [(name, each) for name, each in options if each.is_size]
    lengths = {f"length_{name}": _length(name, option, size) for name, option in sizes}
    watched = dict(_declared(kind, changed))
    made = choices_of(kind, **watched, **shown, **lengths)
    made.object_size, made.picker = size, picker
    return made


def property_of(kind: type, name: str) -> Any:
    """The property of one option."""
    return _property(options_of(kind)[name])


def properties_of(settings: Any) -> dict[str, Any]:
    """The properties by which an operator does what ``settings`` say."""
    found = SimpleNamespace(declared_by=type(settings))
    Choices.fill(found, settings)
    del found.declared_by
    return vars(found)


def give(choices: bpy.types.PropertyGroup, target: bpy.types.OperatorProperties, to: type) -> None:
    """Give the properties ``target`` of an operator of the class ``to`` what was chosen."""
    for cls in to.__mro__:
        if "declared_by" in vars(cls):
            for name in inspect.get_annotations(cls):
                setattr(target, name, getattr(choices, name))


def _declared(kind: type, changed: Callable[..., None] | None = None) -> Iterator[tuple[str, Any]]:
    options = options_of(kind)
    for name, option in options.items():
        if option.switch[0]:
            switch, label, text = option.switch
            names = [other for other, each in options.items() if each.switch[0] == switch]
            told = _telling(changed, *names)
            yield switch, BoolProperty(name=label, description=text, **told)
        yield name, _property(option, **_telling(changed, name))


def _telling(changed: Callable[..., None] | None, *names: str) -> dict[str, Any]:
    """What Blender calls when these options were changed."""
    if changed is None:
        return {}
    return {"update": lambda choices, _context: changed(choices, *names)}


def _property(option: Option, **more: Any) -> Any:
    given = {
        "name": option.label,
        "description": option.told + (OWN_TEXT[option.kind] if option.own else ""),
        "default": set(option.default) if option.kind == "several" else option.default,
        "min": OWN if option.is_own(option.default) else option.least,
        "max": option.most,
        "soft_min": option.soft_least,
        "soft_max": option.soft_most,
        "precision": option.digits,
        "subtype": "PERCENTAGE" if option.kind == "share" else option.unit,
        "items": option.items or None,
        "search": option.search if callable(option.search) else None,
        "options": {"ENUM_FLAG"} if option.kind == "several" else None,
        **more,
    }
    return KINDS[option.kind](**{name: each for name, each in given.items() if each is not None})


def _shown(name: str, option: Option) -> Any:
    """A property that shows a share as it is in force: its own, until another is chosen."""
    least = option.soft_least  # 0 stands for its own

    def get(choices: Any) -> float:
        chosen = getattr(choices, name) if getattr(choices, option.switch[0]) else 0.0
        return chosen or PERCENT * option.own(choices.settings())

    def choose(choices: Any, value: float) -> None:
        setattr(choices, name, max(value, least))

    return FloatProperty(
        name=option.label,
        description=option.told,
        subtype="PERCENTAGE",
        min=least,
        max=option.most,
        precision=option.digits,
        get=get,
        set=choose,
    )


def _length(name: str, option: Option, size: Callable[[Any], float | None]) -> Any:
    """A property that shows a size as a length, and keeps it relative."""
    kept = f"shown_{name}" if option.own else name

    def get(choices: Any) -> float:
        return getattr(choices, kept) * (size(choices) or 0.0) / PERCENT

    def choose(choices: Any, value: float) -> None:
        whole = size(choices)
        if whole:
            setattr(choices, kept, PERCENT * value / whole)

    return FloatProperty(
        name=option.label,
        description=f"{option.text}. {KEPT}",
        subtype="DISTANCE",
        min=0,
        step=1,
        precision=4,
        get=get,
        set=choose,
    )


def _value(choices: Any, name: str, option: Option) -> Any:
    value = getattr(choices, name)
    if option.kind == "several":
        return frozenset(value)
    if option.kind == "number":  # of single precision: 0.3, and not 0.30000001
        return float(str(np.float32(value)))
    if option.kind != "share":
        return value
    is_on = not option.switch[0] or getattr(choices, option.switch[0])
    return value / PERCENT if is_on else 0.0
