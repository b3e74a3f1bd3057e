"""What Blender holds: objects and their surfaces read, shape keys, records and results written."""

from . import band_nodes, decomposition, documents, masks, records, results, work_objects

FILES = (band_nodes, decomposition, documents, masks, results, work_objects)
LOADED = (records.adopt_all,)
