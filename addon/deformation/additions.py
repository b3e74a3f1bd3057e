"""What is added to a deformation before it is seen: other shape keys, modifiers."""

from __future__ import annotations

from collections.abc import Collection

import bpy
from spectral_tv.later import np
from spectral_tv.notes import note

from ..scene import mix
from ..scene.coordinates import basis_coordinates
from ..scene.modifiers import passed_over, symmetries
from .results import Known, told

# Modifiers that refine a shape, and leave it as it is else.
REFINING = {"SUBSURF", "MULTIRES", "TRIANGULATE", "EDGE_SPLIT"}
# Of the object's size, what moves a vertex unnoticed.
NOTICED = 1e-3


def note_additions(
    obj: bpy.types.Object, constrained: np.ndarray, replaced: Collection[str] = ()
) -> None:
    """Note what else moves the ``constrained`` vertices of ``obj``, or all that is seen of it.

    Modifiers that are ``replaced``, by their names, will not.
    """
    known = Known.of(obj)
    mine = [known.single, *known.baked, *known.kept]
    others = [] if obj.show_only_shape_key else mix.parts(obj)
    others = [part for part in others if part.key not in mine]
    if others:
        shift = sum(part.displacement(obj) for part in others)[constrained]
        moved = np.linalg.norm(shift, axis=1).max()
        if moved > NOTICED * np.linalg.norm(np.ptp(basis_coordinates(obj.data), axis=0)):
            note(
                f"other shape keys are added, {told([part.key.name for part in others])}: they "
                f"move constrained vertices by up to {moved:.3g}"
            )
    mirrors = [modifier.name for modifier in symmetries(obj)]
    if mirrors:
        note(f"the other half of {told(mirrors)} is held and moved likewise")
    modifiers = [each.name for each in passed_over(obj) if each.type not in REFINING]
    modifiers = [name for name in modifiers if name not in replaced]
    if modifiers:
        note(f"modifiers act on what is deformed, {told(modifiers)}: what is seen is theirs")
