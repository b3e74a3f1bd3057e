"""Dataclasses that share their methods: declaring one compiles nothing.

The decorator of the standard library writes the source of methods for each class and compiles it.
That was most of the time that Blender took to enable the extension. What this one makes behaves the
same: `fields`, `replace` and `asdict` take it too.
"""

import dataclasses
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

T = TypeVar("T")


def _fields(thing: Any) -> Mapping[str, "dataclasses.Field[Any]"]:
    """Those of an object or a class, in their order, by their names."""
    found: Mapping[str, dataclasses.Field[Any]] = thing.__dataclass_fields__
    return found


def _init(self: Any, *args: Any, **given: Any) -> None:
    known = _fields(self)
    values = dict(zip(known, args, strict=False)) | given
    if len(values) < len(args) + len(given) or not values.keys() <= known.keys():
        raise TypeError(f"{type(self).__name__} takes each of {[*known]} once, and no more")
    own = vars(self)
    for name, field in known.items():
        if name in values:
            own[name] = values[name]
        elif field.default is not dataclasses.MISSING:
            own[name] = field.default
        elif field.default_factory is not dataclasses.MISSING:
            own[name] = field.default_factory()
        else:
            raise TypeError(f"{type(self).__name__} lacks {name!r}")


def _repr(self: Any) -> str:
    shown = [name for name, field in _fields(self).items() if field.repr]
    values = ", ".join(f"{name}={getattr(self, name)!r}" for name in shown)
    return f"{type(self).__qualname__}({values})"


def _compared(self: Any) -> tuple[Any, ...]:
    return tuple(getattr(self, name) for name, field in _fields(self).items() if field.compare)


def _eq(self: Any, other: object) -> bool:
    if type(other) is not type(self):
        return NotImplemented
    return _compared(self) == _compared(other)


def _hash(self: Any) -> int:
    return hash(_compared(self))


def _refuse(self: Any, name: str, *_value: object) -> None:
    raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")


_COMPARING = {"__eq__": _eq, "__hash__": _hash}
_FROZEN = {"__setattr__": _refuse, "__delattr__": _refuse}

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(
        cls: type[T] | None = None, /, *, frozen: bool = False, eq: bool = True
    ) -> type[T] | Callable[[type[T]], type[T]]:
        """Make a dataclass; methods that the class has itself are kept."""

        def make(made: type[T]) -> type[T]:
            own = vars(made)
            methods = {"__init__": _init, "__repr__": _repr}
            methods |= (_COMPARING if eq else {}) | (_FROZEN if frozen else {})
            missing = {name: each for name, each in methods.items() if name not in own}
            made = dataclasses.dataclass(init=False, repr=False, eq=False)(made)
            for name, method in missing.items():
                setattr(made, name, method)
            if eq and not frozen:
                made.__hash__ = None
            return made

        return make if cls is None else make(cls)


__all__ = ["dataclass"]
