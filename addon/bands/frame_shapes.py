"""What is seen of an object on many frames without its bands, and what its bands are there."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from typing import TypeAlias

import bpy
from mathutils import Matrix
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..scene import applied
from ..scene.contents import topology_digest
from ..scene.coordinates import points, triangles
from ..scene.frames import kept, visited
from ..scene.keeping import Band
from ..scene.places import is_kept_up
from ..scene.records import bands_of
from ..scene.surface import Reading, Surface
from ..scene.temporary import Temporary
from ..scene.weights import weights_of

# Of each band, how much of it reaches every vertex, (V,); None where all of it does.
Masks: TypeAlias = "tuple[np.ndarray | None, ...]"


@dataclass(frozen=True)
class FrameShape:
    """What is seen on a frame: vertices (V, 3) in object space and triangles (F, 3), the object's
    matrix, and the value of each band with its mask. Frames share what is the same.
    """

    frame: int
    vertices: np.ndarray
    corners: np.ndarray
    topology: str
    matrix: Matrix
    values: tuple[float, ...]
    masks: Masks

    @property
    def has_faces(self) -> bool:
        """Whether there is anything to decompose."""
        return len(self.corners) > 0

    @property
    def area(self) -> float:
        """That of the triangles in the world, length²."""
        matrix = np.array(self.matrix.to_3x3())
        one, two, three = ((self.vertices @ matrix.T)[corner] for corner in self.corners.T)
        return float(np.linalg.norm(np.cross(two - one, three - one), axis=1).sum() / 2)

    def surface(self, reading: Reading) -> Surface:
        """It as a surface in world scale; raises Refusal or spectral_tv.MeshError."""
        shape = self.vertices.astype(np.float64)
        return Surface.read_arrays(shape, self.corners, self.matrix, reading)


def read_frames(
    obj: bpy.types.Object, frames: Sequence[int], progress: Callable[[float], None]
) -> list[FrameShape]:
    """What is seen of ``obj`` on frames without the bands of its active decomposition.

    ``progress`` takes the fraction that was read. Raises Refusal.
    """
    found: list[FrameShape] = []
    is_muted = [band is None or band.mute for band in bands_of(obj)]
    with closing(meshes_of_frames(obj, frames)) as meshes:
        for frame, mesh in meshes:
            found.append(_read(obj, frame, mesh, is_muted, found[-1] if found else None))
            progress(len(found) / len(frames))
    return found


def meshes_of_frames(
    obj: bpy.types.Object, frames: Sequence[int]
) -> Generator[tuple[int, bpy.types.Mesh], None, None]:
    """Each frame with a mesh of what is seen of ``obj`` without its active bands, which is removed
    when the next one is asked for. Raises Refusal."""
    scene = bpy.context.scene
    with kept(scene), _without(bands_of(obj)):
        for frame in visited(scene, frames):
            if not is_kept_up(obj):
                raise Refusal(f"it is hidden on frame {frame}, so Blender does not work it out")
            with Temporary() as now:
                yield frame, now.made(applied.mesh_of(obj))


@contextmanager
def _without(bands: Sequence[Band | None]) -> Iterator[None]:
    with Temporary() as now:
        now.callback(bpy.context.view_layer.update)
        for band in bands:
            if band is not None:
                now.put(band, "mute", True)
        yield


def _read(
    obj: bpy.types.Object,
    frame: int,
    mesh: bpy.types.Mesh,
    is_muted: Sequence[bool],
    before: FrameShape | None,
) -> FrameShape:
    vertices = points(mesh.vertices).astype(np.float32)
    corners, topology = triangles(mesh), topology_digest(mesh)
    bands = bands_of(obj)
    is_same = before is not None and before.topology == topology
    if is_same and np.array_equal(corners, before.corners):
        corners = before.corners
    masks = before.masks if is_same else _masks(obj, bands, mesh)
    pairs = zip(bands, is_muted, strict=True)
    values = tuple(0.0 if is_off else band.value for band, is_off in pairs)
    return FrameShape(frame, vertices, corners, topology, obj.matrix_world.copy(), values, masks)


def _masks(obj: bpy.types.Object, bands: Sequence[Band | None], mesh: bpy.types.Mesh) -> Masks:
    """The masks of bands as the vertices of what is seen have them."""
    names = [band.vertex_group if band is not None else "" for band in bands]
    names = [name if name in obj.vertex_groups else "" for name in names]
    found: dict[str, np.ndarray | None] = {"": None}
    with Temporary() as now:
        seen = now.made(bpy.data.objects.new("Seen", mesh))
        for name in dict.fromkeys(names):
            if name in found:
                continue
            if name in seen.vertex_groups:
                found[name] = weights_of(seen, seen.vertex_groups[name])
            elif len(mesh.vertices) == len(obj.data.vertices):
                found[name] = weights_of(obj, obj.vertex_groups[name])
            else:
                raise Refusal(f"what is seen has no vertex group {name!r}, the mask of a band")
    return tuple(found[name] for name in names)
