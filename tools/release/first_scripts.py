"""Write the first script of the README and the first plot of the documentation into a directory.

python first_scripts.py DIRECTORY

Both are for a Python without Blender.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
# The page, and what the example that is meant has in it.
SCRIPTS = {
    "first_script.py": ("README.md", "spectral_tv.decompose("),
    "first_plot.py": ("docs/scripting.md", ".plot("),
}


def main() -> None:
    """Write them."""
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    for name, (page, has) in SCRIPTS.items():
        blocks = BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))
        (target / name).write_text(
            next(block for block in blocks if has in block and "import bpy" not in block),
            encoding="utf-8",
        )


if __name__ == "__main__":
    main()
