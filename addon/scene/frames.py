"""Going through the frames of a scene."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy

# Modifiers that go on from their state on the frame before.
SIMULATIONS = {"CLOTH", "SOFT_BODY", "PARTICLE_SYSTEM", "FLUID", "DYNAMIC_PAINT"}


def curve_time(scene: bpy.types.Scene, frame: float) -> float:
    """Where on its curves a frame is played: elsewhere if the scene stretches time."""
    return frame * scene.render.frame_map_old / scene.render.frame_map_new


@contextmanager
def kept(scene: bpy.types.Scene) -> Iterator[None]:
    """Go back to the present frame in the end."""
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        scene.frame_set(frame, subframe=subframe)


def visited(scene: bpy.types.Scene, frames: Sequence[int]) -> Iterator[int]:
    """Set the scene to each of the frames, which increase.

    If something is simulated, every frame since the start of the simulation is played on the way.
    """
    starts = list(_simulation_starts(scene))
    on_the_way = frames
    if starts:
        on_the_way = range(min(*starts, frames[0]), frames[-1] + 1)
    wanted = set(frames)
    for number in on_the_way:
        scene.frame_set(number)
        if number in wanted:
            yield number


def _simulation_starts(scene: bpy.types.Scene) -> Iterator[int]:
    """The first frames of what is simulated in the scene and not kept on the disk."""
    world = scene.rigidbody_world
    if world is not None and world.enabled and not world.point_cache.is_baked:
        yield world.point_cache.frame_start
    for obj in scene.objects:
        for modifier in obj.modifiers:
            cache = getattr(modifier, "point_cache", None)
            if modifier.type == "PARTICLE_SYSTEM":
                cache = modifier.particle_system.point_cache
            if modifier.type in SIMULATIONS and not (cache is not None and cache.is_baked):
                yield scene.frame_start if cache is None else cache.frame_start
            elif modifier.type == "NODES" and _simulates(modifier.node_group):
                yield scene.frame_start


def depends_on_time(group: bpy.types.NodeTree | None) -> bool:
    """Whether a node group asks for the frame."""
    return group is not None and any(
        node.bl_idname == "GeometryNodeInputSceneTime"
        or depends_on_time(getattr(node, "node_tree", None))
        for node in group.nodes
    )


def _simulates(group: bpy.types.NodeTree | None) -> bool:
    """Whether a node group holds a simulation zone."""
    return group is not None and any(
        node.bl_idname == "GeometryNodeSimulationInput"
        or _simulates(getattr(node, "node_tree", None))
        for node in group.nodes
    )
