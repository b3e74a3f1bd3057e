"""New bands in the place of old ones: they take over values, masks, animation and drivers.

The values of bands are a filter over scales, constant within each band. The value of a new band is
the mean of this filter over its components. All components have the same weight, as bands hold
equal numbers of components.
"""

from collections.abc import Sequence

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import note

from ..scene import masks
from ..scene.channels import Animated, own_actions
from ..scene.curve_sums import Term, total
from ..scene.drivers import copy_driver, same_driver
from ..scene.fcurves import Point, add_curve, make_keyframes, same_modifiers
from ..scene.keeping import Band, Keeping
from ..scene.names import free_name, taken_names
from .mean_mask import mean_mask
from .overlap import Overlap

# By how much values of bands may differ untold.
VISIBLE = 1e-3


@dataclass(frozen=True)
class Former:
    """A band that new ones replace, None if it is gone, and the name that it was given.

    A band that ``stays`` is muted, as the new ones are shown in its place.
    """

    band: Band | None
    stays: bool
    given: str

    @property
    def is_renamed(self) -> bool:
        """Whether it has a name that the user gave it."""
        return self.band is not None and self.band.name != self.given


class Recut:
    """New bands in the place of old ones.

    A new band with the same components as one that the user renamed gets that name. Others get
    those of ``names``, if they are free.
    """

    def __init__(
        self,
        obj: bpy.types.Object,
        keeping: Keeping,
        former: Sequence[Former],
        new: Sequence[Band],
        names: Sequence[str],
        overlap: Overlap,
    ) -> None:
        """Take the old and the new bands, and the names of these."""
        self.obj, self.keeping, self.former, self.new = obj, keeping, former, new
        self.block, self.path = keeping.block(obj), keeping.path
        self.old, self.parts = [each.band for each in former], overlap.parts
        self.mixed: list[str] = []
        self.heirs = [overlap.successor(band) for band in range(len(former))]
        equals = [overlap.equal(band) for band in range(len(new))]
        self.twins = [None if equal is None else former[equal] for equal in equals]
        self.names = [
            name if twin is None or not twin.is_renamed else twin.band.name
            for name, twin in zip(names, self.twins, strict=True)
        ]
        self.usual = names

    def take_place(self) -> tuple[list[str], list[str]]:
        """Have them take it; returns their present names, and the names that they were given."""
        obj, keeping = self.obj, self.keeping
        self._carry()
        gone, heirs = [], {}
        for each, heir in zip(self.former, self.heirs, strict=True):
            if each.band is not None and each.stays:
                each.band.mute = True
            elif each.band is not None:
                name = each.band.name
                gone.append(name)
                if heir is None:
                    self._note_lost(each.band)
                else:
                    heirs[name] = self.new[heir]
                    if name not in (each.given, *self.names):
                        note(f"{name!r} went into {self.names[heir]!r}")
        take = keeping.hand_over(obj, gone, heirs)
        keeping.remove(obj, [keeping.all(obj)[name] for name in gone])
        for band, name in zip(self.new, self.names, strict=True):
            band.name = free_name(name, "", taken_names(obj, keeping.written) - {band.name})
        take(self.new)
        given = [
            band.name if name in self.usual else twin.given
            for band, name, twin in zip(self.new, self.names, self.twins, strict=True)
        ]
        return [band.name for band in self.new], given

    def _note_lost(self, band: Band) -> None:
        """Note what was set of a band whose sizes no new one has."""
        moving = self.keeping.animation_of(band, "value")
        if band.value or moving:
            how = f" and {moving}" if moving else ""
            note(f"no new band has the sizes of {band.name!r}, which was {band.value:.3g}{how}")

    def _carry(self) -> None:
        """Set the new keys, and animate and drive them."""
        for animated in own_actions(self.block, self._is_of_old, "these bands"):
            for band in range(len(self.new)):
                self._carry_curves(animated, band)
        for band in range(len(self.new)):
            self._carry_settings(band)
            self._carry_drivers(band)
        if self.mixed:
            note(f"the mean of other values, so that the shape is another: {', '.join(self.mixed)}")

    def _is_of_old(self, path: str) -> bool:
        """Whether a path is to a property of an old band."""
        there = [key for key in self.old if key is not None]
        return any(self.keeping.property_of(key, path) for key in there)

    def _former(self, band: int) -> list[int]:
        """Old bands that a new one has parts of, the largest part first."""
        order = np.argsort(-self.parts[band], kind="stable").tolist()
        return [old for old in order if self.parts[band, old] > 0 and self.old[old] is not None]

    def _heard(self, band: int) -> list[int]:
        """Those that are seen: a muted one counts for nothing, unless all of them are."""
        former = self._former(band)
        return [old for old in former if not self.old[old].mute] or former

    def _carry_settings(self, band: int) -> None:
        order = self._former(band)
        if not order:
            return
        key, former = self.new[band], [self.old[old] for old in order]
        value = sum(self.parts[band, old] * self.old[old].value for old in self._heard(band))
        key.slider_min = min(value, *(each.slider_min for each in former))
        key.slider_max = max(value, *(each.slider_max for each in former))
        key.value = value
        key.mute = all(each.mute for each in former)
        self._carry_mask(band, order)
        key.lock_shape = former[0].lock_shape
        self._tell(band, "locks", order, [each.lock_shape == key.lock_shape for each in former])
        heard = [self.old[old].value for old in self._heard(band)]
        if self.parts[band].sum() < 1 - 1e-9:  # what no old band held was left as it is
            heard.append(0.0)
        if max(heard) - min(heard) > VISIBLE:
            self.mixed.append(f"{self.names[band]!r} ({value:.3g})")
        if not key.mute and any(each.mute for each in former):
            note(
                f"{self.names[band]!r} is in the place of muted bands too, which count for nothing"
            )

    def _carry_mask(self, band: int, order: Sequence[int]) -> None:
        """Give it the mask of the old ones, or the mean of those that are seen if they differ."""
        seen = {self.old[old].vertex_group for old in order}
        if len(seen) == 1:
            self.new[band].vertex_group = self.old[order[0]].vertex_group
            return
        heard = self._heard(band)
        bands, parts = [self.old[old] for old in heard], self.parts[band, heard]
        is_moving = any(self.keeping.animation_of(each, "value") for each in bands)
        values = [1.0 if is_moving else each.value for each in bands]
        masks.give(self.obj, self.new[band], mean_mask(self.obj, bands, parts, values))
        names = ", ".join(repr(self.old[old].name) for old in sorted(order))
        note(f"{self.names[band]!r} has the mean of the masks of {names}, which differ")

    def _tell(self, band: int, what: str, former: Sequence[int], same: Sequence[bool]) -> None:
        """Note that what the first of old bands had was taken, where others had not the same."""
        if not all(same):
            names = [self.old[old].name for old in former]
            note(
                f"{self.names[band]!r} is in the place of {', '.join(map(repr, names))}, whose "
                f"{what} differ; it has what {names[0]!r} had"
            )

    def _carry_curves(self, animated: Animated, band: int) -> None:
        curves, key = animated.curves, self.new[band]
        moving = {
            old: curve
            for old in self._heard(band)
            if (curve := curves.find(self.path(self.old[old], "value"))) is not None
        }
        if not all(curve.mute for curve in moving.values()):
            moving = {old: curve for old, curve in moving.items() if not curve.mute}
        for curve in moving.values():
            make_keyframes(curve)
        moving = {old: curve for old, curve in moving.items() if len(curve.keyframe_points)}
        if moving:
            terms = [
                Term(
                    float(self.parts[band, old]),
                    0.0 if animated.adds else self.old[old].value,
                    moving.get(old),
                )
                for old in self._heard(band)
            ]
            first = next(iter(moving.values()))
            add_curve(curves, self.path(key, "value"), total(terms), first)
            same = [same_modifiers([first, curve]) for curve in moving.values()]
            self._tell(band, "modifiers of curves", [*moving], same)
        for old in self._former(band)[:1]:
            for curve in [*curves]:
                name = self.keeping.property_of(self.old[old], curve.data_path)
                if name not in ("", "value"):
                    points = [Point.of(point) for point in curve.keyframe_points]
                    add_curve(curves, self.path(key, name), points, curve)

    def _carry_drivers(self, band: int) -> None:
        animation = self.block.animation_data
        if animation is None or not self._former(band):
            return
        drivers = {
            old: animation.drivers.find(self.path(self.old[old], "value"))
            for old in self._former(band)
        }
        # Of equal parts the one that is driven.
        former = sorted(drivers, key=lambda old: (-self.parts[band, old], drivers[old] is None))
        same = [same_driver(drivers[former[0]], drivers[old]) for old in former]
        self._tell(band, "drivers", former, same)
        for driver in [*animation.drivers]:
            name = self.keeping.property_of(self.old[former[0]], driver.data_path)
            if name:
                copy_driver(animation, driver, self.path(self.new[band], name))
