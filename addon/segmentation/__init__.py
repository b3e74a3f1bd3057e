"""Parts: found alike in several poses, and written on them."""

from . import cosegment, panel, properties, split_segments

FILES = (properties, cosegment, split_segments, panel)
