"""The operator that tests whether a vertex group is an eigenset."""

import bpy
import spectral_tv
from bpy.props import StringProperty
from spectral_tv.attributes.settings import chosen_elements
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from ..job.operator import JobOperator
from ..options.properties import choices_of
from ..scene import mix
from ..scene.surface import Surface
from . import outputs, sources
from .settings import EigensetSettings

SUPERSET = "Superset"


@dataclass(frozen=True)
class Prepared:
    """A vertex group, the surface it is on, and which vertices of that are in it."""

    source: "sources.Source"
    surface: Surface
    members: "np.ndarray"
    elements: str


EigensetChoices = choices_of(EigensetSettings)


class SPECTRAL_TV_OT_test_eigenset(JobOperator, EigensetChoices, bpy.types.Operator):
    """Test whether a vertex group fades as a whole and in a straight line under Total Variation.
    If a larger set with a smaller boundary is found, it is written as a vertex group"""

    bl_idname = "spectral_tv.test_eigenset"
    bl_label = "Test Eigenset"
    working = "Testing a vertex group of"

    group: StringProperty(
        name="Vertex Group",
        description="The set: vertices with a weight of at least 0.5. The active group if empty",
    )

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        source, surface = sources.read(obj, "GROUP", self.group), Surface.read(obj, mix.shown(obj))
        members = surface.merge(source.values)[:, 0] >= 0.5
        elements = chosen_elements(self.elements, members.astype(float))
        return Prepared(source, surface, members, elements)

    def start(self, prepared: Prepared) -> spectral_tv.Job:
        return spectral_tv.start_eigenset_test(
            prepared.surface.mesh, prepared.members, elements=prepared.elements
        )

    def write(
        self, obj: bpy.types.Object, prepared: Prepared, result: "spectral_tv.EigensetTest"
    ) -> str:
        text = verdict(prepared.source.name, result)
        if not result.minimal_perimeter:
            superset = prepared.surface.to_vertices(result.superset)
            (name,) = outputs.write(obj, prepared.source, {SUPERSET: superset[:, np.newaxis]})
            text += f", {name!r}"
        return f"{text}; tested on {prepared.elements}"


def verdict(name: str, test: "spectral_tv.EigensetTest") -> str:
    """What a test found, in words."""
    straight = "in a straight line" if test.straightness >= 0.999 else "not in a straight line"
    text = (
        f"{name!r} is {'an' if test.is_eigenset else 'no'} eigenset: it fades at the rate "
        f"{test.rate:.4g} {straight} (R² {test.straightness:.4f}), "
        f"{'as a whole' if test.spread <= 0.2 else 'and not as a whole'}; perimeter / area is "
        f"{test.perimeter:.4g} / {test.area:.4g} = {test.eigenvalue:.4g}"
    )
    if abs(test.rate / test.eigenvalue - 1) > 0.15:
        text += ", which is not that rate"
    text += "; "
    if test.minimal_perimeter:
        return text + "no larger set that was tried has a smaller perimeter"
    less = f"{1 - test.perimeter_ratio:.0%} less perimeter"
    return text + f"a larger set has {less} in relation to the area around it"
