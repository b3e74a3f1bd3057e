"""Long work: functions that start a job and wait for it, and their twins that do not wait."""

import functools
import inspect
import re
import textwrap
from collections.abc import Callable, Mapping
from types import NoneType, UnionType
from typing import Annotated, Any, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

from spectral_tv._native import Job
from spectral_tv._options import DEFAULTS

# Of docstrings.
WIDTH, MARGIN = 96, " " * 4
# A line that stands for the entry of a parameter.
PLACE = re.compile(r"^\{(\w+)\}$", re.MULTILINE)

P = ParamSpec("P")
T = TypeVar("T")


def waiting(start: Callable[P, Job[T]]) -> Callable[P, T]:
    """Have a function that returns a job wait for its result, and tell ``progress`` meanwhile.

    A signal such as Ctrl-C, and an exception from ``progress``, end the work and are passed on.
    """
    shown = _shown(start)

    @functools.wraps(start)
    def wait(*args: P.args, **kwargs: P.kwargs) -> T:
        bound = shown.bind(*args, **kwargs)  # which refuses what is no option of the function
        progress = bound.arguments.pop("progress", None)
        result: T = start(*bound.args, **bound.kwargs)._wait(progress)
        return result

    _tell(wait, shown, _documentation(start))
    return wait


def starting(wait: Callable[P, T]) -> Callable[P, Job[T]]:
    """The twin of a waiting function that returns the job at once, and takes no ``progress``."""
    start: Callable[P, Job[T]] = wait.__wrapped__  # type: ignore[attr-defined]
    everything = inspect.signature(wait)
    kept = [each for name, each in everything.parameters.items() if name != "progress"]
    shown = everything.replace(parameters=kept)

    @functools.wraps(start)
    def begin(*args: P.args, **kwargs: P.kwargs) -> Job[T]:
        bound = shown.bind(*args, **kwargs)
        return start(*bound.args, **bound.kwargs)

    name = start.__name__
    begin.__name__ = begin.__qualname__ = f"start_{name}"
    text = f"""Start `{name}` in a thread of its own and return the `Job` at once.

    It takes the arguments of `{name}`, without `progress`.
    """
    _tell(begin, shown, text)
    return begin


def spelled(function: Callable[P, T]) -> Callable[P, T]:
    """Have `help` show every option in place of `**options`, with its default."""
    _tell(function, _shown(function), _documentation(function))
    return function


def _options_of(function: Callable[..., Any]) -> type | None:
    """The options that the function takes by `**options`, if it does."""
    *_, last = inspect.signature(function).parameters.values()
    is_open = last.kind is inspect.Parameter.VAR_KEYWORD
    return last.annotation.__args__[0] if is_open else None


def _shown(function: Callable[..., Any]) -> inspect.Signature:
    """Names and defaults, with every option in place of `**options`; types stand in the text."""
    empty = inspect.Parameter.empty
    given = inspect.signature(function).parameters.values()
    shown = [each.replace(annotation=empty) for each in given]
    options = _options_of(function)
    if options is not None:
        kind, names = inspect.Parameter.KEYWORD_ONLY, get_type_hints(options)
        shown[-1:] = [inspect.Parameter(name, kind, default=DEFAULTS[name]) for name in names]
    return inspect.Signature(shown)


def _documentation(function: Callable[..., Any]) -> str:
    """The function's own, with entries in place of the names of parameters in braces."""
    parameters, options = inspect.signature(function).parameters, _options_of(function)

    def entries(place: re.Match[str]) -> str:
        name = place[1]
        if options is not None and name == "options":
            return documented(get_type_hints(options, include_extras=True))
        return documented({name: parameters[name].annotation})

    # Pythons from 3.13 on have taken the indentation away.
    return PLACE.sub(entries, inspect.cleandoc(function.__doc__ or ""))


def _tell(function: Any, shown: inspect.Signature, text: str) -> None:
    """Have `help` show this."""
    function.__signature__ = shown
    function.__doc__ = text


def documented(hints: Mapping[str, Any]) -> str:
    """The entries of parameters in a docstring, by their annotations."""
    return "\n".join(line for name, hint in hints.items() for line in _entry(name, hint))


def _entry(name: str, hint: Any) -> list[str]:
    """The lines of one: what it is, its text, and the text of each choice."""
    members, is_optional = _members(hint)
    texts, kinds = [], []
    if len(members) == 1 and get_origin(members[0]) is Annotated:
        annotation, text, *kinds = get_args(members[0])
        members, can_be_none = _members(annotation)
        is_optional |= can_be_none
        texts.append(text)
    choices = {}
    for literal, text in (get_args(each) for each in members if get_origin(each) is Annotated):
        (word,) = get_args(literal)
        choices[f'"{word}"'] = text
    if choices:
        kinds = ["{" + ", ".join(choices) + "}"]
    texts += [f"{word}: {text}" for word, text in choices.items()]
    kind = kinds[0] if kinds else members[0].__name__
    filled = (
        textwrap.fill(each, WIDTH, initial_indent=MARGIN, subsequent_indent=MARGIN)
        for each in texts
    )
    return [f"{name} : {kind}{', optional' if is_optional else ''}", *filled]


def _members(annotation: Any) -> tuple[list[Any], bool]:
    """Those of a union, or the type itself, but None; and whether None is among them."""
    is_union = get_origin(annotation) in (Union, UnionType)
    members = get_args(annotation) if is_union else (annotation,)
    return [each for each in members if each is not NoneType], NoneType in members
