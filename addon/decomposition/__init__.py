"""Decompositions in the terms of the user, and their bands on an object."""
