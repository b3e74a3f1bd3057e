"""The manual's film of poses: an arm is raised, a head turned, a tail curled, without a rig.

python -m tools.gallery.pose_film FILM.webp
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from PIL import Image

from ..demo.contact_sheet import PAPER
from .figures import man
from .limb_turns import PARTS, LimbTurn, Part
from .page import Shape
from .poses import CLAY
from .shapes import creature, taken

# Pictures are made larger and reduced, for smooth outlines.
CELL, OVERSIZE = 320, 2
# In milliseconds: each of the frames, and those at either end.
FRAMES, MOVING, RESTING = 18, 60, 700
QUALITY = 70
# Of the diagonal: the radius of the balls, and how far they are in front, where nothing hides them.
BALL, BEFORE = 0.02, 0.5
# Of what is held, and of what is pulled, linear.
HELD, PULLED = np.array([0.03, 0.16, 0.55]), np.array([0.85, 0.22, 0.01])
HEAD = Part(
    "head",
    lambda x, y, z: (z > 0.8) & (abs(x - 0.5) < 0.2) & (y < 0.6),
    (0.5, 0.5, 0.6),
    (0, 0, 1),
    45,
)
TIP = Part(
    "tail",
    lambda x, _y, z: (x < 0.09) & (z > 0.28) & (z < 0.5),
    (0.06, 0.6, 0.25),
    (0, -1, 0),
    140,
)


def main(path: Path) -> None:
    """Write the film as an animated WebP."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    dragon = creature()
    turns = [
        LimbTurn("man", man(), PARTS["man"]),
        LimbTurn("dragon", dragon, HEAD, is_turned=True),
        LimbTurn("dragon", dragon, TIP, is_turned=True),
    ]
    clips = [_clip(turn) for turn in turns]
    there = [_side_by_side(pictures) for pictures in zip(*clips, strict=True)]
    first, *others = [*there, *there[-2:0:-1]]
    times = [MOVING] * (2 * len(there) - 2)
    times[0] = times[len(there) - 1] = RESTING
    first.save(path, save_all=True, append_images=others,
               duration=times, loop=0, quality=QUALITY, method=6)  # fmt: skip


def _clip(turn: LimbTurn) -> list[Image.Image]:
    """As Live follows handles: a step for each frame, and the last one settles."""
    poser, shapes, targets = turn.poser(), [turn.shape.vertices], [turn.targets(0)]
    for frame in range(1, FRAMES + 1):
        # Slow at either end.
        targets.append(turn.targets(0.5 - 0.5 * np.cos(np.pi * frame / FRAMES)))
        solve = poser.drag if frame < FRAMES else poser.solve
        shapes.append(solve(targets[-1]).vertices)
    return _with_balls(turn, shapes, targets)


def _with_balls(
    turn: LimbTurn, shapes: list[np.ndarray], targets: list[np.ndarray]
) -> list[Image.Image]:
    """Photographs of shapes, with a ball in the middle of each group of targets."""
    groups = _groups(turn)
    size = np.linalg.norm(np.ptp(turn.shape.vertices, axis=0))
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=BALL * size)
    ball = taken(bpy.context.object)
    ball.vertices[:] += BEFORE * size * _towards_camera(turn.shape)
    faces, colors = [turn.shape.triangles], [np.tile(CLAY, (len(turn.shape.vertices), 1))]
    for number, group in enumerate(groups):
        faces.append(ball.triangles + len(turn.shape.vertices) + number * len(ball.vertices))
        color = PULLED if turn.is_pulled[group[0]] else HELD
        colors.append(np.tile(color, (len(ball.vertices), 1)))
    shots = [
        np.concatenate([shape, *(ball.vertices + goal[group].mean(axis=0) for group in groups)])
        for shape, goal in zip(shapes, targets, strict=True)
    ]
    scene = replace(turn.shape, vertices=shots[0], triangles=np.concatenate(faces))
    pictures = scene.photograph(
        [(shot, np.concatenate(colors)) for shot in shots], OVERSIZE * CELL, is_still=True
    )
    return [picture.reduce(OVERSIZE) for picture in pictures]


def _groups(turn: LimbTurn) -> list[np.ndarray]:
    """What is pulled, and what is held left and right, as numbers of constraints."""
    x = turn.shape.vertices[turn.indices, 0]
    is_left = x > turn.shape.vertices[:, 0].mean()
    held = ~turn.is_pulled
    found = [np.flatnonzero(each) for each in (turn.is_pulled, held & is_left, held & ~is_left)]
    return [each for each in found if len(each)]


def _towards_camera(shape: Shape) -> np.ndarray:
    azimuth, elevation = np.radians([shape.azimuth, shape.elevation])
    across = np.cos(elevation)
    return np.array([across * np.sin(azimuth), -across * np.cos(azimuth), np.sin(elevation)])


def _side_by_side(pictures: tuple[Image.Image, ...]) -> Image.Image:
    page = Image.new("RGB", (CELL * len(pictures), CELL), PAPER)
    for number, picture in enumerate(pictures):
        page.paste(picture, (CELL * number, 0), picture)
    return page


if __name__ == "__main__":
    main(Path(sys.argv[1]))
