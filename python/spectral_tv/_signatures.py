"""Writing out shared options in the signatures of functions."""

import inspect
from collections.abc import Callable
from typing import TypeVar, get_type_hints

from spectral_tv._options import DEFAULTS

Function = TypeVar("Function", bound=Callable[..., object])


def spelled(function: Function) -> Function:
    """Have `help` show every option in place of `**options`, with its default."""
    signature = inspect.signature(function)
    *others, options = signature.parameters.values()
    (shared,) = options.annotation.__args__
    keywords = [
        inspect.Parameter(
            name, inspect.Parameter.KEYWORD_ONLY, default=DEFAULTS[name], annotation=kind
        )
        for name, kind in get_type_hints(shared).items()
    ]
    function.__signature__ = signature.replace(parameters=[*others, *keywords])  # type: ignore[attr-defined]
    return function
