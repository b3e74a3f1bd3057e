"""Drawing that panels share, and the preferences that it goes by."""

from . import preferences, sizes

FILES = (preferences,)
FORGET = (sizes.forget,)
