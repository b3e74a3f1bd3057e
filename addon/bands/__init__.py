"""Bands of detail: split off, filtered, exaggerated, kept as shape keys."""

from . import (
    apply_look,
    apply_modifier,
    bake_safe,
    bands,
    bands_panel,
    blur_mask,
    caricature,
    decompose,
    decompose_panel,
    limbs,
    list_operators,
    list_panel,
    live_guard,
    mask_menu,
    mask_operators,
    multires_panel,
    paint_mask,
    properties,
    sculpt_undo,
    set_bands,
    sliders,
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
    sliders,
    take_bands,
    apply_look,
    apply_modifier,
    bake_safe,
    live_guard,
    mask_operators,
    paint_mask,
    blur_mask,
    mask_menu,
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
START = LOADED = (sculpt_undo.start,)
WITHDRAW = (sculpt_undo.stop,)
FORGET = (bands.flows.clear, spectrum.forget, live_guard.forget, sculpt_undo.forget)
