"""Bands of detail: split off, filtered, exaggerated, kept as shape keys."""

from . import (
    apply_look,
    apply_modifier,
    bake_safe,
    bands,
    bands_panel,
    caricature,
    decompose,
    decompose_panel,
    limbs,
    list_operators,
    list_panel,
    live_guard,
    multires_panel,
    properties,
    set_bands,
    spectrum,
    take_bands,
    verb,
    work_object,
    write_back,
)

FILES = (
    properties,
    decompose,
    limbs,
    set_bands,
    take_bands,
    apply_look,
    apply_modifier,
    bake_safe,
    live_guard,
    work_object,
    write_back,
    list_operators,
    list_panel,
    decompose_panel,
    multires_panel,
    bands_panel,
    caricature,
)
VERBS = (verb.Decompose,)
FORGET = (bands.flows.clear, spectrum.forget, live_guard.forget)
