"""An option is declared once: operator, sidebar, command line and report have it by that."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import bpy
import pytest
from spectral_tv.bands.settings import Settings
from spectral_tv.options import arguments, declaring

KINDS = (("ROUND", "Round", "Without corners"), ("FLAT", "Flat", "Without height"))
FLAT = declaring.Only("kind", ["FLAT"])


@dataclass(frozen=True)
class Cake:
    """One option of each kind."""

    kind: str = declaring.choice("Kind", "What it is like", KINDS)
    layers: int = declaring.integer("Layers", "How many", 3, 1, 9, keyword="count")
    sugar: float = declaring.number("Sugar", "How sweet", 0.5, 0, 1, keyword="sweetness")
    crust: float = declaring.share(
        "Crust",
        "How much is crust",
        0,
        0,
        50,
        switch=("use_crust", "Crust", ""),
        applies=FLAT,
        refused=True,
    )
    name: str = declaring.name_of("Name", "What is written on it", applies=FLAT)
    warm: bool = declaring.switch("Warm", "Whether it is warm", argument="is-warm")


def same(one, other) -> None:
    """Properties hold numbers in single precision."""
    for name in declaring.options_of(Settings):
        assert getattr(one, name) == pytest.approx(getattr(other, name))


def parsed(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    arguments.add_arguments(parser, Cake)
    return parser.parse_args(words)


def test_arguments_are_read_as_what_is_declared():
    assert arguments.read(parsed(), Cake) == Cake()
    words = "--kind flat --layers 4 --sugar 0.25 --crust 20% --name Anna --is-warm"
    found = arguments.read(parsed(*words.split()), Cake)
    assert found == Cake("FLAT", 4, 0.25, 0.2, "Anna", True)


@pytest.mark.parametrize("words", ["--layers 10", "--sugar 1.5", "--kind square", "--crust no"])
def test_what_is_out_of_range_is_no_argument(words, capsys):
    with pytest.raises(SystemExit):
        parsed(*words.split())
    assert words.split()[1] in capsys.readouterr().err


def test_an_option_that_does_not_apply_is_refused_or_of_no_account():
    choices = parsed("--crust", "20", "--name", "Anna")
    settings = arguments.read(choices, Cake)
    assert arguments.complaint(choices, Cake, settings) == "--crust goes with --kind flat"
    assert arguments.told(settings) == {
        "kind": "round",
        "layers": 3,
        "sugar": 0.5,
        "is_warm": False,
    }
    choices = parsed("--crust", "20", "--name", "Anna", "--kind", "flat")
    settings = arguments.read(choices, Cake)
    assert arguments.complaint(choices, Cake, settings) is None
    assert {"crust": 0.2, "name": "Anna"}.items() <= arguments.told(settings).items()


def test_keywords_are_the_packages():
    assert declaring.keywords(Cake(layers=2)) == {"count": 2, "sweetness": 0.5}


def test_an_operator_and_the_sidebar_have_every_option():
    operator = bpy.ops.spectral_tv.decompose.get_rna_type().properties
    sidebar = bpy.types.Scene.bl_rna.properties["spectral_tv"].fixed_type.properties
    for name, option in declaring.options_of(Settings).items():
        for found in (operator, sidebar):
            assert found[name].name == option.label
            assert found[name].description.startswith(option.text)
            assert found[name].default == pytest.approx(option.default)


def test_choices_are_the_settings_and_back():
    choices = bpy.context.scene.spectral_tv
    same(choices.settings(), Settings())
    changed = Settings(method="M3", bands=7, accuracy=0.1, finest=0.02, base="FLAT", weld=0.01)
    choices.fill(changed)
    assert choices.use_accuracy and choices.use_scales and not choices.use_base_amount
    same(choices.settings(), changed)
    choices.fill(Settings())
    same(choices.settings(), Settings())
