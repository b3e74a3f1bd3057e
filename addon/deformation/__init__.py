"""Deformations: what holds and moves an object, and what becomes of it."""
