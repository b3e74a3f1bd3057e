"""Declaring options, as fields of dataclasses.

All else is made from such a field: the property of an operator and of the sidebar, its row in a
panel, the argument of the command line, what a report says, and a keyword of the package.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import field, fields, replace
from typing import Any

from spectral_tv.dataclass import dataclass

OPTION = "option"
# What stands for the number that suits the other options.
OWN = -1.0
# What the texts of sizes end with.
RELATIVE = ". Relative to the object's size"


class Only:
    """A condition: another option has one of these values."""

    def __init__(self, option: str, values: Iterable[Any], *, otherwise: str = "") -> None:
        """``otherwise`` says of another value why the option is of no use there."""
        self.option, self.otherwise = option, otherwise
        self.values: tuple[Any, ...] = tuple(values)

    def holds(self, settings: Any) -> bool:
        """Whether it is so."""
        return getattr(settings, self.option) in self.values


@dataclass(frozen=True)
class Option:
    """What is known of an option beside its name.

    ``kind`` is the name of the function below that declares it. The option ``applies`` if all
    conditions hold; if not, it is ignored, or ``refused``. ``place`` is the part of a panel with
    it; there an option that does not apply is hidden, or greyed if it ``dims``. ``keyword`` is its
    name in the package. ``argument`` is its name on the command line, if that differs; empty if it
    is no argument.
    """

    kind: str
    label: str
    text: str
    default: Any
    # Those of integers are whole.
    least: Any = None
    most: Any = None
    soft_least: float | None = None
    soft_most: float | None = None
    digits: int | None = None
    unit: str | None = None
    # A part of the object's size: the sidebar has it as a length, all else in percent.
    is_size: bool = False
    items: tuple[tuple[Any, ...], ...] = ()
    # Of a choice that takes any name too: the value that stands for it, and what has the name.
    other: tuple[str, str] = ("", "")
    # Of names: the collection that has them, or what lists them.
    search: str | Callable[..., list[str]] | None = None
    # Of shares: the switch that has them count, with its label and text; what settings show while
    # it is off; and the option that is of no account while it is on. Of numbers that are negative:
    # what they stand for.
    switch: tuple[str, str, str] = ("", "", "")
    own: Callable[[Any], float] | None = None
    instead_of: str = ""
    applies: tuple[Only, ...] = ()
    place: str = ""
    dims: bool = False
    keyword: str = ""
    argument: str | None = None
    metavar: str = ""
    refused: bool = False

    def is_in_force(self, settings: Any) -> bool:
        """Whether it applies."""
        return all(condition.holds(settings) for condition in self.applies)

    def is_own(self, value: Any) -> bool:
        """Whether a value stands for the number that suits the other options."""
        return self.kind == "number" and self.own is not None and value < 0

    @property
    def told(self) -> str:
        """What it is, where it is a number."""
        return self.text + (RELATIVE if self.is_size else "")

    @property
    def range(self) -> tuple[Any, Any]:
        """The least and the most that it can be; None is no end."""
        return self.least, self.most

    @property
    def names(self) -> list[str]:
        """The values of a choice."""
        return [item[0] for item in self.items if item[0]]


def _option(kind: str, label: str, text: str, default: Any, **more: Any) -> Any:
    applies = more.pop("applies", ())
    conditions = (applies,) if isinstance(applies, Only) else applies
    declared = Option(kind, label, text, default, applies=conditions, **more)
    return field(default=default, metadata={OPTION: declared})


def integer(label: str, text: str, default: int, least: int, most: int | None, **more: Any) -> Any:
    """A whole number."""
    return _option("integer", label, text, default, least=least, most=most, **more)


def number(
    label: str,
    text: str,
    default: float | None,
    least: float | None,
    most: float | None,
    **more: Any,
) -> Any:
    """A number, in a ``unit`` of Blender's if one is given.

    Without a default it is OWN, which stands for what ``own`` says.
    """
    default = OWN if default is None else default
    return _option("number", label, text, default, least=least, most=most, **more)


def share(label: str, text: str, usual: float, least: float, most: float, **more: Any) -> Any:
    """A fraction, in percent in the sidebar.

    It is 0 unless its switch is on; then it is ``usual`` at first.
    """
    declared = _option("share", label, text, usual, least=least, most=most, **more)
    declared.default = 0.0
    return declared


def switch(label: str, text: str, default: bool = False, **more: Any) -> Any:
    """Yes or no."""
    return _option("switch", label, text, default, **more)


def choice(
    label: str, text: str, items: Iterable[tuple[Any, ...]], default: str | None = None, **more: Any
) -> Any:
    """One of several: items are those of Blender's EnumProperty; the first if none is named."""
    items = tuple(items)
    first = next(item[0] for item in items if item[0])
    return _option("choice", label, text, default or first, items=items, **more)


def several(
    label: str, text: str, items: Iterable[tuple[Any, ...]], default: Iterable[str], **more: Any
) -> Any:
    """Some of several; the command line has none such."""
    return _option(
        "several", label, text, frozenset(default), items=tuple(items), argument="", **more
    )


def name_of(label: str, text: str, default: str = "", **more: Any) -> Any:
    """A name, or another text."""
    return _option("name", label, text, default, **more)


def redeclared(kind: type, name: str, **changes: Any) -> Any:
    """The option of a dataclass for one that derives from it, with other facts."""
    before = {each.name: each for each in fields(kind)}[name]
    declared = replace(before.metadata[OPTION], **changes)
    return field(default=before.default, metadata={OPTION: declared})


def options_of(kind: type) -> Mapping[str, Option]:
    """The options that a dataclass declares, by their names."""
    return {each.name: each.metadata[OPTION] for each in fields(kind)}


def is_replaced(settings: Any, name: str) -> bool:
    """Whether another option that is on takes the place of this one."""
    return any(
        each.instead_of == name and each.is_in_force(settings) and getattr(settings, other)
        for other, each in options_of(type(settings)).items()
    )


def in_force(settings: Any) -> dict[str, Any]:
    """The options that count, with their values; sizes of 0 and empty names are not among them."""
    found: dict[str, Any] = {}
    for name, option in options_of(type(settings)).items():
        value = getattr(settings, name)
        is_none = option.kind in ("share", "name") and not value
        if option.is_in_force(settings) and not is_none and not is_replaced(settings, name):
            suiting = option.own if option.is_own(value) else None
            found[name] = value if suiting is None else suiting(settings)
    return found


def keywords(settings: Any) -> dict[str, Any]:
    """The arguments of the package that are options that count."""
    options = options_of(type(settings))
    return {
        options[name].keyword: value.lower() if options[name].kind == "choice" else value
        for name, value in in_force(settings).items()
        if options[name].keyword
    }
