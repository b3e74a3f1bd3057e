"""Modules that are read when something of them is first asked for."""

import os
import sys
from collections.abc import Callable
from functools import cache, cached_property
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

__all__ = ["csv", "hashlib", "json", "modules_of", "np", "uuid"]


class Later:
    """Stands for a module until then."""

    def __init__(self, name: str) -> None:
        """The module of this name."""
        self._name = name

    @cached_property
    def _module(self) -> ModuleType:
        return import_module(self._name)

    def __getattr__(self, attribute: str) -> Any:
        return getattr(self._module, attribute)


def modules_of(package: str) -> Callable[[str], Later]:
    """Make the `__getattr__` of a package, by which `from package import module` reads nothing yet.

    `from package.module import name` reads the module at once all the same.
    """
    (folder,) = sys.modules[package].__path__
    known = {file.partition(".")[0] for file in os.listdir(folder)}

    @cache
    def module(name: str) -> Later:
        if name not in known:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return Later(f"{package}.{name}")

    return module


# To read these takes longer than all else that enables the extension, which computes nothing then.
# So files that are read by then have them from here.
if TYPE_CHECKING:
    import csv
    import hashlib
    import json
    import uuid

    import numpy as np
else:
    csv, hashlib, json, np, uuid = map(Later, ("csv", "hashlib", "json", "numpy", "uuid"))
