"""Functions on a mesh: attributes, vertex groups and shape keys, read, flowed and written back."""

from . import properties

register, unregister = properties.register, properties.unregister
