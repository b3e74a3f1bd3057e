"""Which decompositions act: what they change of the shape that is seen, and what is muted."""

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.notes import listed

from ..scene.decomposition import SpectralTVRecord
from ..scene.keeping import Band
from ..scene.records import bands_shown, record_of, records_of


@dataclass(frozen=True)
class State:
    """Of a decomposition the bands that act, those that would if they were not muted, the number
    of the one that is soloed, 0 if none is, and its name."""

    acting: list[Band]
    silent: list[Band]
    solo: int
    name: str

    @classmethod
    def of(cls, obj: bpy.types.Object, record: SpectralTVRecord) -> "State":
        """Read the values."""
        bands = [key for key in bands_shown(obj, record) if key is not None and key.value != 0]
        acting = [key for key in bands if not key.mute]
        return cls(acting, [key for key in bands if key.mute], record.solo, record.name)

    def __bool__(self) -> bool:
        """Whether anything is not at rest."""
        return bool(self.acting or self.silent or self.solo)

    @property
    def icon(self) -> str:
        """Its sign in a list: an eye where bands act, a closed one where they are muted."""
        return "HIDE_OFF" if self.acting else "HIDE_ON" if self else "BLANK1"

    def told(self) -> str:
        """Say it, such as ``acts: Band 1 −1``."""
        if self.acting:
            values = (f"{self._short(key)} {key.value:.2g}" for key in self.acting)
            values = (value.replace("-", "−") for value in values)
            return f"acts: {listed(values)}"
        if self.solo:
            return f"has band {self.solo} soloed"
        return f"is muted: {listed(map(self._short, self.silent))}"

    def _short(self, band: Band) -> str:
        return band.name.removeprefix(f"{self.name} ")


def others_acting(obj: bpy.types.Object) -> list[tuple[SpectralTVRecord, State]]:
    """The decompositions beside the active one that are not at rest."""
    active = record_of(obj)
    states = [(each, State.of(obj, each)) for each in records_of(obj) if each != active]
    return [(each, state) for each, state in states if state]
