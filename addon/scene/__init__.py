"""What Blender holds: objects and their surfaces read, shape keys, records and results written."""

from . import documents, records, results, work_objects

FILES = (records, documents, results, work_objects)
