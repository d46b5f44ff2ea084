"""Runs a team of dummies, ends it in one of several ways and lists what stays behind.

    leftovers.py FOLDER ISOLATION END    END: finish | interrupt | terminate | kill | kill-tree | crash

Call it in fresh PID, network and mount namespaces (``unshare -pnf --mount-proc``): then every process, interface and
socket that it finds was left by the team. Prints one JSON object with the exit code and the leftovers.
"""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
UNPRIVILEGED = 65534  # the user "nobody"


def snapshot(folder):
    """Everything a team could leave, by kind."""
    pids = [entry.name for entry in Path("/proc").iterdir() if entry.name.isdigit()]
    network = set()
    for pid in pids:
        try:
            network.add(os.readlink(f"/proc/{pid}/ns/net"))
        except OSError:
            continue
    links = subprocess.run(["ip", "-o", "link"], capture_output=True, text=True, check=True).stdout
    sockets = re.findall(r"(\S+)$", Path("/proc/net/unix").read_text(), re.MULTILINE)
    return {
        "processes": {f"{pid} {command_line(pid)}" for pid in pids},
        "network namespaces": network,
        "links": {line.split(": ")[1] for line in links.splitlines()},
        "sockets": {path for path in sockets if path.startswith(("/", "@"))},
        "mounts": set(Path("/proc/self/mounts").read_text().splitlines()),
        "named namespaces": set(os.listdir("/run/netns")) if Path("/run/netns").exists() else set(),
        "temporary folders": {name for name in os.listdir("/tmp") if name.startswith("mr_launch-")},
    }


def command_line(pid):
    try:
        return (Path("/proc") / pid / "cmdline").read_bytes().replace(b"\0", b" ").decode()[:150]
    except OSError:
        return "gone"


def start(folder, isolation, end):
    environment = {**os.environ}
    if end != "finish":
        environment["DUMMY_ENDLESS"] = "1"
    if end == "crash":
        environment["DUMMY_DIES"] = "robot_1"
    command = [sys.executable, str(HERE / "dummy_team.py"), str(folder / "out"), isolation]
    if isolation != "namespaces" and os.geteuid() == 0 and not in_user_namespace():
        command = ["setpriv", f"--reuid={UNPRIVILEGED}", f"--regid={UNPRIVILEGED}", "--clear-groups", *command]
    output = (folder / "output").open("wb")
    return subprocess.Popen(command, env=environment, stdout=output, stderr=output, start_new_session=True)


def in_user_namespace():
    return Path("/proc/self/uid_map").read_text().split() != ["0", "0", "4294967295"]


def wait_for_mission(process, folder):
    """Until the robots explore, as the team itself says."""
    while process.poll() is None and "\nexploring" not in (folder / "output").read_text():
        time.sleep(0.02)


def finish(process, end):
    """End the team as asked and return its exit code, once nothing can be on its way out any more."""
    if end == "interrupt":
        process.send_signal(signal.SIGINT)
    elif end == "terminate":
        process.terminate()
    elif end == "kill":
        process.kill()
    elif end == "kill-tree":  # parent and its child in one blow, as a closing session or an out-of-memory killer may
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        for pid in [process.pid, *map(int, children)]:
            os.kill(pid, signal.SIGKILL)
    return process.wait()


def reap_orphans():
    """What PID 1 of any machine does with processes whose parent was killed."""
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        pass


def settled(before, folder, patience=15.0):
    """The last snapshot: as soon as nothing is left, or after ``patience`` s."""
    deadline = time.monotonic() + patience
    while True:
        reap_orphans()
        after = snapshot(folder)
        left = {kind: sorted(after[kind] - before[kind]) for kind in after if after[kind] - before[kind]}
        if not left or time.monotonic() > deadline:
            return left
        time.sleep(0.05)


def main():
    folder, isolation, end = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    before = snapshot(folder)
    process = start(folder, isolation, end)
    if end not in ("finish", "crash"):
        wait_for_mission(process, folder)
    during = snapshot(folder)
    code = finish(process, end)
    left = settled(before, folder)
    print(json.dumps({"code": code, "left": left, "processes_during": len(during["processes"])}))


if __name__ == "__main__":
    main()
