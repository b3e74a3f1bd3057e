"""Files: written whole or not at all, and told from those that were cut short."""

from typing import TYPE_CHECKING

if not TYPE_CHECKING:  # which knows them all
    from spectral_tv.later import modules_of

    __getattr__ = modules_of(__name__)
