"""Pictures: what of them flows, and what formats hold of the result."""

from typing import TYPE_CHECKING

if not TYPE_CHECKING:  # which knows them all
    from spectral_tv.later import modules_of

    __getattr__ = modules_of(__name__)
