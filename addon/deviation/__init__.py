"""How far a look is from the original: limited, measured, and shown in color."""

from . import heat_map, limit_movement, measure, panel, properties

FILES = (properties, limit_movement, measure, panel)
START = (heat_map.start,)
WITHDRAW = (heat_map.withdraw,)
FORGET = (heat_map.forget,)
