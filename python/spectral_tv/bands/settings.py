"""The settings of a decomposition, in the user's terms: sizes are relative to the object's size."""

from __future__ import annotations

import math
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any, Literal

import spectral_tv
from spectral_tv import DEFAULTS
from spectral_tv._options import FEWEST_STEPS
from spectral_tv.bands.gains import too_few_steps
from spectral_tv.bands.methods import ITEMS, METHODS, WITH_BANDS, WITH_BASE, Method, taking
from spectral_tv.dataclass import dataclass
from spectral_tv.later import json, np
from spectral_tv.options.declaring import (
    Only,
    choice,
    in_force,
    integer,
    keywords,
    name_of,
    number,
    share,
    switch,
)
from spectral_tv.options.estimates import Needs, total

if TYPE_CHECKING:
    from numpy.typing import NDArray

INTO_TEXT = "What becomes of the active decomposition"
INTO = (
    ("REPLACE", "Replace",
     "The new bands take the place of the active ones of the same method, and do what these did. "
     "Of another method they are added"),
    ("ADD", "Add", "The new bands are a decomposition of their own, of the shape that is shown"),
)  # fmt: skip
INTO_ANY = (
    *INTO,
    ("REPLACE_ANY", "Replace Any",
     "The new bands take the place of the active ones, of whatever method these are"),
)  # fmt: skip
BANDS_AS = (
    ("KEYS", "Shape Keys", "One shape key per band"),
    ("ATTRIBUTES", "Attributes",
     "One vector attribute per band, which a Geometry Nodes modifier adds: the mesh may be "
     "subdivided and remeshed, and modifiers applied"),
)  # fmt: skip
# With icons and numbers, as files keep the numbers of old.
BASES = (
    ("LIMBS", "Limbs Kept", "The object itself, smoothed, but with limbs as thick as they are",
     "", 3),
    ("FLOW", "Smoothed Shape", "The object itself, smoothed until its limbs are gone (the paper's "
     "base)", "", 0),
    ("FLAT", "Flat", "The object flattened along its local Z axis: for reliefs and terrain", "", 1),
    ("KEY", "Shape Key", "One of the object's shape keys", "", 2),
)  # fmt: skip
SMOOTHED = ("LIMBS", "FLOW")
DISPLACEMENTS = (
    ("VECTOR", "Vectors", "Displacements as they are: nothing is scratched or turned over"),
    ("SCALAR", "Lengths", "Signed lengths of displacements, whose directions stay (the paper's "
     "way)"),
)  # fmt: skip
METRICS = (
    ("SURFACE", "Surface", "Along the object itself: on images, adaptive spectral TV"),
    ("BASE", "Base", "Along the base: with the flat one, the spectral TV of images"),
)
SHAPES = (
    ("SHOWN", "As Shown", "The mesh as its shape keys show it now, before modifiers"),
    ("BASIS", "Basis", "The mesh without its shape keys"),
    (
        "APPLIED",
        "Modifiers Applied",
        "All that is seen on this frame, in a new object without modifiers; this one is hidden",
    ),
    (
        "MULTIRES",
        "Multiresolution",
        "The top level at rest, in a work object. Write Back gives it the shape of that",
    ),
)
# Those whose bands are on a new object: the shapes have other vertices than the mesh.
ON_NEW_OBJECT = ("APPLIED", "MULTIRES")
# What options are in effect where a record says nothing of them.
BEFORE = {"soft_edges": 0.0, "keep_limbs": 0.0, "base": "FLOW", "displacement": "SCALAR"}
# Corners of open edges that are this near are meant to be one: percent of the object's size. It is
# what rounding leaves of coordinates with six digits.
WELD = 1e-3
STEPS = "Number of time steps of the flow. More steps separate scales more sharply and take longer"
SCALES = ("use_scales", "Custom Scales", "Choose the range of sizes that the bands cover")


@dataclass(frozen=True)
class Settings:
    """Arguments of a decomposition.

    Sizes are lengths relative to the square root of the surface area; 0 stands for what suits
    the method. An accuracy, the relative error of the bands, takes as many steps as it needs; 0
    takes ``steps``. ``weld`` is a percentage.
    """

    method: str = choice(
        "Method", "What the bands split off", ITEMS, DEFAULTS["method"].upper(), place="method"
    )
    bands: int = integer(
        "Bands",
        "Number of bands, from the finest detail to the largest", 5, 1, 32,
        applies=WITH_BANDS, place="method"
    )  # fmt: skip
    steps: int = integer(
        "Steps", STEPS, DEFAULTS["steps"], 2, 1000, soft_most=128, applies=WITH_BANDS,
        place="method"
    )  # fmt: skip
    accuracy: float = share(
        "Error",
        "How far the bands may be from those of the finest steps, relative to their size: 10% is "
        "hardly seen", 5, 0.5, 50, digits=1,
        switch=(
            "use_accuracy", "Steps by Accuracy", "Take as many steps as the accuracy needs. The "
            "first flows, which tell how many, take time too"
        ),
        instead_of="steps", applies=taking("accuracy", "takes no time steps"),
        keyword="accuracy", metavar="E", refused=True
    )  # fmt: skip
    soft_edges: float = number(
        "Soft Edges",
        "How soft the edges of bands are. 0 is the paper's total variation, by which features "
        "vanish at once and leave hems", 0.3, 0, 1, digits=2, applies=taking("soft_edges"),
        place="method", keyword="soft_edges", refused=True
    )  # fmt: skip
    keep_limbs: float = number(
        "Keep Limbs",
        "How much of limbs stays whatever bands do: 1 suits most characters, 2 keeps more, 0.5 "
        "exaggerates more, 0 keeps nothing (the paper's bands)", None, 0, 100, soft_most=4,
        digits=2, own=lambda asked: asked.by.keep_limbs, applies=WITH_BANDS
    )  # fmt: skip
    eigenpairs: int = integer(
        "Eigenfunctions",
        "Number of eigenfunctions, the coarsest. More of them hold finer detail; the time grows "
        "with the square of their number", DEFAULTS["eigenpairs"], 2, 10000, soft_most=1000,
        applies=taking("eigenpairs"), place="method", keyword="eigenpairs"
    )  # fmt: skip
    finest: float = share(
        "Finest",
        "Size of the finest detail to tell apart", 0, 0, 50, is_size=True,
        soft_least=0.01, digits=2, switch=SCALES,
        own=lambda asked: math.sqrt(asked.own_scales()[0]), applies=WITH_BANDS, place="scales"
    )  # fmt: skip
    largest: float = share(
        "Largest",
        "Size of the largest features that bands hold. What is larger stays in the low-pass",
        0, 0, 100, is_size=True, soft_least=0.02, digits=2, switch=SCALES,
        own=lambda asked: math.sqrt(asked.own_scales()[1]), applies=WITH_BANDS, place="scales"
    )  # fmt: skip
    base: str = choice(
        "Base",
        "The smooth shape from which detail is measured", BASES, "LIMBS", other=("KEY", "base_key"),
        applies=WITH_BASE, place="base", refused=True
    )  # fmt: skip
    base_amount: float = share(
        "Smoothing",
        "Size of the features that vanish from the base", 0, 0, 50, is_size=True,
        soft_least=0.1, digits=1,
        switch=("use_base_amount", "Custom Amount", "Choose how much the base is smoothed"),
        own=lambda asked: math.sqrt(spectral_tv.default_base_time(asked.own_base())),
        applies=(WITH_BASE, Only("base", SMOOTHED)), place="base", refused=True
    )  # fmt: skip
    base_key: str = name_of(
        "Shape Key", "The shape key that is the base", search="key_blocks",
        applies=(WITH_BASE, Only("base", ["KEY"])), place="base", argument=""
    )  # fmt: skip
    displacement: str = choice(
        "Detail", "What of the displacement from the base flows", DISPLACEMENTS,
        applies=taking("displacement"), place="base", keyword="displacement", refused=True
    )  # fmt: skip
    metric: str = choice(
        "Distances",
        "Along what distances are measured, and with them sizes", METRICS,
        DEFAULTS["metric"].upper(), applies=taking("metric"), place="base", keyword="metric",
        refused=True
    )  # fmt: skip
    vertex_group: str = name_of(
        "Limit to", "Limits where the bands have an effect", search="vertex_groups", place="mask"
    )
    shape: str = choice("Shape", "Which shape is decomposed", SHAPES, place="shape")
    weld: float = number(
        "Join Within",
        "Corners of open edges this near to one another, and to other open edges, are one. 0 joins "
        "those at exactly the same place", WELD, 0, 10, is_size=True, soft_most=0.1,
        unit="PERCENTAGE", digits=4, place="shape"
    )  # fmt: skip
    into: str = choice("Former Bands", INTO_TEXT, INTO_ANY, argument="")
    leaves_out: bool = switch(
        "Leave Out Broken Faces",
        "Faces with a vertex that has no finite place take no part. Otherwise the mesh is refused",
        place="shape", argument="leave-out"
    )  # fmt: skip
    bands_as: str = choice("Bands as", "What bands are kept as", BANDS_AS, place="shape")
    heights: bool = switch(
        "Heights",
        "Also write how far each band moves the surface outwards, as attributes for masks and "
        "shading. Inwards is negative", place="shape"
    )  # fmt: skip

    def text(self) -> str:
        """As a text to be kept."""
        return json.dumps(asdict(self))

    @classmethod
    def of_text(cls, text: str) -> Settings:
        """The settings that a text keeps, be it of a version that had fewer or more."""
        known = {field.name for field in fields(cls)}
        kept = {**BEFORE, **json.loads(text)}
        return cls(**{name: value for name, value in kept.items() if name in known})

    @property
    def by(self) -> Method:
        """What is known of the method."""
        return METHODS[self.method]

    @property
    def band_count(self) -> int:
        """How many bands there will be."""
        return self.bands if self.by.has_bands else 1

    @property
    def least_steps(self) -> int:
        """How many steps there will be at least."""
        return 2 * FEWEST_STEPS if self.is_adaptive else self.steps

    @property
    def is_adaptive(self) -> bool:
        """Whether the accuracy decides on the steps."""
        return bool(self.accuracy) and self.by.takes_steps

    @property
    def limbs_kept(self) -> float:
        """How much of limbs its bands leave."""
        return in_force(self).get("keep_limbs", 0.0)

    def complaint(self) -> str | None:
        """What is wrong with the numbers of bands and steps; None if nothing is."""
        return too_few_steps(self.band_count, self.least_steps)

    def arguments(
        self,
        mesh: spectral_tv.Mesh,
        base: NDArray[np.float64] | None,
        area: float | None = None,
    ) -> dict[str, Any]:
        """Keyword arguments of spectral_tv.decompose; ``base`` (V, 3) for M3, if any.

        Sizes are relative to the mesh's own area, or to another one. Raises spectral_tv.MeshError
        if the scales make no sense.
        """
        area = mesh.area if area is None else area
        arguments = {**self.method_arguments(area, base), **keywords(self)}
        if not self.by.takes_steps and self.by.has_bands and not (self.finest or self.largest):
            arguments["steps"] = self.steps
        elif self.by.has_bands:
            steps = FEWEST_STEPS if self.is_adaptive else self.steps
            arguments["times"] = spectral_tv.graded_times(*self.scales(area), steps)
        return arguments

    def method_arguments(
        self, area: float | None, base: NDArray[np.float64] | None
    ) -> dict[str, Any]:
        """Those that name the method and, where the area is known, its base."""
        arguments: dict[str, Any] = {"method": self.by.package}
        if self.by.p is not None:
            arguments["p"] = self.by.p
        if not self.by.takes("base"):
            return arguments
        if base is not None:
            arguments["base"] = base
            return arguments
        if self.own_base() is not None:
            arguments["base"] = self.own_base()
        if self.base_amount and area is not None:
            arguments["base_time"] = area * self.base_amount**2
        return arguments

    def own_base(self) -> Literal["limbs"] | None:
        """What the package calls the base that it makes; None if it needs no name."""
        return "limbs" if self.base == "LIMBS" else None

    def needs(self, *counts: int) -> Needs:
        """What decomposing meshes of so many vertices takes."""
        how = {**self.method_arguments(None, None), **keywords(self), "steps": self.steps}
        found = [spectral_tv.estimate(count, **how) for count in counts]
        return total(found, is_least=self.is_adaptive)

    def scales(self, area: float) -> tuple[float, float]:
        """The times of the finest and of the largest scale on a surface of this area, length²."""
        finest, largest = self.relative_scales()
        return area * finest, area * largest

    def relative_scales(self) -> tuple[float, float]:
        """The same relative to the area."""
        pairs = zip((self.finest, self.largest), self.own_scales(), strict=True)
        # A feature of the size l vanishes at a time of the order of l squared.
        finest, largest = (size**2 or own for size, own in pairs)
        return finest, largest

    def own_scales(self) -> tuple[float, float]:
        """Those of the method, relative to the area."""
        return spectral_tv.default_scales(self.by.package, self.eigenpairs, self.own_base())
