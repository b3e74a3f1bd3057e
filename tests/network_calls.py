"""The calls of a program to the network, as the system sees them."""

from __future__ import annotations

from pathlib import Path

# What sockets within the machine, AF_UNIX and AF_NETLINK, have not.
NETWORKS = ("AF_INET", "AF_PACKET")


def traced(log: Path) -> list[str]:
    """What has a command write its network calls, and those of its processes, to a file."""
    return ["strace", "-f", "-qq", "--signal=none", "-e", "trace=%network", "-o", str(log)]


def network_calls(log: Path) -> list[str]:
    """Those in that file that name a network."""
    calls = log.read_text(encoding="utf-8", errors="replace").splitlines()
    return [call for call in calls if any(network in call for network in NETWORKS)]
