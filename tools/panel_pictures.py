"""Cut the manual's pictures of the panels out of the screenshots that tests/window keeps."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
# Left and right edge of the sidebar in the session's window; upper and lower edges of the panels.
LEFT, RIGHT = 774, 1030
PICTURES = {
    "panel_recipes": ("1_tab", 84, 245),
    "panel_decompose": ("1_tab", 245, 489),
    "panel_progress": ("2_progress", 207, 451),
    "panel_scales": ("panel_base_limbs", 245, 658),
    "panel_bands": ("4_bands", 563, 1174),
    "panel_deviation": ("deviation_limited", 1414, 1626),
    "panel_filters": ("4_bands", 1174, 1363),
    "panel_curve": ("panel_curve", 1553, 1866),
    "panel_deform": ("panel_deform", 550, 1050),
    "panel_attributes": ("panel_attributes", 1106, 1400),
    "panel_values": ("panel_values", 1401, 1664),
}
# Of the 3D view: the edges on the left, above, on the right and below.
VIEWS = {"deviation": ("deviation_limited", (66, 660, 772, 1236))}


def main() -> None:
    """Write docs/pictures/panel_*.png, and those of the view."""
    for name, (screenshot, upper, lower) in PICTURES.items():
        cut(name, screenshot, (LEFT, upper, RIGHT, lower))
    for name, (screenshot, edges) in VIEWS.items():
        cut(name, screenshot, edges, 160)


def cut(name: str, screenshot: str, edges: tuple[int, int, int, int], shades: int = 64) -> None:
    """Write a part of a screenshot, in so many shades."""
    with Image.open(ROOT / ".build" / "screenshots" / f"{screenshot}.png") as picture:
        found = picture.convert("RGB").crop(edges)
    found.quantize(shades).save(ROOT / "docs" / "pictures" / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
