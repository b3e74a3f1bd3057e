"""Recipes of one's own, as files among Blender's presets.

A file is JSON, which is read as data. Blender's own presets are Python that is run, so one of a
stranger could do anything.
"""

import math
from collections.abc import Iterator
from dataclasses import asdict, fields, replace
from functools import cache
from pathlib import Path
from typing import Any

import bpy
from spectral_tv.bands.settings import ON_NEW_OBJECT, Settings
from spectral_tv.files import whole
from spectral_tv.later import json
from spectral_tv.notes import listed, note
from spectral_tv.options.declaring import Option, options_of
from spectral_tv.refusal import Refusal

from ..scene import shape_keys
from . import recipes
from .recipe import Recipe

# In Blender's folder of presets.
FOLDER = "spectral_tv/recipes"
EXTENSION = ".json"
# What a file says of itself.
KIND, VERSION = "Spectral TV recipe", 1
# Bytes that no recipe has.
MOST = 100_000
LONGEST = 60
# What is of an object or of a session, and of no recipe.
USUAL = {
    "vertex_group": "",
    "into": Settings.into,
    "bands_as": Settings.bands_as,
    "heights": Settings.heights,
}


def names() -> list[str]:
    """Those of all recipes; one's own come last."""
    return [*(each.name for each in recipes.RECIPES), *(each.name for _, each in own())]


def find(name: str) -> Recipe:
    """The recipe of a name, or of a file's path; raises Refusal if there is none."""
    if name.lower().endswith(EXTENSION):
        return read(Path(bpy.path.abspath(name)))
    for recipe in (*recipes.RECIPES, *(each for _, each in own())):
        if recipe.name.casefold() == name.strip().casefold():
            return recipe
    raise Refusal(f"there is no recipe {name!r}; there are {', '.join(names())}")


def own() -> list[tuple[Path, Recipe]]:
    """One's own recipes with their files, by name; files that are none are left out."""
    found = []
    for path in _paths():
        try:
            found.append((path, _known(str(path), path.stat().st_mtime_ns)))
        except (Refusal, OSError):
            continue
    return sorted(found, key=lambda pair: pair[1].name.casefold())


def read(path: Path) -> Recipe:
    """The recipe of a file; raises Refusal if it holds none."""
    try:
        if path.stat().st_size > MOST:
            raise Refusal(f"{path.name} is too large for a recipe")
        held = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise Refusal(f"{path.name} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, ValueError, RecursionError) as error:
        raise Refusal(f"{path.name} is no recipe: it is no JSON") from error
    return _checked(held, path)


def save(recipe: Recipe, path: Path) -> None:
    """Write a recipe; raises Refusal if that fails."""
    settings = {name: each for name, each in asdict(recipe.settings).items() if name not in USUAL}
    held = {
        "kind": KIND,
        "version": VERSION,
        "name": recipe.name,
        "text": recipe.text,
        "settings": settings,
        "values": list(recipe.values),
    }
    try:
        whole.write_text(path, json.dumps(held, indent=2, ensure_ascii=False))
    except whole.NotWritten as error:
        raise Refusal(str(error)) from error


def keep(recipe: Recipe) -> Path:
    """Add a recipe to one's own, in the place of one of the same name; returns its file."""
    if recipe.name.casefold() in {each.name.casefold() for each in recipes.RECIPES}:
        raise Refusal(f"{recipe.name!r} is a recipe of Spectral TV; choose another name")
    if not recipe.name or len(recipe.name) > LONGEST:
        raise Refusal(f"a recipe has a name of at most {LONGEST} letters")
    there = {each.name.casefold(): path for path, each in own()}
    path = there.get(recipe.name.casefold())
    if path is None:
        stem, path = bpy.path.clean_name(recipe.name), None
        taken = {each.name for each in _paths()}
        number = 1
        while path is None or path.name in taken:
            path = folder() / f"{stem}{'' if number == 1 else f'_{number}'}{EXTENSION}"
            number += 1
    save(recipe, path)
    return path


def remove(name: str) -> None:
    """Remove one of one's own; raises Refusal if there is none of the name."""
    for path, recipe in own():
        if recipe.name == name:
            path.unlink()
            return
    raise Refusal(f"there is no recipe of yours called {name!r}")


def folder() -> Path:
    """Where new ones are kept."""
    return Path(bpy.utils.user_resource("SCRIPTS", path=f"presets/{FOLDER}", create=True))


def shareable(settings: Settings, bands: int) -> Settings:
    """Settings of so many bands without what is of one object; that is noted."""
    if settings.vertex_group:
        note(f"the recipe is not limited to {settings.vertex_group}, which is of this object")
    if settings.shape in ON_NEW_OBJECT:
        note("the recipe is for the shape as it is shown")
    shape = Settings.shape if settings.shape in ON_NEW_OBJECT else settings.shape
    return replace(settings, **USUAL, shape=shape, bands=bands)


def forget() -> None:
    """Let go of what was read."""
    _known.cache_clear()


@cache
def _known(path: str, _time: int) -> Recipe:
    return read(Path(path))


def _paths() -> Iterator[Path]:
    for each in bpy.utils.preset_paths(FOLDER):
        for path in sorted(Path(each).iterdir()):
            if path.suffix.lower() == EXTENSION and not path.name.startswith("."):
                yield path


def _checked(held: Any, path: Path) -> Recipe:
    """A recipe of what a file holds; raises Refusal if it is none."""
    if not isinstance(held, dict) or held.get("kind") != KIND:
        raise Refusal(f"{path.name} is no recipe of Spectral TV")
    if held.get("version") != VERSION:
        raise Refusal(f"{path.name} is a recipe of another version of Spectral TV")
    name, text, values, given = (held.get(key) for key in ("name", "text", "values", "settings"))
    if not (isinstance(name, str) and name.strip() and isinstance(text, str)):
        raise Refusal(f"{path.name} has no name and text")
    if not isinstance(given, dict):
        raise Refusal(f"{path.name} has no settings")
    known = {field.name for field in fields(Settings)} - USUAL.keys()
    unknown = [str(each) for each in given if each not in known]
    if unknown:
        note(f"{path.name}: these settings are not known, and do not count: {listed(unknown)}")
    options = options_of(Settings)
    taken = {each: _value(path, each, options[each], given[each]) for each in known & given.keys()}
    settings = Settings(**taken)
    if settings.complaint() is not None:
        raise Refusal(f"{path.name}: {settings.complaint()}")
    if not isinstance(values, list) or len(values) != settings.band_count:
        raise Refusal(f"{path.name} does not have a value for each of {settings.band_count} bands")
    for value in values:
        if not (
            _is_number(value) and shape_keys.SLIDER_RANGE[0] <= value <= shape_keys.SLIDER_RANGE[1]
        ):
            raise Refusal(f"{path.name} has {value!r} as the value of a band")
    return Recipe(name.strip()[:LONGEST], text, settings, tuple(map(float, values)))


def _value(path: Path, name: str, option: Option, value: Any) -> Any:
    """The value of an option; raises Refusal if it cannot be one."""
    least, most = (None if each is None else float(each) for each in option.range)
    is_number = _is_number(value)
    if option.kind == "share":
        least, most = 0.0, float(option.most) / 100
    if option.is_own(value) if is_number else False:
        least = None
    is_within = is_number and (least is None or value >= least) and (most is None or value <= most)
    fits = {
        "integer": is_within and isinstance(value, int),
        "number": is_within,
        "share": is_within,
        "switch": isinstance(value, bool),
        "choice": value in option.names if isinstance(value, str) else False,
        "name": isinstance(value, str),
    }
    if not fits[option.kind]:
        raise Refusal(f"{path.name}: {option.label} cannot be {value!r}")
    return float(value) if option.kind in ("number", "share") else value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
