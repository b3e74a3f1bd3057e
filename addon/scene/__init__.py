"""What Blender holds: objects and their surfaces read, shape keys, records and results written."""

from . import decomposition, documents, records, results

FILES = (decomposition, documents, results)
LOADED = (records.adopt_all,)
