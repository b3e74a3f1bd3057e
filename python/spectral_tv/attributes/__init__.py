"""Functions on a mesh: what is flowed, and how accurate bands are."""
