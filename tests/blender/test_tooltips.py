"""Everything in the interface says what it is."""

from __future__ import annotations

import bpy


def test_everything_in_the_interface_has_a_tooltip():
    for name in dir(bpy.ops.spectral_tv):
        rna = getattr(bpy.ops.spectral_tv, name).get_rna_type()
        assert len(rna.description) > 10, name
        for prop in rna.properties:
            if prop.identifier != "rna_type":
                assert prop.description or prop.identifier in ("method", "preset", "bands"), (
                    f"{name}.{prop.identifier}"
                )
