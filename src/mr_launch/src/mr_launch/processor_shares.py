"""What share of a core the processes of each robot took."""

from __future__ import annotations

from typing import Mapping


def cpu_shares(
    before: Mapping[int, tuple[str, float, int]],
    after: Mapping[int, tuple[str, float, int]],
    launches: Mapping[str, int],
    seconds: float,
) -> dict[str, dict[str, float]]:
    """Share of one core by robot and process between two readings of processes.cpu_seconds.

    ``launches`` maps a robot to the process id of its roslaunch; what is below none of them counts as ``team``.
    """
    owners = {pid: name for name, pid in launches.items()}
    shares: dict[str, dict[str, float]] = {}
    for pid, (command, used, _) in after.items():
        share = (used - before.get(pid, ("", 0.0, 0))[1]) / seconds if seconds > 0 else 0.0
        if share < 0.0005:
            continue
        owner = _owner(pid, after, owners)
        name = process_name(command)
        shares.setdefault(owner, {})
        shares[owner][name] = round(shares[owner].get(name, 0.0) + share, 4)
    return {owner: dict(sorted(values.items(), key=lambda item: -item[1])) for owner, values in sorted(shares.items())}


def _owner(pid: int, table: Mapping[int, tuple[str, float, int]], owners: Mapping[int, str]) -> str:
    while pid in table:
        if pid in owners:
            return owners[pid]
        pid = table[pid][2]
    return "team"


def process_name(command: str) -> str:
    """ROS node name if the command line has one, otherwise the program's."""
    words = command.split()
    for word in words:
        if word.startswith("__name:="):
            return word[len("__name:=") :]
    scripts = [word for word in words[1:2] if words and "python" in words[0]] or words[:1]
    if scripts == ["-m"]:
        scripts = words[2:3]
    return scripts[0].rsplit("/", 1)[-1] if scripts else "?"
