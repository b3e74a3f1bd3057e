"""Long work: functions that start a job and wait for it, and their twins that do not wait."""

import functools
import inspect
import textwrap
from collections.abc import Callable
from typing import Any, Literal, ParamSpec, TypeVar, get_args, get_origin, get_type_hints

from spectral_tv._native import Job
from spectral_tv._options import DEFAULTS

# Of docstrings.
WIDTH, MARGIN = 100, " " * 8

P = ParamSpec("P")
T = TypeVar("T")


def waiting(start: Callable[P, Job[T]]) -> Callable[P, T]:
    """Have a function that returns a job wait for its result, and tell ``progress`` meanwhile.

    A signal such as Ctrl-C, and an exception from ``progress``, end the work and are passed on.
    """
    plain = inspect.signature(start)

    @functools.wraps(start)
    def wait(*args: P.args, **kwargs: P.kwargs) -> T:
        bound = plain.bind(*args, **kwargs)
        progress = bound.arguments.pop("progress", None)
        result: T = start(*bound.args, **bound.kwargs)._wait(progress)
        return result

    _show(wait, plain)
    return wait


def starting(wait: Callable[P, T]) -> Callable[P, Job[T]]:
    """The twin of a waiting function that returns the job at once, and takes no ``progress``."""
    start: Callable[P, Job[T]] = wait.__wrapped__  # type: ignore[attr-defined]
    plain = _without_progress(inspect.signature(start))

    @functools.wraps(start)
    def begin(*args: P.args, **kwargs: P.kwargs) -> Job[T]:
        bound = plain.bind(*args, **kwargs)
        return start(*bound.args, **bound.kwargs)

    name = start.__name__
    begin.__name__ = begin.__qualname__ = f"start_{name}"
    begin.__doc__ = (
        f"Start `{name}` in a thread of its own and return the `Job` at once.\n\n"
        f"    It takes the arguments of `{name}`, without `progress`.\n    "
    )
    _show(begin, plain)
    return begin


def spelled(function: Callable[P, T]) -> Callable[P, T]:
    """Have `help` show every option in place of `**options`, with its default."""
    _show(function, inspect.signature(function))
    return function


def _without_progress(signature: inspect.Signature) -> inspect.Signature:
    kept = [each for name, each in signature.parameters.items() if name != "progress"]
    return signature.replace(parameters=kept)


def _show(function: Any, signature: inspect.Signature) -> None:
    """Show names and defaults; types stand in the text, and in the annotations for checkers."""
    empty = inspect.Parameter.empty
    shown = [each.replace(annotation=empty) for each in signature.parameters.values()]
    *_, last = signature.parameters.values()
    if last.kind is inspect.Parameter.VAR_KEYWORD:
        (options,) = last.annotation.__args__
        kind = inspect.Parameter.KEYWORD_ONLY
        names = get_type_hints(options)
        shown[-1:] = [inspect.Parameter(name, kind, default=DEFAULTS[name]) for name in names]
        function.__doc__ = function.__doc__.replace("    {options}", documented(options))
    function.__signature__ = inspect.Signature(shown)


def documented(options: type) -> str:
    """The entries of options under Parameters, by their annotations: type, text, and kind."""
    entries = []
    for name, hint in get_type_hints(options, include_extras=True).items():
        annotation, text, *kind = get_args(hint)
        entries.append(f"    {name} : {_kind(annotation, *kind)}")
        entries.append(textwrap.fill(text, WIDTH, initial_indent=MARGIN, subsequent_indent=MARGIN))
    return "\n".join(entries)


def _kind(annotation: Any, told: str = "") -> str:
    """What a value is, as an entry has it."""
    if get_origin(annotation) is Literal:
        return "{" + ", ".join(f'"{word}"' for word in get_args(annotation)) + "}"
    if isinstance(annotation, type):
        return annotation.__name__
    return f"{told or get_args(annotation)[0].__name__}, optional"
