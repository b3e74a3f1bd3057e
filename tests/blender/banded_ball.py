"""A bumpy ball with one decomposition or two, and what tests ask of it."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import bumpy_ball

STEPS = 13  # twelve components


def names(obj) -> list[str]:
    return [key.name for key in obj.data.shape_keys.key_blocks][1:]


def values(obj) -> list[float]:
    return [key.value for key in obj.data.shape_keys.key_blocks][1:]


def listed(obj) -> list[str]:
    return [record.name for record in obj.data.spectral_tv.decompositions]


def active(obj):
    kept = obj.data.spectral_tv
    return kept.decompositions[kept.active_decomposition]


def seen(obj) -> np.ndarray:
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return np.array([vertex.co for vertex in shape.vertices])


def switch(name: str) -> None:
    assert bpy.ops.spectral_tv.switch_decomposition(name=name) == {"FINISHED"}


def decompose(**options) -> None:
    assert bpy.ops.spectral_tv.decompose(**{"steps": STEPS, **options}) == {"FINISHED"}


def told(capfd) -> str:
    return capfd.readouterr().out


@pytest.fixture
def empty_file():
    """Without what tests before left, as some of it cannot be saved."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


@pytest.fixture
def obj():
    """A bumpy ball with three bands of Shape Detail."""
    made = bumpy_ball()
    decompose(bands=3)
    bpy.ops.spectral_tv.widen_sliders()
    return made


@pytest.fixture
def keys(obj):
    return obj.data.shape_keys.key_blocks


@pytest.fixture
def both(obj):
    """The same with two bands of Limbs and Head, which are active."""
    decompose(method="M2", bands=2)
    return obj
