"""Many files: which are taken, what one does to the others, and what is told."""

from __future__ import annotations

import hashlib
import os
import signal
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import psutil
import pytest
from many_files import (
    QUICK,
    left_behind,
    lines_of,
    serving,
    start,
    wait_for,
    write_broken,
    write_endless,
    write_good,
    write_huge,
    written_in,
)
from spectral_tv.batches.inputs import inputs_of
from spectral_tv.cli import process_files
from spectral_tv.cli.verbs import run


@pytest.fixture
def out(tmp_path: Path) -> Path:
    (tmp_path / "out").mkdir()
    return tmp_path / "out"


def test_folders_patterns_and_lists_stand_for_files(tmp_path: Path, monkeypatch):
    good = write_good(tmp_path / "in", 4)
    for name in (".hidden.ply", "notes.txt", "results/old.ply"):
        path = tmp_path / "in" / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"")
    (tmp_path / "list.txt").write_text(f"{good[3]}\n\n{good[1]}\n")

    def found(*names: str, list_: Path | None = None):
        return inputs_of([Path(name) for name in names], list_, {".ply"}, Path("in/results"))

    monkeypatch.chdir(tmp_path)
    in_folder = found("in")
    assert [path.name[5:8] for path in in_folder.files] == ["000", "002", "001", "003"]
    assert {str(path) for path in in_folder.beneath.values()} == {".", "deep"}
    assert [path.name[5:8] for path in found("in/**/*_00[12].ply").files] == ["001", "002"]
    assert found(list_=tmp_path / "list.txt").files == [good[3], good[1]]
    assert len(found("in", "in/*.ply").files) == 4
    assert found("missing.ply").files == [Path("missing.ply")]  # told when its turn comes


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "name an INPUT"),
        (["nothing/*.ply"], "no file has a name like nothing/*.ply"),
        (["out"], "there is no file in the folder out that can be read"),
        (["--files-from", "missing.txt"], "--files-from missing.txt: "),
        (["in", "--shard", "3/2"], "'3/2' is not I/N"),
        (["in", "--jobs", "0"], "--jobs"),
        (["in", "--jobs", "2", "--scheduler", "local"], "--jobs is for this machine"),
    ],
)
def test_what_stands_for_nothing_is_a_wrong_argument(
    tmp_path: Path, out: Path, capfd, monkeypatch, arguments, message
):
    write_good(tmp_path / "in", 1)
    monkeypatch.chdir(tmp_path)
    assert run(["decompose", *arguments, "-o", "out", *QUICK]) == 2
    assert message in capfd.readouterr().err


def test_shares_are_all_files_once(tmp_path: Path, out: Path):
    good = write_good(tmp_path / "in", 7)
    report = tmp_path / "report.jsonl"
    for number in (1, 2, 3):
        command = ["decompose", str(tmp_path / "in"), "-o", str(out), "--report", str(report)]
        assert run([*command, "--shard", f"{number}/3", *QUICK]) == 0
    assert sorted(line["input"] for line in lines_of(report)) == sorted(map(str, good))


def test_results_lie_as_deep_as_inputs_and_existing_ones_are_passed_over(
    tmp_path: Path, out: Path, capfd
):
    good = write_good(tmp_path / "in", 4)
    report = tmp_path / "report.jsonl"
    command = ["decompose", str(tmp_path / "in"), "-o", str(out), "--report", str(report)]
    command += ["--skip-existing", "--jobs", "2", *QUICK]
    assert run(command) == 0
    expected = {out / path.relative_to(tmp_path / "in") for path in good}
    assert {path for path in out.rglob("*") if path.is_file()} == expected
    done = lines_of(report)
    assert {line["status"] for line in done} == {"done"}
    for line in done:
        content = Path(line["input"]).read_bytes()
        assert line["digest"] == hashlib.sha256(content).hexdigest()
        assert line["memory"] > 10_000_000
        assert line["seconds"] > 0
    (out / "deep" / "mesh_003.ply").unlink()
    capfd.readouterr()
    assert run(command) == 0
    again = lines_of(report)[4:]
    assert sorted(line["status"] for line in again) == ["done", "skipped", "skipped", "skipped"]
    assert "4 of 4 inputs succeeded, 3 of them skipped" in capfd.readouterr().err


def test_a_file_that_takes_too_long_or_too_much_ends_itself_alone(tmp_path: Path, out: Path):
    folder = tmp_path / "in"
    good, broken = write_good(folder, 6), write_broken(folder)
    endless = write_endless(folder / "endless.ply")
    huge = write_huge(folder / "huge.vtk")
    report = tmp_path / "report.jsonl"
    command = ["decompose", str(folder), "-o", str(out), "--format", "vtu", "--report", str(report)]
    assert run([*command, "--jobs", "2", "--timeout", "3", "--memory", "1.2"]) == 1
    reasons = {Path(line["input"]): line["error"] for line in lines_of(report)}
    assert set(reasons) == {*good, *broken, endless, huge}
    assert {path for path, reason in reasons.items() if reason is None} == set(good)
    assert reasons[endless] == "it took longer than 3 s"
    assert "memory" in reasons[huge]
    written = [path for path in out.rglob("*") if path.is_file()]
    assert {path.stem for path in written} == {path.stem for path in good}


def test_interrupted_and_started_again_it_goes_on(tmp_path: Path, out: Path):
    good = write_good(tmp_path / "in", 60)
    report = tmp_path / "report.jsonl"
    command = [tmp_path / "in", "-o", out, "--report", report, "--skip-existing", "--jobs", 2]
    first = start(*command, *QUICK)
    wait_for(lambda: len(lines_of(report)) >= 5)
    children = serving(first)
    first.send_signal(signal.SIGINT)
    told = first.communicate(timeout=60)[1]
    assert first.returncode == 128 + signal.SIGINT
    assert not any(child.is_running() for child in children)
    assert left_behind(out) == []
    done = [line for line in lines_of(report) if line["status"] == "done"]
    assert 5 <= len(done) < 60
    assert told.count(": not begun\n") + len(lines_of(report)) == 60
    second = start(*command, *QUICK)
    second.communicate(timeout=120)
    assert second.returncode == 0
    counts = [line["input"] for line in lines_of(report) if line["status"] == "done"]
    assert sorted(counts) == sorted(map(str, good))  # each once


@pytest.mark.skipif(sys.platform != "linux", reason="strace is Linux's")
@pytest.mark.parametrize("more", [["--jobs", 2], []])
def test_what_is_in_place_at_an_interruption_is_done(tmp_path: Path, out: Path, more):
    good = write_good(tmp_path / "in", 8)
    report = tmp_path / "report.jsonl"
    command = [tmp_path / "in" if more else good[0], "-o", out, "--report", report, *more]
    slow_disk = ["strace", "-D", "-f", "-qq", "--signal=none", "-o", os.devnull]
    slow_disk += ["-e", "trace=fsync", "-e", "inject=fsync:delay_exit=1000000"]
    first = start(*command, *QUICK, prefix=slow_disk)
    # A file is in place before the system tells so: its folder takes a second to reach the disk.
    wait_for(lambda: any(path.is_file() for path in written_in(out)))
    first.send_signal(signal.SIGINT)
    first.communicate(timeout=60)
    assert first.returncode == 128 + signal.SIGINT
    assert left_behind(out) == []
    done = [line for line in lines_of(report) if line["status"] == "done"]
    assert {Path(line["output"]) for line in done} == set(written_in(out))


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_a_process_that_is_killed_takes_one_file_along(tmp_path: Path, out: Path):
    write_good(tmp_path / "in", 40)
    report = tmp_path / "report.jsonl"
    process = start(tmp_path / "in", "-o", out, "--report", report, "--jobs", 2, *QUICK)
    wait_for(lambda: len(lines_of(report)) >= 3)
    serving(process)[0].send_signal(signal.SIGKILL)
    process.communicate(timeout=120)
    assert process.returncode == 1
    lines = lines_of(report)
    assert len(lines) == 40
    (failed,) = (line for line in lines if line["status"] == "failed")
    assert failed["error"].startswith("its process was ended by SIGKILL")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_processes_do_not_outlive_the_program(tmp_path: Path, out: Path):
    endless = write_endless(tmp_path / "endless.ply", 700)
    process = start(endless, "-o", out, "--timeout", 600)
    (child,) = wait_for(lambda: serving(process))
    wait_for(lambda: child.memory_info().rss > 300_000_000)
    process.kill()
    process.wait()
    assert child.wait(60) is not None or not child.is_running()
    assert list(out.iterdir()) == []


@pytest.mark.parametrize("pool", [ThreadPoolExecutor, ProcessPoolExecutor, None])
def test_any_executor_does_files(tmp_path: Path, out: Path, pool):
    good, broken = write_good(tmp_path / "in", 6), write_broken(tmp_path / "in")
    executor = pool(2) if pool is not None else None
    options = {"format": "npz", "gain": {1: 0, 2: 0.5}, "bands": 3, "steps": 8}
    found = list(process_files("decompose", [tmp_path / "in"], out, executor=executor, **options))
    if executor is not None:
        executor.shutdown()
    wait_for(lambda: not serving(psutil.Process()))  # none is left behind
    assert {Path(each["input"]) for each in found if each["status"] == "done"} == set(good)
    assert {Path(each["input"]) for each in found if each["error"]} == set(broken)
    settings = next(each["done"]["settings"] for each in found if each["done"])
    assert settings["gains"] == [(1, 0.0), (2, 0.5)] or settings["gains"] == [[1, 0.0], [2, 0.5]]
    again = process_files("decompose", good, out, format="npz", skip_existing=True, bands=3)
    assert [each["status"] for each in again if each["input"] == str(good[0])] == ["skipped"]


def test_wrong_arguments_of_the_function_are_told(tmp_path: Path):
    (path,) = write_good(tmp_path, 1)
    with pytest.raises(ValueError, match=r"there is no way to write \.foo"):
        list(process_files("decompose", [path], tmp_path / "out.foo"))
    with pytest.raises(ValueError, match="no-such"):
        list(process_files("decompose", [path], tmp_path / "out.ply", no_such=1))


def test_a_worker_elsewhere_finds_relative_names(tmp_path: Path, out: Path, monkeypatch):
    write_good(tmp_path / "in", 2)
    with ProcessPoolExecutor(1) as executor:
        executor.submit(os.getpid).result()  # its folder is the one of now
        monkeypatch.chdir(tmp_path)
        found = list(process_files("decompose", ["in"], "out", executor=executor, steps=8))
    assert [each["status"] for each in found] == ["done", "done"]
    assert (out / "mesh_000.ply").exists()
