"""What holds and moves an object in a deformation: kept in the file, on the object."""

from contextlib import suppress

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)
from spectral_tv.deformation.settings import Settings
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..options.properties import choices_of
from ..scene.fingerprints import Fingerprint
from ..scene.places import Followed, is_in_a_scene, kept_up, matrix_of

KINDS = (
    ("PIN", "Pin", "The vertices of the group stay where they are", "PINNED", 0),
    ("OBJECT", "Handle", "The vertices follow an object or a bone", "EMPTY_ARROWS", 1),
    ("KEY", "Shape Key", "The vertices go where a shape key has them", "SHAPEKEY_DATA", 2),
)
# The button that makes constraints of what is clicked on, and what to do with it.
HOLD_AND_PULL = "Hold & Pull"
FIRST_STEPS = f"press {HOLD_AND_PULL}, then click what stays and what moves"
# Beyond this, relative to its longest axis, the shortest axis of a handle is none.
FLAT = 1e-4


def _changed(constraint: "SpectralTVConstraint", _context: bpy.types.Context) -> None:
    """Give a constraint its identifier; scripts add some too."""
    if constraint.uid == 0:
        deformation = deformation_of(constraint.id_data)
        deformation.last_uid += 1
        constraint.uid = deformation.last_uid
        # Written down, so that files tell it from one that was never chosen: see `versions`.
        deformation.algorithm = deformation.algorithm


def _followed_changed(constraint: "SpectralTVConstraint", context: bpy.types.Context) -> None:
    _changed(constraint, context)
    constraint.rest = [0.0] * 16
    if constraint.follows_bone and not constraint.is_property_set("turns"):
        constraint.turns = True
    with suppress(Refusal):  # told when it is used; what is chosen next may be right
        constraint.set_rest()


def _can_be_followed(constraint: "SpectralTVConstraint", obj: bpy.types.Object) -> bool:
    return obj != constraint.id_data


class SpectralTVConstraint(bpy.types.PropertyGroup):
    """A vertex group, and where its vertices go."""

    uid: IntProperty(
        name="Identifier", description="Stays while constraints come and go", options={"HIDDEN"}
    )
    vertex_group: StringProperty(
        name="Vertex Group",
        description="The vertices. Those with a weight below 1 are pulled there like by springs",
        update=_changed,
    )
    kind: EnumProperty(
        name="Kind", description="Where the vertices go", items=KINDS, update=_changed
    )
    target: PointerProperty(
        type=bpy.types.Object, name="Object",
        description="The object that the vertices follow, from where it is now",
        update=_followed_changed, poll=_can_be_followed
    )  # fmt: skip
    bone: StringProperty(
        name="Bone", description="The bone that the vertices follow, from where it is now",
        update=_followed_changed
    )  # fmt: skip
    turns: BoolProperty(
        name="Turn with Handle",
        description="Pose: the vertices turn and grow as the handle does. If off, they are free to "
        "turn: the handle moves their middle, and they turn as suits the rest. On at first for "
        "bones"
    )  # fmt: skip
    shape_key: StringProperty(
        name="Shape Key", description="The shape key that says where the vertices go"
    )
    rest: FloatVectorProperty(
        name="Rest", size=16, description="The mesh object as its handle sees it at rest"
    )

    @property
    def follows_bone(self) -> bool:
        """Whether a bone moves it."""
        return bool(self.bone) and self.target is not None and self.target.type == "ARMATURE"

    @property
    def is_free(self) -> bool:
        """Whether Pose turns its vertices as suits the rest."""
        return self.kind == "OBJECT" and not self.turns

    @property
    def followed(self) -> Followed:
        """The object and the bone to follow; raises Refusal if there is none, or it was deleted."""
        if self.target is None:
            raise Refusal(f"the object that moves {self.vertex_group!r} is missing")
        if not is_in_a_scene(self.target):
            raise Refusal(f"{self._mover} was deleted, or is in no scene")
        return self.target, self.bone if self.target.type == "ARMATURE" else ""

    def set_rest(self) -> None:
        """Take the present places of the handle and the mesh object for those of rest.

        Raises Refusal if there is no handle, or it is flat.
        """
        with kept_up([self.followed, (self.id_data, "")]):
            graph = bpy.context.evaluated_depsgraph_get()
            handle, seen = self._handle(graph), matrix_of(self.id_data, "", graph)
        if not np.isfinite(handle).all() or not np.linalg.cond(handle[:3, :3]) < 1 / FLAT:
            raise Refusal(f"{self._mover} is flat: its scale is zero along an axis")
        self.rest = (np.linalg.inv(handle) @ seen).ravel()

    def motion(self, graph: bpy.types.Depsgraph | None) -> "np.ndarray":
        """What the handle does to points of the mesh object since rest, (4, 4) in object space.

        ``graph`` is as in scene.places.matrix_of. Raises Refusal if there is no handle, or its
        rest could not be taken.
        """
        handle = self._handle(graph)
        if not np.isfinite(handle).all():
            raise Refusal(f"the place of {self._mover} is not finite")
        rest = np.reshape(self.rest, (4, 4)).astype(np.float64)
        if not rest.any():
            raise Refusal(f"{self._mover} was flat or missing when it was chosen; press Set Rest")
        try:
            from_world = np.linalg.inv(matrix_of(self.id_data, "", graph))
        except np.linalg.LinAlgError as error:
            raise Refusal("its scale is zero along an axis") from error
        return from_world @ handle @ rest

    @property
    def _mover(self) -> str:
        return f"the object {self.target.name!r} that moves {self.vertex_group!r}"

    def _handle(self, graph: bpy.types.Depsgraph | None) -> "np.ndarray":
        """World matrix of what is followed."""
        obj, bone = self.followed
        matrix = matrix_of(obj, bone, graph)
        if matrix is None:
            raise Refusal(f"the bone {bone!r} that moves {self.vertex_group!r} is missing")
        return matrix


class SpectralTVBakedKey(Fingerprint, bpy.types.PropertyGroup):
    """A shape key of one frame."""


DeformationChoices = choices_of(Settings, "follow")


class SpectralTVDeformation(Fingerprint, DeformationChoices, bpy.types.PropertyGroup):
    """The constraints of an object, and the fingerprint of the shape key they lead to."""

    owner = bpy.types.Object, "spectral_tv"

    constraints: CollectionProperty(type=SpectralTVConstraint)
    active: IntProperty(name="Constraint", description="The chosen constraint")
    shows_regions: BoolProperty(
        name="Show Regions", default=True,
        description="Draw over the mesh what is held and what is pulled, in Object Mode"
    )  # fmt: skip
    vertex_count: IntProperty(
        name="Vertices", description="Of the mesh when a shape key was written", options={"HIDDEN"}
    )
    last_uid: IntProperty(
        name="Last Identifier", description="The last that a constraint got", options={"HIDDEN"}
    )
    bake_step: IntProperty(
        name="Step",
        description="Frames from one baked shape key to the next; the last frame always has one",
        default=1, min=1
    )  # fmt: skip
    baked: CollectionProperty(type=SpectralTVBakedKey)
    rig: StringProperty(
        name="Rig", description="Of an armature that was written: what was", options={"HIDDEN"}
    )


def deformation_of(obj: bpy.types.Object) -> SpectralTVDeformation:
    """How ``obj`` is deformed."""
    return obj.spectral_tv


def add(obj: bpy.types.Object, vertex_group: str, kind: str = "PIN") -> SpectralTVConstraint:
    """Add a constraint, and make it the chosen one."""
    deformation = deformation_of(obj)
    constraint = deformation.constraints.add()
    constraint.vertex_group, constraint.kind = vertex_group, kind
    deformation.active = len(deformation.constraints) - 1
    return constraint


def identified(obj: bpy.types.Object) -> dict[int, SpectralTVConstraint]:
    """The constraints of ``obj`` by their identifiers; those of old files by their places."""
    constraints = deformation_of(obj).constraints
    return {each.uid or -1 - place: each for place, each in enumerate(constraints)}


def sharing(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """Other objects of the same mesh that have constraints of their own."""
    if obj.data.users < 2:
        return []
    others = [each for each in bpy.data.objects if each.data == obj.data and each != obj]
    return [each for each in others if deformation_of(each).constraints and is_in_a_scene(each)]


def followed_by(obj: bpy.types.Object) -> list[Followed]:
    """All that moves constrained vertices of ``obj``, and itself; raises Refusal as `followed`."""
    handles = [each for each in deformation_of(obj).constraints if each.kind == "OBJECT"]
    return [(obj, ""), *(each.followed for each in handles)]


def chosen(obj: bpy.types.Object) -> SpectralTVConstraint | None:
    """The constraint chosen in the list, if there is one."""
    deformation = deformation_of(obj)
    if 0 <= deformation.active < len(deformation.constraints):
        return deformation.constraints[deformation.active]
    return None
