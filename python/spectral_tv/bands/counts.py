"""How many faces bands fold and stretch, and how that is said."""

from spectral_tv.dataclass import dataclass


@dataclass(frozen=True)
class Counts:
    """How many faces of an object fold, and how many stretch beyond the limit."""

    folded: int = 0
    stretched: int = 0

    def __add__(self, other: "Counts") -> "Counts":
        """Those of both."""
        return Counts(self.folded + other.folded, self.stretched + other.stretched)

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self.folded or self.stretched)

    def told(self) -> str:
        """Say it, such as ``12 faces fold, 3 stretch``."""
        if self.folded == 0 and self.stretched:
            return "1 face stretches" if self.stretched == 1 else f"{self.stretched} faces stretch"
        if self.folded == 0:
            return "no face folds"
        told = "1 face folds" if self.folded == 1 else f"{self.folded} faces fold"
        if self.stretched:
            told += ", 1 stretches" if self.stretched == 1 else f", {self.stretched} stretch"
        return told
