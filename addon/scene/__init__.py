"""What Blender holds: objects and their surfaces read, shape keys, records and results written."""

from . import decomposition, documents, records, results, work_objects

FILES = (decomposition, documents, results, work_objects)
LOADED = (records.adopt_all,)
