"""Many files on Dask: workers that are lost, an interruption, two hosts, and TLS."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from contextlib import ExitStack, contextmanager
from pathlib import Path

import psutil
import pytest
from many_files import (
    BROKEN,
    COMMAND,
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
)

GOOD = 193  # with the others, two hundred
ENDLESS, HUGE = "endless.ply", "huge.vtk"


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Two hundred meshes, some of them bad."""
    place = tmp_path_factory.mktemp("many") / "in"
    write_good(place, GOOD)
    write_broken(place)
    write_endless(place / ENDLESS)
    write_huge(place / HUGE)
    return place


def command_for(folder: Path, out: Path, report: Path, scheduler: str) -> list[object]:
    limits = ["--timeout", 4, "--memory", 1.2, "--scheduler", scheduler]
    return [folder, "-o", out, "--format", "off", "--report", report, "--skip-existing", *limits]


def check(folder: Path, out: Path, report: Path) -> None:
    """Every good file is done once and whole, every bad one is in the report with its reason."""
    lines = lines_of(report)
    done = [line["input"] for line in lines if line["status"] == "done"]
    assert len(done) == len(set(done))
    # What workers did while the run was interrupted was found, whole, by the next.
    skipped = {line["input"] for line in lines if line["status"] == "skipped"}
    assert len(skipped | set(done)) == GOOD
    written = [path for path in out.rglob("*") if path.is_file()]
    assert len(written) == GOOD
    for path in written:
        text = path.read_text()
        assert text.startswith("OFF")
        assert len(text.splitlines()) > 400  # 162 vertices, 320 triangles
    reasons = {Path(line["input"]).name: line["error"] for line in lines if line["error"]}
    assert reasons.pop(ENDLESS) == "it took longer than 4 s"
    assert "memory" in reasons.pop(HUGE)
    assert reasons.keys() == set(BROKEN), reasons
    assert left_behind(out) == []


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_on_a_local_cluster_what_is_lost_is_done_again(folder: Path, tmp_path: Path):
    out, report = tmp_path / "out", tmp_path / "report.jsonl"
    out.mkdir()
    command = [*command_for(folder, out, report, "local"), *QUICK]
    first = start(*command)
    wait_for(lambda: len(lines_of(report)) >= 20)
    worker = wait_for(lambda: serving(first))[0].parent()
    worker.kill()  # one of Dask's, with a task under work
    before = len(lines_of(report))
    wait_for(lambda: len(lines_of(report)) >= before + 20)
    first.send_signal(signal.SIGINT)
    told = first.communicate(timeout=60)[1]
    assert first.returncode == 128 + signal.SIGINT, told
    assert "dashboard: http://127.0.0.1:" in told
    assert sum(line["status"] == "done" for line in lines_of(report)) < GOOD
    second = start(*command)
    told = second.communicate(timeout=300)[1]
    assert second.returncode == 1, told
    check(folder, out, report)
    assert f"{GOOD} of 200 inputs succeeded" in told


def test_a_local_cluster_listens_on_loopback_alone(tmp_path: Path):
    out, report = tmp_path / "out", tmp_path / "report.jsonl"
    out.mkdir()
    write_good(tmp_path / "in", 30)
    process = start(tmp_path / "in", "-o", out, "--report", report, "--scheduler", "local", *QUICK)
    wait_for(lambda: len(lines_of(report)) >= 1)
    every = [psutil.Process(process.pid), *psutil.Process(process.pid).children(recursive=True)]
    listening = [
        each.laddr.ip
        for one in every
        for each in one.net_connections()
        if each.status == psutil.CONN_LISTEN
    ]
    process.communicate(timeout=120)
    assert process.returncode == 0
    assert listening
    assert set(listening) == {"127.0.0.1"}


def test_a_scheduler_that_does_not_answer_is_told(tmp_path: Path):
    (path,) = write_good(tmp_path, 1)
    options = ["--scheduler", "tcp:/nowhere"]
    process = start(path, "-o", tmp_path / "out.ply", *options)
    told = process.communicate(timeout=120)[1]
    assert process.returncode == 2
    assert "--scheduler tcp:/nowhere: " in told
    assert "Traceback" not in told


HOSTS = {"spectral-a": "10.77.0.1", "spectral-b": "10.77.0.2"}


def call(*command: object) -> None:
    subprocess.run([str(each) for each in command], check=True, capture_output=True)


@contextmanager
def two_hosts():
    """Two hosts with a wire between them, as network namespaces."""
    first, second = HOSTS
    try:
        for name in HOSTS:
            call("ip", "netns", "add", name)
        call(
            "ip",
            "link",
            "add",
            first,
            "netns",
            first,
            "type",
            "veth",
            "peer",
            second,
            "netns",
            second,
        )
        for name, address in HOSTS.items():
            inside = ["ip", "-n", name]
            call(*inside, "address", "add", f"{address}/24", "dev", name)
            call(*inside, "link", "set", name, "up")
            call(*inside, "link", "set", "lo", "up")
        yield
    finally:
        for name in HOSTS:
            subprocess.run(["ip", "netns", "del", name], check=False, capture_output=True)


def certificates(folder: Path) -> dict[str, str]:
    """A certificate for all hosts, as Dask's configuration in the environment."""
    key, certificate = folder / "key.pem", folder / "certificate.pem"
    call(
        *("openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", 1),
        *("-subj", "/CN=spectral-tv", "-keyout", key, "-out", certificate),
    )
    found = {"CA_FILE": certificate, "REQUIRE_ENCRYPTION": "true"}
    for role in ("CLIENT", "SCHEDULER", "WORKER"):
        found |= {f"{role}__CERT": certificate, f"{role}__KEY": key}
    start = "DASK_DISTRIBUTED__COMM__"
    return {
        start + (name if name == "REQUIRE_ENCRYPTION" else f"TLS__{name}"): str(value)
        for name, value in found.items()
    }


@pytest.mark.skipif(
    sys.platform != "linux" or os.geteuid() != 0 or shutil.which("ip") is None,
    reason="network namespaces need root on Linux, and ip",
)
def test_two_hosts_share_the_work_over_tls(folder: Path, tmp_path: Path):
    out, report = tmp_path / "out", tmp_path / "report.jsonl"
    out.mkdir()
    first = next(iter(HOSTS))
    address = f"tls://{HOSTS[first]}:8786"
    more = {"env": os.environ | certificates(tmp_path), "cwd": tmp_path}

    def on(host: str, *command: object, **others) -> subprocess.Popen[str]:
        line = ["ip", "netns", "exec", host, *map(str, command)]
        return subprocess.Popen(line, text=True, **{"stderr": subprocess.PIPE} | others)

    def dask(host: str, role: str, *options: object) -> subprocess.Popen[str]:
        module = f"distributed.cli.dask_{role}"
        quiet = more | {"stderr": subprocess.DEVNULL}  # nobody reads it while they run
        return on(host, sys.executable, "-m", module, "--no-dashboard", *options, **quiet)

    with two_hosts(), ExitStack() as stack:

        def ended(process: subprocess.Popen[str]) -> subprocess.Popen[str]:
            stack.callback(process.wait)
            stack.callback(process.terminate)
            return process

        ended(dask(first, "scheduler", "--host", HOSTS[first], "--protocol", "tls", "--port", 8786))
        resources = ["--nthreads", 1, "--resources", "memory=4e9"]
        workers = [ended(dask(host, "worker", address, *resources)) for host in HOSTS]
        command = [*COMMAND, *command_for(folder, out, report, address), *QUICK]
        run = on(first, *command, **more)
        wait_for(lambda: len(lines_of(report)) >= 20)
        assert serving(workers[1])  # the other host works too
        wait_for(lambda: serving(workers[1]))[0].parent().kill()
        before = len(lines_of(report))
        wait_for(lambda: len(lines_of(report)) >= before + 20)
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=60)
        assert run.returncode == 128 + signal.SIGINT
        again = on(first, *command, **more)
        told = again.communicate(timeout=300)[1]
        assert again.returncode == 1, told
        check(folder, out, report)
        refused = on(first, *command, cwd=tmp_path)  # it has no certificate
        assert "--scheduler tls://" in refused.communicate(timeout=120)[1]
        assert refused.returncode == 2
