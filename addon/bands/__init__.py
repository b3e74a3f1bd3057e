"""Bands of detail: split off, filtered, exaggerated, kept as shape keys or attributes."""

from spectral_tv.later import modules_of

__getattr__ = modules_of(__name__)

FILES = (
    "properties",
    "decompose",
    "pick_size",
    "take_settings",
    "limbs",
    "set_bands",
    "count",
    "sliders",
    "take_bands",
    "carry_along",
    "refit_armature",
    "show_original",
    "apply_look",
    "apply_modifier",
    "bake_safe",
    "bake_filter",
    "convert",
    "write_heights",
    "live_guard",
    "mask_operators",
    "paint_mask",
    "blur_mask",
    "mask_menu",
    "work_object",
    "write_back",
    "list_operators",
    "list_panel",
    "decompose_panel",
    "multires_panel",
    "bands_panel",
    "frames_panel",
    "caricature",
    "bands",
    "heights",
    "at_once",
)
VERBS = ("Decompose",)
START = LOADED = (
    "sculpt_undo.start",
    "curve_watch.start",
    "attribute_names.start",
    "at_once.start",
)
WITHDRAW = (
    "sculpt_undo.stop",
    "curve_watch.stop",
    "attribute_names.stop",
    "at_once.stop",
)
FORGET = (
    "at_once.forget",
    "curve_watch.forget",
    "bands.flows.clear",
    "spectrum.forget",
    "live_guard.forget",
    "sculpt_undo.forget",
    "remarks.forget",
    "pick_size.end",
)
