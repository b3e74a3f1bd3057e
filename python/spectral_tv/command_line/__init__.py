"""What the command lines, with and without Blender, have in common."""
