"""What holds and moves an object in a deformation: kept in the file, on the object."""

import bpy
from bpy.props import (
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)
from mathutils import Matrix

from ..scene.objects import Refusal

KINDS = (
    ("PIN", "Pin", "The vertices of the group stay where they are", "PINNED", 0),
    ("OBJECT", "Handle", "The vertices follow an object or a bone", "EMPTY_ARROWS", 1),
    ("KEY", "Shape Key", "The vertices go where a shape key has them", "SHAPEKEY_DATA", 2),
)
ALGORITHMS = (
    ("CONVEX", "Total Variation", "Rigid pieces; narrow places take all of the stretch"),
    ("PAPER", "Reweighted", "The same by another route, slower and less exact; for comparison"),
    ("HARMONIC", "Harmonic", "Stretches everything a little; for comparison"),
    ("BIHARMONIC", "Biharmonic", "Stretches everything smoothly; for comparison"),
    ("ARAP", "As Rigid as Possible", "Bends and turns everything a little; for comparison"),
)


def _followed_changed(constraint: "SpectralTVConstraint", _context: bpy.types.Context) -> None:
    constraint.set_rest()


class SpectralTVConstraint(bpy.types.PropertyGroup):
    """A vertex group, and where its vertices go."""

    vertex_group: StringProperty(
        name="Vertex Group",
        description="The vertices. Those with a weight below 1 are pulled there like by springs",
    )
    kind: EnumProperty(name="Kind", description="Where the vertices go", items=KINDS)
    target: PointerProperty(
        type=bpy.types.Object,
        name="Object",
        description="The object that the vertices follow, from where it is now",
        update=_followed_changed,
    )
    bone: StringProperty(
        name="Bone",
        description="The bone that the vertices follow, from where it is now",
        update=_followed_changed,
    )
    shape_key: StringProperty(
        name="Shape Key", description="The shape key that says where the vertices go"
    )
    rest: FloatVectorProperty(
        name="Rest", size=16, description="The mesh object as its handle sees it at rest"
    )

    def set_rest(self) -> None:
        """Take the present places of the handle and the mesh object for those of rest."""
        matrix = self._followed()
        if matrix is not None:
            seen = matrix.inverted_safe() @ self.id_data.matrix_world
            self.rest = [value for row in seen for value in row]

    def motion(self) -> Matrix:
        """What the handle does to points of the mesh object since rest, in object space.

        Raises Refusal if there is no handle.
        """
        matrix = self._followed()
        if matrix is None:
            thing = f"bone {self.bone!r}" if self.target is not None and self.bone else "object"
            raise Refusal(f"the {thing} that moves {self.vertex_group!r} is missing")
        rest = Matrix([self.rest[4 * row : 4 * row + 4] for row in range(4)])
        return self.id_data.matrix_world.inverted_safe() @ matrix @ rest

    def _followed(self) -> Matrix | None:
        """World matrix of the object or bone to follow."""
        if self.target is None:
            return None
        if self.target.type != "ARMATURE" or not self.bone:
            return self.target.matrix_world
        bone = self.target.pose.bones.get(self.bone)
        return None if bone is None else self.target.matrix_world @ bone.matrix


class SpectralTVBakedKey(bpy.types.PropertyGroup):
    """A shape key of one frame; its name is the key's."""


class DeformationProperties:
    """How the unconstrained vertices follow."""

    algorithm: EnumProperty(
        name="Algorithm", description="How the others follow", items=ALGORITHMS, default="CONVEX"
    )
    softness: FloatProperty(
        name="Softness",
        description="Width of the stretched zone, relative to the object's size. At 0 a narrow "
        "place stretches within a ring of faces",
        subtype="PERCENTAGE",
        default=5,
        min=0,
        soft_max=30,
        max=100,
        precision=1,
    )


class SpectralTVDeformation(DeformationProperties, bpy.types.PropertyGroup):
    """The constraints of an object, and the shape key they lead to."""

    constraints: CollectionProperty(type=SpectralTVConstraint)
    active: IntProperty(name="Constraint", description="The chosen constraint")
    key: StringProperty(name="Result", description="The shape key that holds the deformation")
    digest: StringProperty(name="Digest", description="Of the shape key's coordinates")
    bake_step: IntProperty(
        name="Step", description="Frames from one baked shape key to the next", default=1, min=1
    )
    baked: CollectionProperty(type=SpectralTVBakedKey)


CLASSES = (SpectralTVConstraint, SpectralTVBakedKey, SpectralTVDeformation)


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


def chosen(obj: bpy.types.Object) -> SpectralTVConstraint | None:
    """The constraint chosen in the list, if there is one."""
    deformation = deformation_of(obj)
    if 0 <= deformation.active < len(deformation.constraints):
        return deformation.constraints[deformation.active]
    return None


def register() -> None:
    """Register the properties, on every object."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.spectral_tv = PointerProperty(type=SpectralTVDeformation)


def unregister() -> None:
    """Unregister the properties; files keep what they hold."""
    del bpy.types.Object.spectral_tv
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
