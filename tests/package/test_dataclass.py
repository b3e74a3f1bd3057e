"""Dataclasses that share their methods behave like those of the standard library."""

from __future__ import annotations

import dataclasses
import pickle

import pytest
from spectral_tv.dataclass import dataclass


def declared(decorator):
    """A family of classes that exercises what the package uses."""

    @decorator(frozen=True)
    class Point:
        """Two numbers, of which one is not compared, and a list of its own."""

        x: float
        y: float = 2.0
        note: str = dataclasses.field(default="", repr=False, compare=False)
        more: tuple = dataclasses.field(default_factory=tuple)

        @property
        def sum(self):
            return self.x + self.y

    @decorator(frozen=True)
    class Place(Point):
        """One that derives from it."""

        z: float = 0.0

    @decorator
    class Open:
        """One that can be changed."""

        items: list = dataclasses.field(default_factory=list)
        count: int = 0

    @decorator(frozen=True, eq=False)
    class Same:
        """One that is equal to itself alone, and says what it is in its own words."""

        value: int

        def __repr__(self):
            return f"<{self.value}>"

    return {each.__name__: each for each in (Point, Place, Open, Same)}


OWN, STANDARD = declared(dataclass), declared(dataclasses.dataclass)
CALLS = [
    ("Point", (1,), {}),
    ("Point", (1, 3), {"note": "seen"}),
    ("Point", (), {"y": 4, "x": 1}),
    ("Place", (1, 2, "n", (3,), 4), {}),
    ("Place", (1,), {"z": 5}),
    ("Open", (), {}),
    ("Open", ([1],), {"count": 2}),
    ("Same", (7,), {}),
]
WRONG = [
    ("Point", (), {}),
    ("Point", (1,), {"x": 2}),
    ("Point", (1,), {"w": 2}),
    ("Open", ([], 1, 2), {}),
]


@pytest.mark.parametrize(("name", "arguments", "given"), CALLS)
def test_they_are_made_shown_and_taken_apart_alike(name, arguments, given):
    own, standard = (kinds[name](*arguments, **given) for kinds in (OWN, STANDARD))
    assert repr(own).rpartition(".")[2] == repr(standard).rpartition(".")[2]
    assert vars(own) == vars(standard)
    assert dataclasses.asdict(own) == dataclasses.asdict(standard)
    assert [each.name for each in dataclasses.fields(own)] == [*vars(standard)]
    first = dataclasses.fields(own)[0].name
    assert vars(dataclasses.replace(own, **{first: 9})) == {**vars(standard), first: 9}


@pytest.mark.parametrize(("name", "arguments", "given"), WRONG)
def test_wrong_arguments_are_refused(name, arguments, given):
    for kinds in (OWN, STANDARD):
        with pytest.raises(TypeError):
            kinds[name](*arguments, **given)


@pytest.mark.parametrize("kinds", [OWN, STANDARD])
def test_they_compare_alike(kinds):
    point, place, changeable, same = kinds.values()
    assert point(1) == point(1, 2, "another note") and point(1) != point(2)
    assert point(1) != place(1)
    assert hash(point(1)) == hash(point(1, note="x"))
    assert changeable([1]) == changeable([1])
    assert changeable.__hash__ is None
    assert same(1) != same(1)
    assert len({same(1), same(1)}) == 2
    assert repr(same(1)) == "<1>"


@pytest.mark.parametrize("kinds", [OWN, STANDARD])
def test_frozen_ones_stay_as_they_are(kinds):
    for made in (kinds["Point"](1), kinds["Place"](1), kinds["Same"](1)):
        first = dataclasses.fields(made)[0].name
        with pytest.raises(dataclasses.FrozenInstanceError, match=first):
            setattr(made, first, 2)
        with pytest.raises(dataclasses.FrozenInstanceError, match=first):
            delattr(made, first)
    changeable = kinds["Open"]()
    changeable.count = 3
    changeable.items.append(1)
    assert kinds["Open"]().items == [] and changeable.count == 3


@dataclass(frozen=True)
class Sent:
    """One that goes to another process."""

    value: int


def test_they_are_pickled():
    assert pickle.loads(pickle.dumps(Sent(3))) == Sent(3)
