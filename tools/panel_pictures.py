"""Cut the manual's pictures of the panels out of the screenshots that tests/window keeps."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
# Left, upper, right and lower edge of the sidebar in a window of 1280 × 800.
DECOMPOSE = (775, 82, 1035, 280)
BANDS = (775, 280, 1035, 715)
PICTURES = {
    "panel_decompose": ("1_tab.png", DECOMPOSE),
    "panel_progress": ("2_progress.png", DECOMPOSE),
    "panel_bands": ("4_bands.png", BANDS),
}


def main() -> None:
    """Write docs/pictures/panel_*.png."""
    for name, (screenshot, box) in PICTURES.items():
        with Image.open(ROOT / ".build" / "screenshots" / screenshot) as picture:
            cut = picture.convert("RGB").crop(box)
        cut.quantize(64).save(ROOT / "docs" / "pictures" / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
