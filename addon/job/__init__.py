"""Work beside Blender: the thread it runs in, what it will take, and what it refused."""
