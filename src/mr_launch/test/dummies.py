"""Stand-ins for the programs of a team, so that the runner is tested without ROS, robots or minutes of driving.

python3 dummies.py radio|world|roslaunch ...   takes the command lines of the real programs
"""

import csv
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

STEP = 0.05  # s
SPEED = 20.0  # simulated over real seconds
EXPLORATION = 3.0  # s of simulation time until a robot is done


def option(name):
    return sys.argv[sys.argv.index(name) + 1]


def radio():
    control = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    control.bind(option("--control"))
    control.listen(4)
    for air in [words.split("=")[1] for words in sys.argv if "=air" in words]:
        socket.if_nametoindex(air)  # raises without the cable
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    print("radio: ready", flush=True)
    while True:
        time.sleep(1.0)
        Path(option("--statistics")).write_text(json.dumps({"frames": 1}))


def world():
    names = json.loads(os.environ["DUMMY_ROBOTS"])
    with open(option("--trace"), "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["time", "wall", "robot", "x", "y", "yaw", "v", "w", "stalled", "collision"])
        step = 0
        while True:
            now = step * STEP
            for index, name in enumerate(names):
                rows.writerow([now, time.time(), name, 1.0 + 0.5 * now * 0.1, 1.0 + index, 0.0, 0.05, 0.0, 0, 0])
            file.flush()
            step += 1
            time.sleep(STEP / SPEED)


def arguments():
    return dict(word.split(":=", 1) for word in sys.argv if ":=" in word)


def roslaunch():
    """Has a grandchild that ignores every polite signal, and a monitor."""
    subprocess.Popen(
        [
            sys.executable,
            "-c",
            "import signal, time\nfor s in (1, 2, 15): signal.signal(s, signal.SIG_IGN)\ntime.sleep(1000)",
        ],
        start_new_session=True,
    )
    values = arguments()
    if os.environ.get("DUMMY_DEAF") == values["robot_name"]:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        print("deaf", flush=True)
        time.sleep(1000.0)
    if os.environ.get("DUMMY_DIES") == values["robot_name"]:
        threading.Timer(1.0, died).start()
    signal.signal(signal.SIGINT, lambda *_: os._exit(0))
    monitor(values)


def died():
    print(
        "[explorer-4] process has died [pid 77, exit code 3, cmd /x/explorer].\nlog file: /x/explorer-4*.log",
        flush=True,
    )


def team_key():
    Path(sys.argv[3]).touch()


def monitor(values):
    link = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    link.connect(values["report_socket"])
    link.settimeout(0.05)
    begin, started, report = time.monotonic(), None, {"robot": values["robot_name"], "missing": []}
    while True:
        now = (time.monotonic() - begin) * SPEED
        try:
            requests = [json.loads(line) for line in link.recv(65536).splitlines()]
        except socket.timeout:
            requests = []
        for request in requests:
            if request["request"] == "start":
                if os.environ.get("DUMMY_ENDS") == values["robot_name"] and not values["bag"].endswith("_2.bag"):
                    os._exit(1)
                started = now
                report.update(started=True, start_time=1.0)
            else:
                import numpy as np  # here, because a team has five dummies, and each would take its time to import it

                cells = np.zeros((20, 30), np.int8)
                cells[0] = 100
                np.savez(request["path"], cells=cells, resolution=0.05, origin=np.array([-0.2, -0.3]))
                report.update(saved=request["path"])
        done = started is not None and now - started > EXPLORATION and not os.environ.get("DUMMY_ENDLESS")
        report.update(
            time=now,
            state=4 if done else 1,
            exploration_finished=done,
            exploration_time=EXPLORATION,
            coverage=0.5,
            radio={"frames_sent": 5, "bytes_sent": 500, "packets_received_by_hops": [3, 1]},
        )
        link.sendall(json.dumps(report).encode() + b"\n")


if __name__ == "__main__":
    {"radio": radio, "team_key": team_key, "world": world, "roslaunch": roslaunch}[sys.argv[1]]()
