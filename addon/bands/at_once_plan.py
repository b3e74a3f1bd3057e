"""What At Once does after a change of settings: at once, by way of a preview, or not at all."""

import math
from collections.abc import Collection
from dataclasses import replace

import bpy
from spectral_tv.bands.settings import ON_NEW_OBJECT, Settings
from spectral_tv.dataclass import dataclass
from spectral_tv.options.declaring import is_replaced, options_of
from spectral_tv.options.estimates import Needs

from ..scene.decomposition import SpectralTVRecord
from ..scene.objects import refusal
from ..scene.records import record_of, topology_changed
from .bands import parts_of, settings_of
from .set_bands import cut_refusal

# Estimated seconds up to which work is done without a preview, and up to which it is begun at all.
PROMPT, LONGEST = 2.0, 60.0
# Steps of the flow of a preview. Bands and low-pass add up to the shape with any number of them.
PREVIEW_STEPS = 8
# Options that At Once leaves to the bands as they are: those have fields for them.
OF_BANDS = ("bands", "keep_limbs")
# Options that are not of the bands.
NOT_COMPARED = (*OF_BANDS, "into")
# Numbers that differ by less are the same: properties are of single precision.
ROUNDING = 1e-5


@dataclass(frozen=True)
class Stage:
    """A decomposition by these settings, or a mere cut of the present flow."""

    settings: Settings
    is_preview: bool = False
    is_cut: bool = False


@dataclass(frozen=True)
class Plan:
    """What is done one after the other, and what is told in the end; that is empty if all was."""

    stages: tuple[Stage, ...]
    told: str = ""


def options_of_all() -> frozenset[str]:
    """The names of all options."""
    return frozenset(options_of(Settings))


def asked(record: SpectralTVRecord | None, chosen: Settings, changed: Collection[str]) -> Settings:
    """The settings of the bands that replace those of a record, if there is one.

    What is set beside the bands stays, unless the method is another one, or it was changed now.
    """
    chosen = replace(chosen, into="REPLACE_ANY")
    if record is None:
        return chosen
    kept = settings_of(record)
    if "bands" not in changed:
        chosen = replace(chosen, bands=len(record.bands) if kept.by.has_bands else chosen.bands)
    if kept.method == chosen.method:
        chosen = replace(chosen, keep_limbs=kept.limbs_kept)
    return chosen


def differing(record: SpectralTVRecord, chosen: Settings) -> list[str]:
    """The names of options by which bands would be made anew otherwise than a record's were."""
    kept, found = settings_of(record), []
    for name, option in options_of(Settings).items():
        one, other = getattr(kept, name), getattr(chosen, name)
        counts = all(
            option.is_in_force(each) and not is_replaced(each, name) for each in (kept, chosen)
        )
        is_mask = name == "vertex_group" and not other  # it goes over
        is_same = one == other
        if isinstance(one, float) and not is_same:
            is_same = math.isclose(one, other, rel_tol=ROUNDING)
        if counts and not is_same and not is_mask and name not in NOT_COMPARED:
            found.append(name)
    return found


def foreign(
    record: SpectralTVRecord | None, chosen: Settings, changed: Collection[str]
) -> list[str]:
    """The labels of options that differ from those of a record, though nobody changed them here."""
    if record is None:
        return []
    options = options_of(Settings)
    return [options[name].label for name in differing(record, chosen) if name not in changed]


def waiting(
    obj: bpy.types.Object | None, chosen: Settings, changed: Collection[str], is_new: bool
) -> str | None:
    """Why nothing is done, in a sentence for the user; None if something is.

    ``changed`` are the names of the options that were changed for this object, ``is_new`` tells
    whether that may be decomposed for the first time.
    """
    reason = refusal(obj)
    if reason is not None:
        return reason
    record = record_of(obj)
    if obj.mode != "OBJECT":
        return "At Once waits for Object Mode"
    if chosen.shape in ON_NEW_OBJECT:
        return "At Once is not for shapes that make a new object; press the button"
    if record is None:
        return None if is_new else "At Once begins when the object has bands; press the button"
    if topology_changed(obj, record):
        return "Vertices or faces changed since; press the button"
    if record.is_part and len(parts_of(obj)) < 2:
        return f"{record.name} is of several objects; decompose them as one"
    labels = foreign(record, chosen, changed)
    if labels:
        return f"At Once waits, as {record.name} was made with another {', '.join(labels)}"
    return chosen.complaint()


def plan(obj: bpy.types.Object, chosen: Settings, changed: Collection[str]) -> Plan:
    """What is to be done."""
    record = record_of(obj)
    settings = asked(record, chosen, changed)
    if record is not None and not differing(record, settings):
        if settings.band_count == len(record.bands):
            return Plan(())
        if cut_refusal(obj) is None:
            return Plan((Stage(settings, is_cut=True),))
    parts = [obj] if record is None else parts_of(obj)
    count = sum(len(part.data.vertices) for part in parts)
    needs = settings.needs(count)
    if needs.fits and needs.seconds <= PROMPT:
        return Plan((Stage(settings),))
    rest = _rest(settings, needs)
    then = () if rest else (Stage(settings),)
    few = max(PREVIEW_STEPS, settings.band_count + 1)
    preview = replace(settings, steps=few, accuracy=0.0)
    if settings.by.takes_steps and few < settings.least_steps:
        needs = preview.needs(count)
        if needs.fits and needs.seconds <= PROMPT:
            told = f"A preview with {few} steps is shown"
            return Plan((Stage(preview, is_preview=True), *then), rest and f"{told}. {rest}")
    return Plan(then, rest)


def _rest(settings: Settings, needs: Needs) -> str:
    """What is told if the whole of it is left to the button."""
    if needs.fits and needs.seconds <= LONGEST:
        return ""
    whole = "the rest" if settings.is_adaptive else f"all {settings.steps} steps"
    what = whole if settings.by.takes_steps else "that"
    return f"Press the button for {what}. {needs.told() or ''}".strip()
