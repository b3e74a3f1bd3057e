"""What to decompose by, in the terms of the user: sizes are relative to the object's."""

import json
import math
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np
import spectral_tv

METHODS = (
    ("M1", "Shape Detail", "Surface detail of every size, the body undistorted (M1, shape TV)"),
    ("M2", "Limbs and Head", "Limbs, head, ears, tail (M2, conformalized 3-Laplace)"),
    ("M3", "Edge-Keeping Detail", "Detail with crisp edges: plates, folds (M3, directional TV)"),
)
COMPARISONS = (
    ("NAIVE", "Per Axis", "Each axis alone, which squares the shape along its axes"),
    ("HEAT", "Heat", "Linear diffusion, which blurs edges"),
    (
        "LB",
        "Eigenfunctions",
        "Waves on the surface, from fine to coarse (Laplace–Beltrami eigenfunctions). The first "
        "band is what they do not hold",
    ),
    (
        "DISPLACEMENT",
        "Displacement",
        "All detail as one band: the displacement from the smoothed shape (Cignoni et al. 2005)",
    ),
    ("M2_P2", "M2 with P = 2", "Conformalized mean curvature flow, of which M2 is made"),
    ("M2_P1", "M2 with P = 1", "The conformalized 1-Laplace"),
)
# As the items of a menu, comparison methods apart.
METHOD_ITEMS = (
    ("", "Methods", ""),
    *METHODS,
    ("", "For Comparison", ""),
    *COMPARISONS,
)
BASES = (
    ("FLOW", "Smoothed Shape", "The object itself, smoothed until its limbs are gone"),
    ("FLAT", "Flat", "The object flattened along its local Z axis: for reliefs and terrain"),
    ("KEY", "Shape Key", "One of the object's shape keys"),
)
# Where an accuracy is asked for: steps of the first flow. The next has twice as many.
FEWEST_STEPS = 12
# Methods that measure from a base, and those that take no time steps.
WITH_BASE = ("M3", "DISPLACEMENT")
STEPLESS = ("LB", "DISPLACEMENT")
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
        "All that is seen, in a new object without modifiers; this one is hidden",
    ),
)
# Corners of open edges that are this near are meant to be one: percent of the object's size. It is
# what rounding leaves of coordinates with six digits.
WELD = 1e-3


@dataclass(frozen=True)
class Settings:
    """Arguments of a decomposition.

    Sizes are lengths relative to the square root of the surface area; 0 stands for what suits
    the method. An accuracy, the relative error of the bands, takes as many steps as it needs; 0
    takes ``steps``. ``weld`` is a percentage.
    """

    method: str = "M1"
    bands: int = 5
    steps: int = 32
    accuracy: float = 0.0
    finest: float = 0.0
    largest: float = 0.0
    eigenpairs: int = 300
    base: str = "FLOW"
    base_amount: float = 0.0
    base_key: str = ""
    metric: str = "SURFACE"
    vertex_group: str = ""
    shape: str = "SHOWN"
    weld: float = WELD
    leaves_out: bool = False

    def text(self) -> str:
        """As a text to be kept."""
        return json.dumps(asdict(self))

    @classmethod
    def of_text(cls, text: str) -> "Settings":
        """The settings that a text keeps, be it of a version that had fewer or more."""
        known = {field.name for field in fields(cls)}
        return cls(**{name: value for name, value in json.loads(text).items() if name in known})

    @property
    def band_count(self) -> int:
        """How many bands there will be."""
        return 1 if self.method == "DISPLACEMENT" else self.bands

    @property
    def least_steps(self) -> int:
        """How many steps there will be at least."""
        return 2 * FEWEST_STEPS if self.is_adaptive else self.steps

    @property
    def is_adaptive(self) -> bool:
        """Whether the accuracy decides on the steps."""
        return bool(self.accuracy) and self.method not in STEPLESS

    def arguments(self, mesh: spectral_tv.Mesh, base: np.ndarray | None) -> dict[str, Any]:
        """Keyword arguments of spectral_tv.decompose; ``base`` (V, 3) for M3, if any.

        Raises spectral_tv.MeshError if the scales make no sense.
        """
        arguments = self.method_arguments(mesh, base)
        if self.method == "M3":
            arguments["metric"] = self.metric.lower()
        if self.method == "LB":
            arguments["eigenpairs"] = self.eigenpairs
        if self.method == "LB" and not (self.finest or self.largest):
            arguments["steps"] = self.steps
        elif self.method != "DISPLACEMENT":
            steps = FEWEST_STEPS if self.is_adaptive else self.steps
            arguments["times"] = spectral_tv.graded_times(*self.scales(mesh), steps)
        if self.is_adaptive:
            arguments["accuracy"] = self.accuracy
        return arguments

    def method_arguments(
        self, mesh: spectral_tv.Mesh | None, base: np.ndarray | None
    ) -> dict[str, Any]:
        """Those that name the method and, where there is a mesh, its base."""
        method, _, p = self.method.lower().partition("_p")
        arguments: dict[str, Any] = {"method": method}
        if p:
            arguments["p"] = int(p)
        if self.method in WITH_BASE and base is not None:
            arguments["base"] = base
        elif self.method in WITH_BASE and self.base_amount and mesh is not None:
            arguments["base_time"] = mesh.area * self.base_amount**2
        return arguments

    def scales(self, mesh: spectral_tv.Mesh) -> tuple[float, float]:
        """The times of the finest and of the largest scale, length²."""
        pairs = zip((self.finest, self.largest), self._own_scales(), strict=True)
        # A feature of the size l vanishes at a time of the order of l squared.
        finest, largest = (mesh.area * (size**2 or own) for size, own in pairs)
        return finest, largest

    @property
    def own_finest(self) -> float:
        """What a finest size of 0 stands for."""
        return math.sqrt(self._own_scales()[0])

    @property
    def own_largest(self) -> float:
        """What a largest size of 0 stands for."""
        return math.sqrt(self._own_scales()[1])

    @property
    def own_base_amount(self) -> float:
        """What a base amount of 0 stands for."""
        return math.sqrt(spectral_tv.default_base_time())

    def _own_scales(self) -> tuple[float, float]:
        """Those of the method, relative to the area."""
        method = self.method.lower().partition("_p")[0]
        return spectral_tv.default_scales(method, self.eigenpairs)


def key_label(method: str) -> str:
    """What the names of a method's shape keys begin with."""
    return method if len(method) == 2 else method.replace("_", " ").title()
