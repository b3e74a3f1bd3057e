"""Images: their pixels read, split into bands, filtered, and written as new images."""

from . import properties

register, unregister = properties.register, properties.unregister
