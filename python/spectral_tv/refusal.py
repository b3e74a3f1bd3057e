"""What is told where something cannot be used."""

from collections.abc import Sequence


class Refusal(Exception):
    """An input or a setting cannot be used; the message tells the user why.

    ``vertices`` are the indices of those at fault, where it is theirs.
    """

    def __init__(self, message: str, vertices: Sequence[int] = ()) -> None:
        """Take the message and the vertices."""
        super().__init__(message)
        self.vertices = vertices
