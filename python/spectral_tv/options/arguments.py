"""Options as arguments of the command line."""

import argparse
from collections.abc import Callable
from typing import Any

from spectral_tv.later import np
from spectral_tv.options.declaring import Only, Option, in_force, options_of

# What stands for no end of a range.
FAR, MANY = (-1e9, 1e9), 1 << 30
# Of so many values the help tells with which an option goes.
FEW = 3


def add_arguments(parser: argparse.ArgumentParser, kind: type, *, of_object: bool = False) -> None:
    """Declare the options of a dataclass; if ``of_object``, what is not given is the object's."""
    for name, option in options_of(kind).items():
        if option.argument == "":
            continue
        given: dict[str, Any] = {"dest": _dest(name, option), **_type(option)}
        if option.kind == "switch" and option.default:
            given |= {"action": argparse.BooleanOptionalAction, "default": True}
        elif option.kind == "switch":
            given["action"] = "store_true"
        else:
            has_none = of_object or option.refused or option.is_own(option.default)
            given["default"] = None if has_none else _written(option)
        told = _help(kind, option, "the object's own, at first " if of_object else "")
        parser.add_argument(_flag(name, option), help=told.replace("%", "%%"), **given)


def _help(kind: type, option: Option, whose: str) -> str:
    """What is told of an argument; ``whose`` stands before its default."""
    told = option.told[0].lower() + option.told[1:]
    if option.kind == "choice":
        told += f" ({_labels(option)})"
    if option.kind == "share" and option.metavar:
        told += f"; a fraction, such as {option.default / 100:g}"
    for condition in option.applies:
        other = options_of(kind)[condition.option]
        is_usual = other.kind == "switch" and other.default in condition.values
        if other.argument != "" and len(condition.values) <= FEW and not is_usual:
            told += f"; with {_condition(kind, condition)}"
    if option.kind in ("integer", "number", "choice"):
        usual = "what suits the method" if option.is_own(option.default) else _written(option)
        told += f"; default {whose}{usual}"
    return told


def names_of(kind: type) -> set[str]:
    """What the arguments of a dataclass are kept as."""
    return {
        _dest(name, option) for name, option in options_of(kind).items() if option.argument != ""
    }


def read(choices: argparse.Namespace, kind: type) -> Any:
    """The settings that the arguments ask for."""
    found: dict[str, Any] = {}
    for name, option in options_of(kind).items():
        value = getattr(choices, _dest(name, option), None) if option.argument != "" else None
        if value is None:
            continue
        if option.other[0] and value not in _known(option):
            found[option.other[1]], value = value, option.other[0]
        found[name] = value.upper() if option.kind == "choice" else value
    return kind(**found)


def complaint(choices: argparse.Namespace, kind: type, settings: Any) -> str | None:
    """What is wrong with options beside others; None if nothing is."""
    options = {name: each for name, each in options_of(kind).items() if each.refused}
    values = {name: getattr(choices, _dest(name, each)) for name, each in options.items()}
    given = [name for name, each in values.items() if each not in (None, "") and each is not False]
    for name in given:
        for condition in options[name].applies:
            if condition.holds(settings):
                continue
            alike = [each for each, other in options.items() if condition in other.applies]
            return _told(kind, alike, condition, settings)
    return None


def told(settings: Any) -> dict[str, Any]:
    """The options that count as a report has them: as the command line calls and writes them."""
    options = options_of(type(settings))
    return {
        _dest(name, options[name]): _as_argument(settings, options[name], value)
        for name, value in in_force(settings).items()
        if options[name].argument != ""
    }


def whole(least: int, most: int) -> Callable[[str], int]:
    """A type of argument: a whole number."""

    def read(text: str) -> int:
        if not (text.isdecimal() and least <= int(text) <= most):
            raise argparse.ArgumentTypeError(f"{text!r} is not a number from {least} to {most}")
        return int(text)

    return read


def number(text: str, least: float, most: float) -> float:
    """Read a number."""
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not least <= value <= most:
        message = f"{text!r} is not a number from {least:g} to {most:g}"
        raise argparse.ArgumentTypeError(message)
    return value


def positive(text: str) -> float:
    """Read a number above 0."""
    return number(text, float(np.finfo(float).tiny), 1e9)


def percent(text: str, least: float = 0.01) -> float:
    """Read a percentage; the sign is optional."""
    return number(text.removesuffix("%"), least, 100)


def _type(option: Option) -> dict[str, Any]:
    """How the text of an argument is read, and what stands for it in the help."""
    if option.kind == "integer":
        return {"type": whole(option.least, option.most or MANY), "metavar": "N"}
    if option.kind == "share" and option.metavar:  # a fraction here too
        least, most = option.least / 100, option.most / 100
        return {"type": lambda text: number(text, least, most), "metavar": option.metavar}
    if option.kind == "share":
        return {"type": lambda text: percent(text) / 100, "metavar": "PERCENT"}
    if option.kind == "number" and option.unit == "PIXEL":
        return {"type": positive, "metavar": "PIXELS"}
    if option.kind == "number" and option.unit == "PERCENTAGE":
        return {"type": lambda text: percent(text, option.least or 0), "metavar": "PERCENT"}
    if option.kind == "number":
        ends = [end if each is None else each for each, end in zip(option.range, FAR, strict=True)]
        return {"type": lambda text: number(text, *ends), "metavar": "X"}
    if option.kind == "name":
        return {"metavar": "NAME"}
    if option.kind == "choice" and option.other[0]:
        return {"metavar": f"{{{','.join([*_known(option), option.other[0]])}}}"}
    if option.kind == "choice":
        return {"type": str.lower, "choices": [name.lower() for name in option.names]}
    return {}


def _known(option: Option) -> list[str]:
    """The values of a choice that are no names."""
    return [name.lower() for name in option.names if name != option.other[0]]


def _labels(option: Option) -> str:
    """The values of a choice and what they are called."""
    text = ""
    for name, label, *_ in option.items:
        if name:
            said = (
                f"{name}: {label} by its name"
                if name == option.other[0]
                else (f"{name.lower()}: {label}")
            )
            text += f"{'' if not text or text.endswith(' ') else ', '}{said}"
        elif text:
            text += f"; {label.lower()} "
    return text


def _told(kind: type, names: list[str], condition: Only, settings: Any) -> str:
    flags = [_flag(name, options_of(kind)[name]) for name in names]
    other = _flag(condition.option, options_of(kind)[condition.option])
    if condition.otherwise:
        value = getattr(settings, condition.option).lower()
        return f"{flags[0]} is not for {other} {value}, which {condition.otherwise}"
    verb = "goes" if len(flags) == 1 else "go"
    return f"{' and '.join(flags)} {verb} with {_condition(kind, condition)}"


def _condition(kind: type, condition: Only) -> str:
    """The argument that a condition is about, and the values that it wants."""
    if options_of(kind)[condition.option].kind == "switch":
        return _flag(condition.option, options_of(kind)[condition.option])
    values = " or ".join(value.lower() for value in condition.values)
    return f"{_flag(condition.option, options_of(kind)[condition.option])} {values}"


def _as_argument(settings: Any, option: Option, value: Any) -> Any:
    if option.other[0] and value == option.other[0]:
        return getattr(settings, option.other[1])
    return value.lower() if option.kind == "choice" else value


def _written(option: Option) -> Any:
    """The default, as the command line has it."""
    if option.kind == "share":
        return 0.0
    return option.default.lower() if option.kind == "choice" else option.default


def _flag(name: str, option: Option) -> str:
    return "--" + (option.argument or name).replace("_", "-")


def _dest(name: str, option: Option) -> str:
    return (option.argument or name).replace("-", "_")
