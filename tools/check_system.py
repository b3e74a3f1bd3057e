"""Say which system libraries and tools are missing, and the command that installs them.

python check_system.py [cholmod]
"""

import ctypes
import shutil
import sys
from pathlib import Path

# Shared libraries that the bpy package loads, and Debian's packages of them.
LIBRARIES = {
    "libX11.so.6": "libx11-6",
    "libXrender.so.1": "libxrender1",
    "libXfixes.so.3": "libxfixes3",
    "libXi.so.6": "libxi6",
    "libXxf86vm.so.1": "libxxf86vm1",
    "libxkbcommon.so.0": "libxkbcommon0",
    "libSM.so.6": "libsm6",
    "libICE.so.6": "libice6",
    "libGL.so.1": "libgl1",
    "libgomp.so.1": "libgomp1",
}


def main() -> None:
    """Exit with a message unless everything is there."""
    problems = []
    missing = [package for name, package in LIBRARIES.items() if not is_loadable(name)]
    if missing:
        problems.append(f"system libraries are missing; run: apt-get install {' '.join(missing)}")
    if "cholmod" in sys.argv[1:] and not Path("/usr/include/suitesparse/cholmod.h").is_file():
        problems.append("CHOLMOD is missing; run: apt-get install libsuitesparse-dev")
    if shutil.which("cargo") is None:
        problems.append("Rust is missing; install it from https://rustup.rs (1.88 or later)")
    if shutil.which("cc") is None:
        problems.append("a C compiler is missing; run: apt-get install gcc")
    if sys.version_info[:2] != (3, 11):
        found = ".".join(map(str, sys.version_info[:2]))
        problems.append(f"bpy needs Python 3.11, but this is {found}; set PYTHON=python3.11")
    if problems:
        sys.exit("\n".join(problems))


def is_loadable(name: str) -> bool:
    """Whether the dynamic linker finds the library."""
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True


if __name__ == "__main__":
    main()
