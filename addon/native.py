"""Whether the native module is there, and is the one this extension was made with."""

import platform
import re
from importlib import import_module
from pathlib import Path

_HERE = Path(__file__).parent
_SYSTEMS = {"Darwin": "macos"}
_MACHINES = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64"}


def problem() -> str | None:
    """Return one sentence about what keeps the native module from being used, if anything."""
    try:
        found = import_module("spectral_tv").__version__
    except ModuleNotFoundError:
        brought = ", ".join(path.name for path in sorted(_HERE.glob("wheels/*.whl"))) or "none"
        suitable = f"spectral_tv-{version()}-{this_platform()}.zip"
        return (
            f"The native module for this system is missing: install {suitable}, "
            f"if there is one (this zip brought {brought})"
        )
    except ImportError as error:  # it is there, but the system's loader refuses it
        return f"The native module does not load on this system, {this_platform()}: {error}"
    if found != version():
        return (
            f"This is Spectral TV {version()}, but its native module is of version {found}: "
            "restart Blender; if that does not help, install the extension again"
        )
    return None


def version() -> str:
    """Return the version of the extension, which its build writes into the manifest."""
    manifest = (_HERE / "blender_manifest.toml").read_text(encoding="utf-8")
    return re.search(r'^version = "(.+)"', manifest, re.MULTILINE)[1]


def this_platform() -> str:
    """Name this platform as the extension's zips do, such as ``linux_x64``."""
    system, machine = platform.system(), platform.machine().lower()
    return f"{_SYSTEMS.get(system, system.lower())}_{_MACHINES.get(machine, machine)}"
