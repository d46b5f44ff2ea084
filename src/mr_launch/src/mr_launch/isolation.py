"""How the processes of a team are kept apart from the machine, and how that is found out.

``namespaces``: everything runs below one process that is PID 1 of its own PID namespace. When it ends, in whatever
way, the kernel kills the rest, and with the last process the network namespaces, interfaces, mounts and sockets in the
private file system go too. Root does this directly, other users in a user namespace of their own.
``hub``: where the system grants no namespaces. Masters sit on ports of their own, the radio uses Unix sockets, and a
supervisor ends what it started.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Sequence

NAMESPACES = "namespaces"
USER_NAMESPACES = "user namespaces"
HUB = "hub"

# Hides nothing a team needs: its sockets live here, on a file system that nobody else sees.
PRIVATE_MOUNT = "/dev/shm"

# Variables of whoever starts or enters a team that would mislead its programs.
MISLEADING = ("ROS_IP", "ROS_NAMESPACE", "ROS_ROOT_LOG")

_PROBE = (
    "mount -t tmpfs -o mode=0755 none " + PRIVATE_MOUNT + " && "
    "ip link add air0 type veth peer name radio0 && ip link set lo up && ip link set air0 up && "
    "/usr/bin/python3 -c 'import socket; socket.socket(socket.AF_PACKET, socket.SOCK_RAW, 0)' && "
    "unshare --net true"
)


def enter_command(isolation: str) -> list[str]:
    """The command prefix that starts a program as PID 1 of fresh namespaces; empty for ``hub``."""
    if isolation == HUB:
        return []
    user = ["--user", "--map-root-user"] if isolation == USER_NAMESPACES else []
    return ["unshare", *user, "--pid", "--fork", "--kill-child", "--mount", "--mount-proc", "--net", "--"]


def probe(isolation: str) -> str:
    """Empty if this isolation works on this machine, otherwise what the system said (one line)."""
    try:
        result = subprocess.run(
            [*enter_command(isolation), "sh", "-c", _PROBE],
            capture_output=True,
            text=True,
            timeout=20,
            check=False,
            env={**os.environ, "PATH": search_path(os.environ.get("PATH", ""))},
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return str(error)
    if result.returncode == 0:
        return ""
    lines = [line for line in result.stderr.splitlines() if line.strip()]
    return lines[-1] if lines else f"exit code {result.returncode}"


def choose(wish: str, user_id: int) -> tuple[str, str]:
    """The isolation to use for the option ``--isolation``, and the reason if it is only the hub."""
    if wish == HUB:
        return HUB, "as asked for"
    reasons = []
    for candidate in ([NAMESPACES] if user_id == 0 else []) + [USER_NAMESPACES]:
        reason = probe(candidate)
        if not reason:
            return candidate, ""
        reasons.append(reason)
    return HUB, reasons[-1]


def search_path(path: str) -> str:
    """PATH with the system's own programs first, so that another ``python3`` does not run ROS nodes."""
    return os.pathsep.join(
        dict.fromkeys(["/usr/bin", "/bin", "/usr/sbin", "/sbin", *filter(None, path.split(os.pathsep))])
    )


def child_of(pid: int) -> int | None:
    """The only child of ``unshare --fork``: PID 1 of the new namespace, as seen from outside."""
    try:
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except OSError:
        return None
    return int(children[0]) if children else None


def command_inside(
    isolation: str, init: int, holder: int | None, environment: dict[str, str], folder: str, command: Sequence[str]
) -> list[str]:
    """The command line that runs ``command`` in a robot's namespace of a running team.

    Args:
        isolation: of the running team.
        init: process id of the team's first process, as seen by the caller.
        holder: process id of the robot's namespace holder, as seen inside the team; None without namespaces.
        environment: variables to set (ROS_MASTER_URI and others); MISLEADING ones are taken away.
        folder: working directory.
        command: program and arguments.
    """
    without = [f"--unset={name}" for name in MISLEADING]
    tail = ["env", "-C", folder, *without, *(f"{name}={value}" for name, value in environment.items()), *command]
    if isolation == HUB or holder is None:
        return tail
    user = ["--user", "--preserve-credentials"] if isolation == USER_NAMESPACES else []
    outer = ["nsenter", "--target", str(init), *user, "--mount", "--pid", "--"]
    return [*outer, "nsenter", "--target", str(holder), "--net", "--", *tail]
