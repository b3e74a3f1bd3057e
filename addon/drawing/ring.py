"""A ring on a surface, drawn over all 3D views, as the circle of a brush is."""

import math

import bpy
from mathutils import Matrix, Vector

CORNERS = 64
# In pixels of an interface that is not scaled; the wider line is dark, so that both are seen.
WIDTHS = ((3.0, (0.0, 0.0, 0.0, 0.6)), (1.5, (1.0, 1.0, 1.0, 0.9)))


class Ring:
    """A circle in the world; nothing is drawn while its middle is None."""

    def __init__(self) -> None:
        """Begin to draw."""
        self.middle: Vector | None = None
        self.normal = Vector((0, 0, 1))
        self.radius = 0.0
        space = bpy.types.SpaceView3D
        self._handle = space.draw_handler_add(self._draw, (), "WINDOW", "POST_VIEW")

    def remove(self) -> None:
        """Draw no more."""
        if self._handle is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handle, "WINDOW")
            self._handle = None

    def corners(self) -> list[Vector]:
        """Places on the circle, the first also at the end."""
        turn = self.normal.to_track_quat("Z", "Y").to_matrix().to_4x4()
        place = Matrix.Translation(self.middle) @ turn
        angles = (2 * math.pi * index / CORNERS for index in range(CORNERS + 1))
        return [
            place @ Vector((self.radius * math.cos(angle), self.radius * math.sin(angle), 0))
            for angle in angles
        ]

    def _draw(self) -> None:
        if self.middle is None:
            return
        import gpu  # noqa: PLC0415 - it is of no use without a window
        from gpu_extras.batch import batch_for_shader  # noqa: PLC0415

        context = bpy.context
        shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
        batch = batch_for_shader(shader, "LINE_STRIP", {"pos": self.corners()})
        gpu.state.blend_set("ALPHA")
        shader.bind()
        shader.uniform_float("viewportSize", (context.region.width, context.region.height))
        for width, color in WIDTHS:
            shader.uniform_float("lineWidth", width * context.preferences.system.ui_scale)
            shader.uniform_float("color", color)
            batch.draw(shader)
        gpu.state.blend_set("NONE")
