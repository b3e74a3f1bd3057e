"""Say which system libraries and tools are missing, and the command that installs them.

python check_system.py [--packages] [cholmod] [chromium] [valgrind]

With --packages, print the names of Debian's packages only.
"""

import ctypes
import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path

# Shared libraries that the packages bpy and open3d load, and Debian's packages of them.
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
    "libusb-1.0.so.0": "libusb-1.0-0",
}


def main() -> None:
    """Exit with a message unless everything is there."""
    packages = missing_packages(set(sys.argv[1:]))
    if "--packages" in sys.argv[1:]:
        print(" ".join(packages))
        return
    problems = []
    if packages:
        problems.append(f"system packages are missing; run: apt-get install {' '.join(packages)}")
    if problem := rust_problem():
        problems.append(problem)
    if sys.version_info[:2] != (3, 11):
        found = ".".join(map(str, sys.version_info[:2]))
        problems.append(f"bpy needs Python 3.11, but this is {found}; set PYTHON=python3.11")
    if problems:
        sys.exit("\n".join(problems))


def missing_packages(purposes: set[str]) -> list[str]:
    """Debian packages that have to be installed for these purposes too."""
    missing = [package for name, package in LIBRARIES.items() if not is_loadable(name)]
    if shutil.which("cc") is None:
        missing.append("gcc")
    if sys.platform == "linux" and shutil.which("strace") is None:
        missing.append("strace")  # which tests watch calls to the network with
    if importlib.util.find_spec("ensurepip") is None:
        missing.append("python3.11-venv")
    if "cholmod" in purposes:
        if not Path("/usr/include/suitesparse/cholmod.h").is_file():
            missing.append("libsuitesparse-dev")
        # CHOLMOD is two to three times slower on the BLAS that comes along with it.
        if not any(Path("/usr/lib").glob("*/openblas-pthread/libblas.so.3")):
            missing.append("libopenblas0-pthread")
    if "chromium" in purposes and shutil.which("chromium") is None:
        missing.append("chromium")
    if "valgrind" in purposes and shutil.which("valgrind") is None:
        missing.append("valgrind")
    return missing


def rust_problem() -> str | None:
    """Say what is wrong with the machine's Rust; Cargo.toml tells how old it may be."""
    cargo = (Path(__file__).resolve().parents[1] / "Cargo.toml").read_text(encoding="utf-8")
    (needed,) = re.findall(r'^rust-version = "([\d.]+)"$', cargo, re.MULTILINE)
    remedy = f"install {needed} or later from https://rustup.rs"
    if shutil.which("rustc") is None or shutil.which("cargo") is None:
        return f"Rust is missing; {remedy}"
    shown = subprocess.run(
        ["rustc", "--version"], check=True, capture_output=True, text=True
    ).stdout
    found = shown.split()[1]
    numbers = [[int(part) for part in re.findall(r"\d+", text)[:2]] for text in (found, needed)]
    return f"Rust {found} is too old; {remedy}" if numbers[0] < numbers[1] else None


def is_loadable(name: str) -> bool:
    """Whether the dynamic linker finds the library."""
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True


if __name__ == "__main__":
    main()
