"""The properties of a decomposition, shared by the sidebar and the operator."""

import inspect
from dataclasses import asdict
from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    StringProperty,
)

from ..scene.records import record_of
from .filtering import SidebarFilter
from .gains import usual_band
from .settings import BASES, METHOD_ITEMS, METHODS, METRICS, SHAPES, STEPLESS, WELD, Settings

DEFAULT_BANDS = Settings.bands


def copy_choices(
    kind: type, source: bpy.types.PropertyGroup, target: bpy.types.OperatorProperties
) -> None:
    """Give ``target`` the properties that ``kind``, a class of both, and its bases declare."""
    for cls in kind.__mro__:
        for name in inspect.get_annotations(cls):
            setattr(target, name, getattr(source, name))


class DecompositionProperties:
    """What the user chooses; sizes are percentages of the object's size (√ of its area)."""

    method: EnumProperty(
        name="Method", description="What the bands split off", items=METHOD_ITEMS, default="M1"
    )
    bands: IntProperty(
        name="Bands",
        description="Number of bands, from the finest detail to the largest",
        default=DEFAULT_BANDS,
        min=1,
        max=32,
    )
    steps: IntProperty(
        name="Steps",
        description="Number of time steps of the flow. More steps separate scales more sharply "
        "and take longer",
        default=32,
        min=2,
        soft_max=128,
        max=1000,
    )
    use_accuracy: BoolProperty(
        name="Steps by Accuracy",
        description="Take as many steps as the accuracy needs. The first flows, which tell how "
        "many, take time too",
    )
    accuracy: FloatProperty(
        name="Error",
        description="How far the bands may be from those of the finest steps, relative to their "
        "size: 10% is hardly seen",
        subtype="PERCENTAGE",
        default=5,
        min=0.5,
        max=50,
        precision=1,
    )
    eigenpairs: IntProperty(
        name="Eigenfunctions",
        description="Number of eigenfunctions, the coarsest. More of them hold finer detail; the "
        "time grows with the square of their number",
        default=300,
        min=2,
        soft_max=1000,
        max=10000,
    )
    use_scales: BoolProperty(
        name="Custom Scales", description="Choose the range of sizes that the bands cover"
    )
    finest: FloatProperty(
        name="Finest",
        description="Size of the finest detail to tell apart, relative to the object's size; 0 is "
        "what suits the method",
        subtype="PERCENTAGE",
        default=0,
        min=0,
        max=50,
        precision=2,
    )
    largest: FloatProperty(
        name="Largest",
        description="Size of the largest features that bands hold, relative to the object's "
        "size. What is larger stays in the low-pass. 0 is what suits the method",
        subtype="PERCENTAGE",
        default=0,
        min=0,
        max=100,
        precision=2,
    )
    base: EnumProperty(
        name="Base",
        description="The smooth shape from which detail is measured",
        items=BASES,
        default="FLOW",
    )
    use_base_amount: BoolProperty(
        name="Custom Amount", description="Choose how much the base is smoothed"
    )
    base_amount: FloatProperty(
        name="Smoothing",
        description="Size of the features that vanish from the base, relative to the object's "
        "size; 0 is what suits the method",
        subtype="PERCENTAGE",
        default=0,
        min=0,
        max=50,
        precision=1,
    )
    base_key: StringProperty(name="Shape Key", description="The shape key that is the base")
    metric: EnumProperty(
        name="Distances",
        description="Along what distances are measured, and with them sizes",
        items=METRICS,
        default="SURFACE",
    )
    vertex_group: StringProperty(
        name="Vertex Group", description="Limits where the bands have an effect"
    )
    shape: EnumProperty(
        name="Shape", description="Which shape is decomposed", items=SHAPES, default="SHOWN"
    )
    weld: FloatProperty(
        name="Join Within",
        description="Corners of open edges this near to one another, and to other open edges, are "
        "one, relative to the object's size. 0 joins those at exactly the same place",
        subtype="PERCENTAGE",
        default=WELD,
        min=0,
        soft_max=0.1,
        max=10,
        precision=4,
    )
    leaves_out: BoolProperty(
        name="Leave Out Broken Faces",
        description="Faces with a vertex that has no finite place take no part. Otherwise the mesh "
        "is refused",
    )

    def settings(self) -> Settings:
        """The properties as they are."""
        return Settings(
            method=self.method,
            bands=self.bands,
            steps=self.steps,
            accuracy=self.accuracy / 100 if self.use_accuracy else 0.0,
            finest=self.finest / 100 if self.use_scales else 0.0,
            largest=self.largest / 100 if self.use_scales else 0.0,
            eigenpairs=self.eigenpairs,
            base=self.base,
            base_amount=self.base_amount / 100 if self.use_base_amount else 0.0,
            base_key=self.base_key,
            metric=self.metric,
            vertex_group=self.vertex_group,
            shape=self.shape,
            weld=self.weld,
            leaves_out=self.leaves_out,
        )


def fill(choices: DecompositionProperties, settings: Settings) -> None:
    """Give the properties of an operator what ``settings`` say."""
    for name, value in asdict(settings).items():
        if name not in ("accuracy", "finest", "largest", "base_amount"):
            setattr(choices, name, value)
    choices.use_accuracy = settings.is_adaptive
    if settings.is_adaptive:
        choices.accuracy = 100 * settings.accuracy
    choices.use_scales = bool(settings.finest or settings.largest)
    choices.finest, choices.largest = 100 * settings.finest, 100 * settings.largest
    choices.use_base_amount = bool(settings.base_amount)
    choices.base_amount = 100 * settings.base_amount


def draw_method(choices: DecompositionProperties, layout: bpy.types.UILayout) -> None:
    """Lay out a method with what it needs."""
    layout.prop(choices, "method")
    if choices.method != "DISPLACEMENT":
        layout.prop(choices, "bands")
        is_adaptive = choices.use_accuracy and choices.method not in STEPLESS
        row = layout.row(align=True)
        row.prop(choices, "accuracy" if is_adaptive else "steps")
        if choices.method not in STEPLESS:
            row.prop(choices, "use_accuracy", text="", icon="DRIVER_DISTANCE")
    if choices.method == "LB":
        layout.prop(choices, "eigenpairs")


def draw_reading(choices: DecompositionProperties, layout: bpy.types.UILayout) -> None:
    """Lay out which shape is decomposed, and what of it is joined or left out."""
    for name in ("shape", "weld", "leaves_out"):
        layout.prop(choices, name)


def shown_size(of: str, switch: str, least: float, **options: Any) -> Any:
    """A property that shows a size as it is in force: the method's own, until another is chosen
    while ``switch`` is on."""

    def get(choices: Any) -> float:
        own = getattr(choices, of) if getattr(choices, switch) else 0.0
        return own or 100 * getattr(choices.settings(), f"own_{of}")

    def choose(choices: Any, value: float) -> None:
        setattr(choices, of, max(value, least))

    return FloatProperty(get=get, set=choose, min=least, subtype="PERCENTAGE", **options)


class SpectralTVScene(DecompositionProperties, bpy.types.PropertyGroup):
    """The choices in the sidebar, kept with the scene."""

    shown_finest: shown_size(
        "finest",
        "use_scales",
        0.01,
        name="Finest",
        description="Size of the finest detail to tell apart, relative to the object's size",
        max=50,
        precision=2,
    )
    shown_largest: shown_size(
        "largest",
        "use_scales",
        0.02,
        name="Largest",
        description="Size of the largest features that bands hold, relative to the object's "
        "size. What is larger stays in the low-pass",
        max=100,
        precision=2,
    )
    shown_base_amount: shown_size(
        "base_amount",
        "use_base_amount",
        0.1,
        name="Smoothing",
        description="Size of the features that vanish from the base, relative to the object's size",
        max=50,
        precision=1,
    )


class SpectralTVFilter(SidebarFilter, bpy.types.PropertyGroup):
    """Which bands the common filters are about."""

    # That of any of them.
    preset = "BAND_PASS"
    amount: FloatProperty(
        name="Exaggerate by",
        description="How much is added to the chosen bands: 1 doubles them",
        default=1,
        soft_min=-1,
        soft_max=4,
    )

    def chosen(self, preset: str) -> tuple[int, int]:
        """The first and the last band that a preset is about; the usual one if none is chosen."""
        if self.own_first or self.own_last:
            return self.first, self.last
        return (usual_band(preset, self.band_count()),) * 2

    def band_count(self) -> int:
        """That of the active object."""
        record = record_of(bpy.context.active_object)
        return DEFAULT_BANDS if record is None else len(record.bands)


class CaricatureProperties:
    """What the user chooses of a caricature."""

    method: EnumProperty(
        name="Method", description="What the bands split off", items=METHODS, default="M3"
    )
    bands: IntProperty(name="Bands", description="Number of bands", default=5, min=2, max=32)
    steps: IntProperty(
        name="Steps",
        description="Number of time steps of the flow. More steps separate scales more sharply "
        "and take longer",
        default=32,
        min=3,
        soft_max=128,
        max=1000,
    )
    first: IntProperty(
        name="From", description="First exaggerated band; 1 is the finest", default=4, min=1
    )
    last: IntProperty(
        name="To", description="Last exaggerated band; 1 is the finest", default=5, min=1
    )
    amount: FloatProperty(
        name="Exaggerate by",
        description="How much is added to these bands: 1 doubles them",
        default=1,
        soft_min=-1,
        soft_max=4,
    )
    smooth: IntProperty(
        name="Smooth",
        description="So many of the finest bands are removed; 0 keeps the skin",
        default=1,
        min=0,
    )


class SpectralTVCaricature(CaricatureProperties, bpy.types.PropertyGroup):
    """The choices in the sidebar, kept with the scene."""


CLASSES = (
    SpectralTVScene,
    SpectralTVFilter,
    SpectralTVCaricature,
)
