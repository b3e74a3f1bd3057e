"""The same parts in several shapes."""
