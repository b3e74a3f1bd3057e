"""Whenever the end is asked for, the report has what is in place, and nothing else, once."""

from __future__ import annotations

import os
import signal
import sys
from collections import Counter
from pathlib import Path

import pytest
from many_files import QUICK, left_behind, lines_of, write_good, written_in
from spectral_tv.cli.verbs import run

# A call is a function and how many of its calls were before.
Call = tuple[object, int]


def calls_of(arguments: list[object], files: set[str], moment: Call | None = None):
    """The exit code of a command to which Ctrl-C is sent at one of its calls, and these calls."""
    counts: Counter[object] = Counter()

    def count(frame, event, _argument):
        code = frame.f_code
        if event == "call" and "spectral_tv" in code.co_filename:
            if Path(code.co_filename).name not in files or code.co_name == "<genexpr>":
                return  # what is raised while one is closed is passed over
            call = code, counts[code]
            counts[code] += 1
            if call == moment:
                os.kill(os.getpid(), signal.SIGINT)

    former = sys.getprofile()
    sys.setprofile(count)
    try:
        return run(list(map(str, arguments))), counts
    finally:
        sys.setprofile(former)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for one process")
@pytest.mark.parametrize(
    ("more", "files"),
    [
        ([], {"batch.py", "command.py", "report.py", "signals.py"}),
        (["--jobs", 2], {"batch.py", "engines.py"}),
    ],
)
def test_at_any_call(tmp_path: Path, more, files):
    source = write_good(tmp_path / "in", 2)[0].parent
    arguments = ["decompose", *([source] if more else source.glob("*.ply")), *QUICK, *more]
    (tmp_path / "first").mkdir()
    code, counts = calls_of([*arguments, "-o", tmp_path / "first"], files)
    assert code == 0
    former = signal.signal(signal.SIGINT, signal.SIG_IGN)  # what comes too late
    codes, statuses = set(), set()
    try:
        for moment in [(each, count) for each in counts for count in range(min(counts[each], 2))]:
            out, report = tmp_path / f"out{len(statuses)}", tmp_path / "report.jsonl"
            out.mkdir(exist_ok=True)
            [path.unlink() for path in written_in(out)]
            report.unlink(missing_ok=True)
            code, _ = calls_of([*arguments, "-o", out, "--report", report], files, moment)
            lines = lines_of(report) if report.exists() else []
            found = {line["input"]: (line["status"], line["error"]) for line in lines}
            assert len(found) == len(lines), moment  # each once
            assert set(found.values()) <= {("done", None), ("failed", "interrupted")}, moment
            done = {Path(line["output"]) for line in lines if line["status"] == "done"}
            assert done == set(written_in(out)), moment
            assert left_behind(out) == []
            codes.add(code)
            statuses |= {status for status, _ in found.values()}
    finally:
        signal.signal(signal.SIGINT, former)
    assert codes - {0} == {128 + signal.SIGINT}
    assert statuses == {"done", "failed"}
