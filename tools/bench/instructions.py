"""Count the instructions of small fixed works, and compare them with a stored run.

python -m tools.bench.instructions [--store] [WORK ...]

Fails if a work takes more than TOLERANCE more than in the stored run. Counts are of one thread
under Valgrind, which shows every program the same processor: they do not depend on what else the
machine does. They say nothing about memory traffic and threads; `make bench` does.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

STORED = Path(__file__).with_suffix(".json")
# Runs of one build differ by 1e-7; a change elsewhere moved works that it does not touch by 1e-4,
# and the smallest of all by 1 %, where the compiler inlined differently.
TOLERANCE = 0.02


def main() -> None:
    """Exit with a message if a work got slower."""
    parser = argparse.ArgumentParser(prog="make bench-check", description=__doc__)
    parser.add_argument("--store", action="store_true", help="make this the stored run")
    parser.add_argument("works", nargs="*", help="all, if none is named")
    arguments = parser.parse_args()
    program = built()
    names = arguments.works or listed(program)
    if arguments.store and arguments.works:
        sys.exit("--store stores all works: name none")
    # The counts are of one thread each, so as many run side by side as there are processors.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        counts = dict(zip(names, pool.map(lambda name: counted(program, name), names), strict=True))
    stored = json.loads(STORED.read_text(encoding="utf-8")) if STORED.is_file() else {}
    before = stored.get("instructions", {})
    for line in table(counts, before):
        print(line)
    if arguments.store:
        record = {"versions": versions(), "instructions": counts}
        STORED.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
        return
    if stored.get("versions") != versions():
        print(f"The stored run was with {stored.get('versions')}, this one with {versions()}:")
        print(
            "if works differ, check out the commit that stored it and compare with --store there."
        )
    problems = differences(counts, before, is_complete=not arguments.works)
    if problems:
        sys.exit("\n".join(problems))


def built() -> Path:
    """Build the works, and return the program."""
    command = ["cargo", "bench", "--package", "spectral-tv", "--features", "internals"]
    command += ["--bench", "works", "--no-run"]
    done = subprocess.run(
        [*command, "--message-format", "json"], stdout=subprocess.PIPE, text=True, check=True
    )
    messages = [json.loads(line) for line in done.stdout.splitlines()]
    (program,) = (message["executable"] for message in messages if message.get("executable"))
    return Path(program)


def listed(program: Path) -> list[str]:
    """The names of all works."""
    done = subprocess.run([program], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def counted(program: Path, name: str) -> int:
    """Instructions of a process that does one work."""
    command = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]
    done = subprocess.run([*command, program, name], capture_output=True, text=True, check=False)
    found = re.search(r"I +refs: +([\d,]+)", done.stderr)
    if done.returncode or found is None:
        sys.exit(f"{name}: valgrind failed:\n{done.stderr}")
    print(f"{name}: counted", file=sys.stderr, flush=True)
    return int(found[1].replace(",", ""))


def table(counts: dict[str, int], before: dict[str, int]) -> list[str]:
    """Lines of what was counted, in millions, next to what is stored."""
    lines = ["| work | stored | now | change |", "| --- | --- | --- | --- |"]
    for name, count in counts.items():
        known = before.get(name)
        stored = "–" if known is None else f"{known / 1e6:.1f}"
        change = "new" if known is None else f"{count / known - 1:+.2%}"
        lines.append(f"| {name} | {stored} | {count / 1e6:.1f} | {change} |")
    return lines


def differences(
    counts: dict[str, int], before: dict[str, int], *, is_complete: bool = True
) -> list[str]:
    """What has to be looked at: works that got slower, or are not in both runs."""
    problems = [
        f"{name}: {counts[name] / known - 1:+.2%} instructions, more than {TOLERANCE:.0%}"
        for name, known in before.items()
        if name in counts and counts[name] > known * (1 + TOLERANCE)
    ]
    problems += [f"{name}: not stored; use --store" for name in counts if name not in before]
    if is_complete:
        problems += [f"{name}: stored, but no longer a work" for name in before.keys() - counts]
    return problems


def versions() -> dict[str, str]:
    """What counts depend on besides the code."""

    def told(*command: str) -> str:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    return {
        "rustc": told("rustc", "--version"),
        "valgrind": told("valgrind", "--version"),
        "libc": " ".join(platform.libc_ver()),
        "machine": platform.machine(),
    }


if __name__ == "__main__":
    main()
