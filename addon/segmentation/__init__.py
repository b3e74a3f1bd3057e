"""Parts: found alike in several poses, and written on them."""

from . import cosegment, panel, properties

FILES = (properties, cosegment, panel)
