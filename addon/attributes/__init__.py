"""Functions on a mesh: attributes, vertex groups and shape keys, read, flowed and written back."""

from . import (
    accuracy_panel,
    eigenset,
    flow,
    measure_accuracy,
    panel,
    properties,
    thickness,
    values,
)

FILES = (properties, flow, values, eigenset, thickness, measure_accuracy, panel, accuracy_panel)
