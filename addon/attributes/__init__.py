"""Functions on a mesh: attributes, vertex groups and shape keys, read, flowed and written back."""

from spectral_tv.later import modules_of

__getattr__ = modules_of(__name__)

FILES = (
    "properties",
    "flow",
    "values",
    "eigenset",
    "thickness",
    "measure_accuracy",
    "panel",
    "accuracy_panel",
)
