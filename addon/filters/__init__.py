"""Filters of any shape, as gains of the bands."""
