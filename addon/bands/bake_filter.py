"""The operator that filters an object on every frame, and keeps the result in a cache."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty
from spectral_tv.bands.settings import Settings
from spectral_tv.dataclass import dataclass
from spectral_tv.files import whole
from spectral_tv.jobs.steps import Steps
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..job.operator import JobOperator
from ..job.progress import cursor_progress
from ..options.properties import RELATIVE
from ..scene import applied
from ..scene.coordinates import points
from ..scene.objects import take_place
from ..scene.records import bands_of, record_of
from . import frame_shapes, point_cache
from .bands import settings_as_taken
from .frame_filter import SCALES, Filtered, note_all, start
from .set_bands import bands_refusal

LABEL = "Filtered"


@dataclass(frozen=True)
class Prepared:
    """What is seen on the frames, the settings of the bands, and the file of the cache."""

    shapes: "list[frame_shapes.FrameShape]"
    settings: Settings
    target: Path

    @property
    def keeps_vertices(self) -> bool:
        """Whether all frames have the same vertices and faces."""
        return len({shape.topology for shape in self.shapes}) == 1


class BakeChoices:
    """What the operator and the panel both ask for."""

    scales: EnumProperty(
        name="Scales",
        description="What sizes of bands are relative to, the same on every frame",
        items=SCALES,
    )
    filepath: StringProperty(
        name="Cache",
        description="The file that keeps the result, an .abc or a .pc2; beside the .blend if none "
        "is named",
        subtype="FILE_PATH",
        options=RELATIVE,
    )


class SPECTRAL_TV_OT_bake_filter(BakeChoices, JobOperator, bpy.types.Operator):
    """Filter what is seen of the object on every frame by the values of its active bands. A new
    object plays the result from a file, and this one is hidden"""

    bl_idname = "spectral_tv.bake_filter"
    bl_label = "Bake Filter over Frames"
    working = "Filtering frames of"

    frame_start: IntProperty(name="Start", description="First frame", default=1)
    frame_end: IntProperty(name="End", description="Last frame", default=40)

    @staticmethod
    def unusable(subject: bpy.types.ID | None) -> str | None:
        """No bands."""
        return bands_refusal(subject)

    @staticmethod
    def shared(_obj: bpy.types.ID) -> str:
        """Other users of the mesh are left alone."""
        return ""

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        if self.frame_end < self.frame_start:
            raise Refusal(f"frame {self.frame_end} comes before frame {self.frame_start}")
        settings = settings_as_taken(record_of(obj))
        if settings.by.takes("base") and settings.base == "KEY":
            raise Refusal("a shape key as the base is not there on every frame")
        target = point_cache.target_of(obj, self.filepath)
        try:
            whole.ensure_writable(target)
        except whole.NotWritten as error:
            raise Refusal(str(error)) from error
        _tell(obj)
        with cursor_progress(bpy.context) as progress:
            shapes = frame_shapes.read_frames(obj, self._frames(), progress)
        prepared = Prepared(shapes, settings, target)
        point_cache.ensure_holds(target, keeps_vertices=prepared.keeps_vertices)
        return prepared

    def start(self, prepared: Prepared) -> Steps[Filtered]:
        return start(prepared.shapes, prepared.settings, self.scales)

    def write(self, obj: bpy.types.Object, prepared: Prepared, result: Filtered) -> str:
        note_all(result)
        pairs = zip(prepared.shapes, result.moves, strict=True)
        shapes = [shape.vertices + move for shape, move in pairs]
        is_over = prepared.target.exists()
        with _in_the_place_of(obj, self._frames()) as new:
            try:
                if prepared.keeps_vertices:
                    point_cache.write_moving(prepared.target, new, shapes, self._frames())
                else:
                    meshes = _meshes(obj, self._frames(), prepared.shapes, shapes)
                    point_cache.write_meshes(prepared.target, new, meshes, self._frames())
            except OSError as error:
                raise Refusal(str(error)) from error
            point_cache.add_cache(new, prepared.target, self._frames())
        if is_over:
            note(f"{prepared.target.name} was written over")
        obj.hide_render = True
        note(f"{new.name!r} plays {prepared.target}; {obj.name!r} is hidden, in renders too")
        take_place(new, obj)
        frames = "1 frame" if len(shapes) == 1 else f"{len(shapes)} frames"
        return f"{frames} filtered"

    def _frames(self) -> range:
        return range(self.frame_start, self.frame_end + 1)


def _tell(obj: bpy.types.Object) -> None:
    """Note what of the bands is not in the filter of frames."""
    record = record_of(obj)
    sculpted = [band.key for band in record.bands if band.is_sculpted]
    if sculpted:
        names = ", ".join(sculpted)
        note(f"{names} were sculpted, which frames are not: their bands are as they split off")
    if record.is_part:
        note("it was decomposed as one with other objects; here it is filtered by itself")
    if not any(band is not None and band.value and not band.mute for band in bands_of(obj)):
        note("all bands are at 0 on this frame, so it is not changed there")


@contextmanager
def _in_the_place_of(obj: bpy.types.Object, frames: range) -> Iterator[bpy.types.Object]:
    """Yield a new object with what is seen of ``obj`` on the first frame; it is gone if the block
    fails."""
    with closing(frame_shapes.meshes_of_frames(obj, frames[:1])) as meshes:
        _, mesh = next(meshes)
        new = applied.object_of(mesh.copy(), obj, LABEL)
    try:
        yield new
    except BaseException:
        bpy.data.meshes.remove(new.data)  # and the object with it
        raise


def _meshes(
    obj: bpy.types.Object,
    frames: range,
    seen: "list[frame_shapes.FrameShape]",
    shapes: "list[np.ndarray]",
) -> list[bpy.types.Mesh]:
    """A mesh of every frame in its shape (V, 3); raises Refusal if what is seen changed since."""
    found: list[bpy.types.Mesh] = []
    try:
        with closing(frame_shapes.meshes_of_frames(obj, frames)) as meshes:
            for (frame, mesh), before, shape in zip(meshes, seen, shapes, strict=True):
                if not np.array_equal(points(mesh.vertices).astype(np.float32), before.vertices):
                    raise Refusal(f"nothing was written, as frame {frame} changed in the meantime")
                copy = mesh.copy()
                found.append(copy)
                copy.vertices.foreach_set("co", shape.ravel())
                copy.update()
    except BaseException:
        bpy.data.batch_remove(found)
        raise
    return found
