"""A plugin for pytest: files of tests that need a library which is not there are skipped."""

from __future__ import annotations

from collections.abc import Generator
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parents[2] / "tests"


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Turn the failure to read such a file into a skip."""
    report = yield
    call: pytest.CallInfo[object] | None = getattr(report, "call", None)
    cause = call.excinfo.value.__cause__ if call is not None and call.excinfo else None
    if isinstance(cause, ModuleNotFoundError) and is_of_others(cause.name or ""):
        report.outcome = "skipped"
        report.longrepr = (str(collector.path), 0, f"Skipped: needs {cause.name}")
    return report


def is_of_others(module: str) -> bool:
    """Whether a module is neither of the package nor of its tests."""
    name = module.partition(".")[0]
    return name != "spectral_tv" and not (TESTS / f"{name}.py").exists()
