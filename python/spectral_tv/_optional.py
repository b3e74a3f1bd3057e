"""Libraries that only some functions need."""

import importlib
from typing import Any


def needed(module: str, user: str, extra: str) -> Any:
    """Import a library, or tell how to install it.

    Raises
    ------
    ImportError
        Says which extra of the package brings the library.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] != module.split(".", maxsplit=1)[0]:
            raise
        name = module.split(".", maxsplit=1)[0]
        message = f'{user} needs {name}: pip install "spectral-tv[{extra}]"'
        raise ImportError(message, name=name) from error
