"""The operator that splits an image into bands or filters it."""

import bpy
import spectral_tv
from bpy.props import StringProperty
from spectral_tv.images import bands, flows
from spectral_tv.refusal import Refusal

from ..bands import filter_curve
from ..job.operator import JobOperator
from . import results, sources
from .properties import ImageChoices


class SPECTRAL_TV_OT_filter_image(JobOperator, ImageChoices, bpy.types.Operator):
    """Filter the image, or split it into bands. Writes new images; running again replaces them"""

    bl_idname = "spectral_tv.filter_image"
    bl_label = "Filter Image"
    working = "Flowing"

    image: StringProperty(
        name="Image", description="Name of the image; the one in the Image Editor if left empty",
        options={"SKIP_SAVE"}
    )  # fmt: skip

    @classmethod
    def subject(cls, context: bpy.types.Context) -> bpy.types.Image | None:
        image = getattr(context, "edit_image", None)
        return image if image is None else results.source_of(image) or image

    unusable = staticmethod(sources.refusal)
    state = staticmethod(sources.state_of)

    @staticmethod
    def find(name: str) -> bpy.types.Image | None:
        return bpy.data.images.get(name)

    @staticmethod
    def shared(_image: bpy.types.Image) -> str:
        return ""

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        subject = cls.subject(context)
        # Without an editor it is the operator's own property that names the image.
        return None if subject is None else sources.refusal(subject)

    def chosen(self, context: bpy.types.Context) -> bpy.types.Image:
        image = bpy.data.images.get(self.image) if self.image else self.subject(context)
        if image is None and self.image:
            raise Refusal(f"there is no image {self.image!r}")
        reason = sources.refusal(image)
        if reason is not None:
            raise Refusal(reason)
        return image

    def prepare(self, image: bpy.types.Image) -> "bands.Prepared":
        return bands.prepare(sources.read(image), self.settings(), filter_curve.current())

    def recall(self, prepared: "bands.Prepared") -> "flows.Still | None":
        return flows.STILL if prepared.request.is_still else None

    def start(self, prepared: "bands.Prepared") -> spectral_tv.Job:
        return prepared.request.start()

    def write(
        self,
        image: bpy.types.Image,
        prepared: "bands.Prepared",
        result: "spectral_tv.Flow | flows.Still",
    ) -> str:
        names = results.write(image, prepared, result)
        return f"written as {', '.join(map(repr, names))}"
