"""The README's film: bands are turned, a mask limits them, and a hand is dragged.

python -m tools.gallery.film FILM.webp
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np
import spectral_tv
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from PIL import Image, ImageDraw

from ..demo.contact_sheet import INK, PAPER, RULE, letters
from ..demo.studio import Studio, temporary_data
from .limb_turns import LimbTurn, Part
from .page import Shape
from .shapes import creature

# Of the picture and of the panel beside it, in pixels; the panel is drawn larger and reduced.
SIDE, PANEL, OVERSIZE = 480, 200, 4
SAMPLES = 24
# In milliseconds: each of the frames, and the last one of an act.
MOVING, RESTING = 75, 600
QUALITY = 80
# Of a decomposition as Blender makes it: soft edges, and limbs kept.
SOFT_EDGES, KEEP_LIMBS, BANDS = 0.3, 1.0, 5
# Values of the bands, finest first.
FLAT = np.zeros(BANDS)
RAISED = np.array([0.7, 1.6, 1.5, 0.8, 0.0])
SMOOTH = np.array([-1.0, -1.0, -1.0, -1.0, 0.0])
# The mask fades over so much of the width.
FADE = 0.04
HAND = Part(
    "hand", lambda x, _y, z: (x > 0.86) & (z > 0.55), (0.68, 0.5, 0.6), (0, -1, 0), 50
)  # fmt: skip
ACTS = ("Turn the bands", "Mask them", "Drag a hand")
# Ends of the sliders, and their colors: of the range, of the value, of a value that moves.
ENDS = (-1.0, 2.0)
GROOVE, BAR, MOVED = (222, 222, 219), (186, 186, 190), (137, 178, 232)
HANDLE, RADIUS = (226, 108, 30), 9
USUAL, BOLD = 430, 650


@dataclass(frozen=True)
class Frame:
    """Which act it is of, the values of the bands, the shape (V, 3), and where the handle is."""

    act: int
    values: np.ndarray
    shape: np.ndarray
    is_moving: bool
    handle: np.ndarray | None = None
    time: int = MOVING


def main(path: Path) -> None:
    """Write the film as an animated WebP."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    shape = creature()
    frames = [*story(shape)]
    pages = [*photographs(shape, frames)]
    save(path, pages, [frame.time for frame in frames])


def save(path: Path, pages: Sequence[Image.Image], times: Sequence[int]) -> None:
    """Write pages that are shown for some milliseconds each."""
    pages[0].save(path, save_all=True, append_images=pages[1:],
                  duration=[*times], loop=0, quality=QUALITY, method=6)  # fmt: skip


def story(shape: Shape) -> Iterator[Frame]:
    """The frames, one after the other."""
    split = spectral_tv.decompose(shape.mesh, method="m1", soft_edges=SOFT_EDGES)
    bands = split.bands(split.band_edges(BANDS), keep_limbs=KEEP_LIMBS)
    width = (shape.vertices[:, 0] - shape.vertices[:, 0].min()) / np.ptp(shape.vertices[:, 0])

    def dialled(values: np.ndarray, border: float = -1.0) -> np.ndarray:
        """The shape with bands that act to the right of a border across its width."""
        x = np.clip((width - border) / FADE, 0, 1)
        mask = x * x * (3 - 2 * x)
        return shape.vertices + mask[:, None] * np.tensordot(values, bands, 1)

    def turned(act: int, start: np.ndarray, end: np.ndarray, count: int, border: float = -1.0):
        for share in eased(count):
            values = start + share * (end - start)
            yield Frame(act, values, dialled(values, border), True)

    yield Frame(0, FLAT, dialled(FLAT), False, time=RESTING)
    yield from resting(turned(0, FLAT, RAISED, 13))
    yield from resting(turned(0, RAISED, SMOOTH, 16))
    middle = 0.5
    borders = -FADE + eased(13) * (middle + FADE)
    yield from resting(Frame(1, SMOOTH, dialled(SMOOTH, each), False) for each in borders)
    yield from resting(turned(1, SMOOTH, RAISED, 14, middle))
    last = replace(shape, vertices=dialled(RAISED, middle))
    yield from dragged(last)
    yield from turned(2, RAISED, FLAT, 6, middle)


def dragged(shape: Shape) -> Iterator[Frame]:
    """As Live follows a hand: up, down, and back; where it rests it settles."""
    turn = LimbTurn("creature", shape, HAND)
    poser = turn.poser()
    start = 0.0
    for end, count in ((0.55, 10), (-0.9, 17), (0.0, 9)):
        for number, share in enumerate(eased(count), 1):
            targets = turn.targets(start + share * (end - start))
            solve = poser.drag if number < count else poser.solve
            handle = targets[turn.is_pulled].mean(axis=0)
            time = MOVING if number < count or end == 0 else RESTING
            yield Frame(2, RAISED, solve(targets).vertices, False, handle, time)
        start = end


def resting(frames: Iterator[Frame]) -> Iterator[Frame]:
    """The same frames; the last one stays for a while."""
    *others, last = frames
    yield from others
    yield replace(last, time=RESTING)


def eased(count: int) -> np.ndarray:
    """Shares of a way in so many steps, slow at either end."""
    return 0.5 - 0.5 * np.cos(np.pi * np.arange(1, count + 1) / count)


def photographs(shape: Shape, frames: Sequence[Frame]) -> Iterator[Image.Image]:
    """Render the frames, with the panel beside them."""
    with temporary_data():
        data = bpy.data.meshes.new("Shape")
        data.from_pydata(shape.vertices.tolist(), [], shape.triangles.tolist())
        obj = bpy.data.objects.new("Shape", data)
        studio = Studio(obj, SIDE, margin=0.04, samples=SAMPLES)
        studio.hold_still([frame.shape for frame in frames])
        for frame in frames:
            shot = studio.shoot(frame.shape)
            page = Image.new("RGB", (PANEL + SIDE, SIDE), PAPER)
            page.paste(_panel(frame), (0, 0))
            page.paste(shot, (PANEL, 0), shot)
            if frame.handle is not None:
                _draw_handle(page, _place(studio.scene, frame.handle))
            yield page


def _place(scene: bpy.types.Scene, point: np.ndarray) -> tuple[float, float]:
    """Where a camera sees a point, in pixels of the page."""
    scene.view_layers[0].update()
    x, y, _ = world_to_camera_view(scene, scene.camera, Vector(point))
    return PANEL + x * SIDE, (1 - y) * SIDE


def _draw_handle(page: Image.Image, place: tuple[float, float]) -> None:
    """Draw a ring around what is dragged."""
    side = 4 * RADIUS
    mask = Image.new("L", (OVERSIZE * side, OVERSIZE * side))
    middle, radius = OVERSIZE * side / 2, OVERSIZE * RADIUS
    pen = ImageDraw.Draw(mask)
    for size, shade in ((radius, 255), (0.6 * radius, 0), (0.35 * radius, 255)):
        pen.ellipse([middle - size, middle - size, middle + size, middle + size], shade)
    corner = round(place[0] - side / 2), round(place[1] - side / 2)
    page.paste(HANDLE, corner, mask.reduce(OVERSIZE))


def _panel(frame: Frame) -> Image.Image:
    """The acts, and a slider for each band."""
    page = Image.new("RGB", (OVERSIZE * PANEL, OVERSIZE * SIDE), PAPER)
    pen = ImageDraw.Draw(page)
    left, right = OVERSIZE * 22, OVERSIZE * (PANEL - 14)
    for number, act in enumerate(ACTS):
        is_now = number == frame.act
        font, color = (
            letters(OVERSIZE * 15, BOLD if is_now else USUAL),
            INK if is_now else (160, 160, 160),
        )
        pen.text((left, OVERSIZE * (96 + 26 * number)), act, color, font, "ls")
    pen.line([(left, OVERSIZE * 172), (right, OVERSIZE * 172)], RULE, OVERSIZE)
    for number, value in enumerate(frame.values):
        top = OVERSIZE * (196 + 34 * number)
        bottom = top + OVERSIZE * 24
        box, corner = [left, top, right, bottom], OVERSIZE * 4
        pen.rounded_rectangle(box, corner, GROOVE)
        zero, end = (
            left + (right - left) * (each - ENDS[0]) / (ENDS[1] - ENDS[0]) for each in (0, value)
        )
        if abs(end - zero) > OVERSIZE:
            bar = [min(zero, end), top, max(zero, end), bottom]
            pen.rounded_rectangle(bar, corner, MOVED if frame.is_moving else BAR)
        pen.line([(zero, top), (zero, bottom)], PAPER, OVERSIZE)
        baseline, font = bottom - OVERSIZE * 7, letters(OVERSIZE * 12, USUAL)
        pen.text((left + OVERSIZE * 7, baseline), f"Band {number + 1}", INK, font, "ls")
        told = f"{value + 0.0:.2f}".replace("-0.00", "0.00").replace("-", "\N{MINUS SIGN}")
        pen.text((right - OVERSIZE * 7, baseline), told, INK, font, "rs")
    return page.reduce(OVERSIZE)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
