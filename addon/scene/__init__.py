"""What Blender holds: objects and their surfaces read, shape keys, records and segments written."""
