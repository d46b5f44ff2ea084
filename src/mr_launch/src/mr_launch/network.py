"""One network namespace per robot, tied to the radio by a cable (veth). Nothing has a name in the file system."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Mapping

from mr_launch.errors import TeamFailure
from mr_launch.plan import RobotPlan, link_commands, namespace_prefix
from mr_launch.processes import Child, Children


def switch_ipv6_off(prefix: list[str]) -> None:
    """No router solicitations on the air. Best effort: some machines have no IPv6 or a read-only /proc/sys."""
    script = "for d in all default; do echo 1 > /proc/sys/net/ipv6/conf/$d/disable_ipv6; done"
    with contextlib.suppress(OSError):
        subprocess.run([*prefix, "sh", "-c", script], capture_output=True, check=False)


def hold_namespace(name: str, children: Children, log: Path, environment: Mapping[str, str]) -> Child:
    """Start the process that keeps a robot's network namespace, and wait until it is there."""
    holder = children.start(f"namespace of {name}", ["unshare", "--net", "sleep", "infinity"], log, environment)
    own = os.readlink("/proc/self/ns/net")
    end = time.monotonic() + 10.0
    while time.monotonic() < end and holder.process.poll() is None:
        with contextlib.suppress(OSError):
            if os.readlink(f"/proc/{holder.process.pid}/ns/net") != own:
                return holder
        time.sleep(0.01)
    raise TeamFailure(f"no network namespace for {name}; the log is {log}")


def end_all_in_namespace(holder: int) -> None:
    """Kills what runs in the network namespace that process `holder` keeps, but for the holder."""
    try:
        network = os.readlink(f"/proc/{holder}/ns/net")
    except OSError as error:
        raise TeamFailure(f"the network namespace of process {holder} is gone: {error.strerror}") from None
    for entry in Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError):
            if int(entry.name) != holder and os.readlink(entry / "ns" / "net") == network:
                os.kill(int(entry.name), signal.SIGKILL)


def lay_cable(robot: RobotPlan, holder: int) -> None:
    """Connect the robot's namespace to the radio: ``radio0`` there, ``air<i>`` here, both up."""
    switch_ipv6_off(namespace_prefix(holder))
    for command in link_commands(robot, holder):
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            raise TeamFailure(f"no radio cable for {robot.name}: {' '.join(command)}: {result.stderr.strip()}")
