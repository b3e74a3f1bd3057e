"""A recipe made of objects: their bands, the values of these, and where they are held back."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Any

import bpy
import spectral_tv
from spectral_tv.bands.guard import STRETCH
from spectral_tv.bands.limits import Limited
from spectral_tv.bands.settings import Settings
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.steps import Steps
from spectral_tv.later import np
from spectral_tv.notes import listed, note

from ..bands import limiting
from ..bands.adding import Part, add_bands
from ..bands.bands import prepare_together, recall, set_values, start_split
from ..bands.clamping import least_of_copies
from ..bands.properties import sidebar_kind
from ..bands.replacing import check_replaced, replaced_identifiers
from ..scene import lengths, results
from ..scene.decomposition import SpectralTVRecord
from ..scene.records import activate, bands_of, record_of, records_of
from ..scene.results import Piece
from ..scene.surface import Surface
from ..scene.temporary import Temporary
from .noise import FINEST, LARGEST, LEAST, Noise
from .recipe import Recipe

# What the masks of recipes are written as.
KIND, MASK = "RECIPE", "Mask"
# Of the work, what the flow takes before the guard.
FLOW = 0.8


@dataclass(frozen=True)
class Made:
    """The flow, the values of its bands, and how much of them each vertex takes, (N,); None where
    all take all. ``told`` says what was found."""

    split: spectral_tv.Decomposition
    values: list[float]
    shares: np.ndarray | None
    told: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Making:
    """A recipe at a strength, and the objects, as one surface, that it is made of.

    ``former`` has the names of the decompositions of the same recipe, "" where there is none.
    """

    recipe: Recipe
    strength: float
    settings: Settings
    surfaces: list[Surface]
    arguments: dict[str, Any]
    noise: Noise | None
    former: list[str]
    replaced: list[str]
    # How far a vertex may be moved, in the scene's unit; 0 is no limit.
    limit: float = 0.0
    # The decomposition, where it is one of several frames.
    split: spectral_tv.Decomposition | None = None

    @classmethod
    def prepare(
        cls,
        objects: Sequence[bpy.types.Object],
        recipe: Recipe,
        strength: float,
        limit: float = 0.0,
    ) -> Making:
        """Read the objects; raises Refusal or spectral_tv.MeshError if that cannot be done."""
        former = [_former(obj, recipe) for obj in objects]
        into = "REPLACE" if all(former) else "ADD"
        settings, noise = replace(recipe.settings, into=into, bands_as=sidebar_kind()), None
        with Temporary() as temporary:
            for obj, record in zip(objects, former, strict=True):
                if into == "REPLACE":
                    kept = obj.data.spectral_tv
                    place = kept.decompositions.find(record.name)
                    temporary.put(kept, "active_decomposition", place)
            surfaces, arguments = prepare_together(objects, settings)
            if recipe.cleans:
                noise = Noise.of(surfaces[0].mesh)
                settings = _for_noise(settings, noise, surfaces[0].mesh)
                arguments = settings.arguments(surfaces[0].mesh, None)
            replaced = replaced_identifiers(objects, settings)
        names = [
            record.name if record is not None and into == "REPLACE" else "" for record in former
        ]
        return cls(recipe, strength, settings, surfaces, arguments, noise, names, replaced, limit)

    def recall(self) -> Made | None:
        """What is made, if that is known without work."""
        split = self._known()
        if split is None:
            return None
        bands, values = self._dialled(split)
        return None if _added(bands, values).any() else self._made(split, bands, values)

    def _known(self) -> spectral_tv.Decomposition | None:
        return self.split or recall(self.surfaces[0], self.arguments)

    def start(self) -> Steps[Made]:
        """Decompose, and hold back what would fold."""
        mesh = self.surfaces[0].mesh

        def steps() -> Iterator:
            split = self._known()
            if split is None:
                split = yield start_split(mesh, self.settings, self.arguments), FLOW
            bands, values = self._dialled(split)
            added = _added(bands, values)
            if not added.any():
                return self._made(split, bands, values)
            taken = np.tensordot(np.minimum(values, 0), bands, 1)
            # Of the shape that is left of what goes.
            with warnings.catch_warnings():  # that were told of the mesh itself
                warnings.simplefilter("ignore", spectral_tv.MeshWarning)
                left = spectral_tv.Mesh(mesh.vertices + taken, mesh.triangles)
            safe = yield partial(spectral_tv.start_safe_displacement, left, added, STRETCH)(), 1.0
            return self._made(split, bands, values, safe)

        return Steps(steps())

    def write(self, objects: Sequence[bpy.types.Object], made: Made) -> str:
        """Write bands, values and masks; returns what was done."""
        for obj, name in zip(objects, self.former, strict=True):
            if name:
                activate(obj.data, name)
        check_replaced(objects, self.settings, self.replaced)
        pairs = zip(objects, self.surfaces, strict=True)
        parts = [Part(*pair, self.arguments, made.split) for pair in pairs]
        with self._unmasked(objects):
            done = add_bands(parts, self.settings, self.recipe.name)
        for obj, surface in zip(objects, self.surfaces, strict=True):
            record_of(obj).recipe = self.recipe.name
            self._mask(obj, surface, made)
            set_values(obj, made.values)
        for text in made.notes:
            note(text)
        found = f"; {made.told}" if made.told else ""
        return f"{self.recipe.name} at {self.strength:g}{found}; {done}"

    def hold(self, objects: Sequence[bpy.types.Object]) -> list[Limited]:
        """Hold what was written within the limit, of each object; tells nothing without one."""
        found = []
        for obj in objects:
            bands = [band for band in bands_of(obj) if band is not None]
            found.append(limiting.limit(obj, bands, self.limit, [record_of(obj)]))
        return [each for each in found if each is not None]

    def _dialled(self, split: spectral_tv.Decomposition) -> tuple[np.ndarray, list[float]]:
        """The bands (K, N, 3), and their values."""
        edges = split.band_edges(self.settings.band_count)
        bands = split.bands(edges, self.settings.limbs_kept)
        if self.noise is None:
            return bands, self.recipe.scaled(self.strength)
        return bands, self.noise.values(bands, self.strength)

    def _made(
        self,
        split: spectral_tv.Decomposition,
        bands: np.ndarray,
        values: list[float],
        safe: spectral_tv.SafeDisplacement | None = None,
    ) -> Made:
        if self.noise is not None:
            return self._cleaned(split, bands, values)
        notes = () if any(values) else ("at this strength nothing changes",)
        if safe is None or safe.kept >= 1:
            return Made(split, values, None, notes=notes)
        # Rounded down to what is as good as none, so that a mask is worth its name.
        percent = np.floor(1000 * safe.kept) / 10
        return Made(split, values, safe.shares, f"{percent:g} % of it kept, the rest would fold")

    def _cleaned(
        self, split: spectral_tv.Decomposition, bands: np.ndarray, values: list[float]
    ) -> Made:
        noise = self.noise
        size = lengths.told(noise.size)
        told = f"noise of {size} found, {100 * noise.share:.2g} % of the edges' length"
        least = f"hardly any noise: less than {100 * LEAST:g} % of the edges' length"
        notes = (least,) if noise.share < LEAST else ()
        if not any(values):
            return Made(split, values, None, told, notes)
        mask = noise.mask(bands, values, self.strength)
        kept = 100 * float(1 - mask.mean())
        return Made(
            split, values, mask, f"{told}; {kept:.2g} % of the surface kept as edges", notes
        )

    @contextmanager
    def _unmasked(self, objects: Sequence[bpy.types.Object]) -> Iterator[None]:
        """Have new bands take over no mask that is made anew; all is as before if that fails."""
        masked = []
        for obj, name in zip(objects, self.former, strict=True):
            mine = self._masks(obj)
            bands = [*filter(None, bands_of(obj))] if name else []
            masked += [(band, band.vertex_group) for band in bands]
            for band, own in limiting.lifted(obj, bands).items():
                band.vertex_group = own
            for band in bands:
                if band.vertex_group in mine:
                    band.vertex_group = ""
        try:
            yield
        except BaseException:
            for band, group in masked:
                band.vertex_group = group
            raise

    def _masks(self, obj: bpy.types.Object) -> set[str]:
        """The masks that the recipe wrote and nobody changed, as they are called today."""
        results_of = obj.data.spectral_tv.results
        return {
            name
            for place, name in results.known(obj, "GROUP").items()
            if (results_of[place].kind, results_of[place].source) == (KIND, self.recipe.name)
        }

    def _mask(self, obj: bpy.types.Object, surface: Surface, made: Made) -> None:
        """Have the bands that act take part as far as they may, by a vertex group."""
        mine = self._masks(obj)
        bands = [band for band in bands_of(obj) if band is not None]
        free = [band for band in bands if band.vertex_group in ("", *mine)]
        pieces = {}
        if made.shares is not None:
            others = [band.vertex_group for band in bands if band not in free]
            if others:
                note(f"as masks of yours they stay as they are: {listed(others)}")
            if free:
                pieces[MASK] = Piece("GROUP", least_of_copies(surface, made.shares))
        if not pieces and not mine:
            return
        names = results.write(obj, KIND, self.recipe.name, pieces, lambda label: label == MASK)
        for band in free:
            band.vertex_group = names[0] if names else ""


def _former(obj: bpy.types.Object, recipe: Recipe) -> SpectralTVRecord | None:
    """The decomposition of an object that was made by a recipe and can be replaced, if any."""
    for record in records_of(obj):
        is_like = record.recipe == recipe.name and record.method == recipe.settings.method
        if is_like and record.vertex_count == len(obj.data.vertices):
            return record
    return None


def _for_noise(settings: Settings, noise: Noise, mesh: spectral_tv.Mesh) -> Settings:
    """Settings with bands of the sizes of noise."""
    edge = noise.edge / np.sqrt(mesh.area)
    finest = min(FINEST * edge, 0.1)
    return replace(settings, finest=finest, largest=min(LARGEST * edge, 1.0))


def _added(bands: np.ndarray, values: Sequence[float]) -> np.ndarray:
    """What bands above 0 add, (N, 3)."""
    return np.tensordot(np.maximum(values, 0), bands, 1)
