"""The top level of a Multiresolution modifier: read at rest, and given another shape.

A helper object that shares the mesh shows the top level alone, so that no setting of the object
itself has to be changed for a while.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from .applied import mesh_of
from .contents import topology_digest
from .coordinates import points, seen_coordinates
from .temporary import Temporary

# So far, relative to the size, may a vertex be from where it is put: single precision, and a change
# to tangent space and back.
EXACT = 1e-5


@dataclass(frozen=True)
class Given:
    """What became of a shape that was given: where the vertices were ``before``, (V, 3), and are
    ``after``; and how far one is from its place at most, relative to the size.
    """

    before: np.ndarray
    after: np.ndarray
    farthest: float


def modifier_of(obj: bpy.types.Object) -> bpy.types.MultiresModifier | None:
    """The first Multiresolution modifier of ``obj``, or None."""
    return next((each for each in obj.modifiers if each.type == "MULTIRES"), None)


def levels_refusal(obj: bpy.types.Object) -> str | None:
    """Why ``obj`` has no top level that can be worked on, in a sentence; None if it has one."""
    if obj.mode != "OBJECT":
        return "Go to Object Mode first"
    found = [each for each in obj.modifiers if each.type == "MULTIRES"]
    if not found:
        return "The object has no Multiresolution modifier"
    if len(found) > 1:
        return "The object has several Multiresolution modifiers; one is needed"
    if found[0].total_levels == 0:
        return "The Multiresolution modifier has no levels; subdivide it first"
    if found[0].is_external:
        return "The levels are kept in another file; pack them into this one first"
    return None


def is_masked(obj: bpy.types.Object) -> bool:
    """Whether something of ``obj``, which has levels, is or was masked in Sculpt Mode."""
    if modifier_of(obj) is None:
        return False
    with bpy.context.temp_override(object=obj, active_object=obj):
        return bpy.ops.mesh.customdata_mask_clear.poll()


def top_count(obj: bpy.types.Object) -> int:
    """How many vertices the top level has, worked out without it."""
    mesh = obj.data
    vertices, edges, corners = len(mesh.vertices), len(mesh.edges), len(mesh.loops)
    faces = len(mesh.polygons)
    for _ in range(modifier_of(obj).total_levels):
        vertices, edges, faces = vertices + edges + faces, 2 * edges + corners, corners
        corners = 4 * faces
    return vertices


def top_mesh(obj: bpy.types.Object) -> bpy.types.Mesh:
    """A new mesh of the top level of ``obj`` at rest: of Basis, and without other modifiers.

    Raises Refusal if there is none.
    """
    _ensure(obj)
    with _resting(obj, obj.data) as probe:
        return mesh_of(probe)


def give(obj: bpy.types.Object, shape: bpy.types.Mesh) -> Given:
    """Have the top level of ``obj`` at rest be the shape of a mesh with the same vertices.

    Raises Refusal if the mesh does not fit or the modifier cannot hold the shape; then nothing was
    changed, as it is tried on a copy first.
    """
    _ensure(obj)
    with Temporary() as now:
        trial = now.made(obj.data.copy())
        with _resting(obj, trial) as probe:
            _ensure_alike(obj, probe, shape)
            before = seen_coordinates(probe)
            _reshape(probe, shape)
            _measure(probe, shape)
    with _resting(obj, obj.data) as probe:
        _reshape(probe, shape)
        after, farthest = _measure(probe, shape)
    obj.data.update_tag()
    return Given(before, after, farthest)


def _ensure(obj: bpy.types.Object) -> None:
    reason = levels_refusal(obj)
    if reason is not None:
        raise Refusal(reason[0].lower() + reason[1:])


@contextmanager
def _resting(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> Iterator[bpy.types.Object]:
    """Yield an object that shows the top level of ``mesh``, and nothing else that ``obj`` has."""
    scene = bpy.context.scene
    with Temporary() as now:
        now.put(scene.render, "use_simplify", False)  # it lowers the level
        probe = now.made(obj.copy())
        probe.data, probe.parent = mesh, None
        probe.animation_data_clear()
        probe.constraints.clear()
        name = modifier_of(obj).name
        for other in [each for each in probe.modifiers if each.name != name]:
            probe.modifiers.remove(other)
        modifier = probe.modifiers[name]
        modifier.show_viewport, modifier.levels = True, modifier.total_levels
        # Basis, whatever values drivers and keyframes give the keys.
        probe.show_only_shape_key, probe.active_shape_key_index = True, 0
        probe.hide_viewport = False
        scene.collection.objects.link(probe)
        bpy.context.view_layer.update()
        yield probe


def _ensure_alike(obj: bpy.types.Object, probe: bpy.types.Object, shape: bpy.types.Mesh) -> None:
    top = probe.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    counts = [len(each.vertices) for each in (top, shape)]
    if counts[0] != counts[1]:
        raise Refusal(
            f"the top level of {obj.name!r} has {counts[0]} vertices now, but the shape has "
            f"{counts[1]}; levels were added or deleted, or a modifier adds vertices"
        )
    if topology_digest(top) != topology_digest(shape):
        raise Refusal(f"the top level of {obj.name!r} has other faces now than the shape")
    if not np.isfinite(points(shape.vertices)).all():
        raise Refusal("the shape has a vertex without a finite place")


def _reshape(probe: bpy.types.Object, shape: bpy.types.Mesh) -> None:
    with Temporary() as now:
        source = now.made(bpy.data.objects.new("Spectral TV Shape", shape))
        bpy.context.scene.collection.objects.link(source)
        bpy.context.view_layer.update()
        both = [probe, source]
        with bpy.context.temp_override(
            object=probe, active_object=probe, selected_objects=both, selected_editable_objects=both
        ):
            try:
                status = bpy.ops.object.multires_reshape(modifier=modifier_of(probe).name)
            except RuntimeError as error:
                raise Refusal(f"Blender's Reshape refuses it: {error}".strip()) from error
    if status != {"FINISHED"}:
        raise Refusal("Blender's Reshape did nothing")


def _measure(probe: bpy.types.Object, shape: bpy.types.Mesh) -> tuple[np.ndarray, float]:
    """Where ``probe`` shows the vertices, (V, 3), and how far one is from a shape, relative to its
    size; raises Refusal if they are not there.
    """
    found, wanted = seen_coordinates(probe), points(shape.vertices)
    size = float(np.linalg.norm(np.ptp(wanted, axis=0))) or 1.0
    apart = np.linalg.norm(found - wanted, axis=1) / size
    count = int(np.count_nonzero(~(apart <= EXACT)))
    if count:
        raise Refusal(
            f"the levels cannot hold this shape: {count} of {len(apart)} vertices would be up to "
            f"{apart.max():.1g} of the size away from it"
        )
    return found, float(apart.max())
