"""Bands of detail: split off, filtered, exaggerated, kept as shape keys."""

import bpy
from bpy.props import PointerProperty

from . import (
    apply_modifier,
    bands,
    bands_panel,
    caricature,
    decompose,
    decompose_panel,
    properties,
    set_bands,
    spectrum,
    take_bands,
    verb,
)

_FILES = (
    properties,
    decompose,
    set_bands,
    take_bands,
    apply_modifier,
    caricature,
    decompose_panel,
    bands_panel,
)
CLASSES = tuple(cls for file in _FILES for cls in file.CLASSES)
PROPERTIES = (
    (bpy.types.Scene, "spectral_tv", PointerProperty(type=properties.SpectralTVScene)),
    (bpy.types.Scene, "spectral_tv_filter", PointerProperty(type=properties.SpectralTVFilter)),
    (
        bpy.types.Scene,
        "spectral_tv_caricature",
        PointerProperty(type=caricature.SpectralTVCaricature),
    ),
)
VERBS = (verb.Decompose(),)
FORGET = (bands.forget_flows, spectrum.forget)
