"""What Blender holds: objects and their surfaces read, shape keys, records and results written."""

from . import documents, records, results

FILES = (records, documents, results)
