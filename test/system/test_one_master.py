"""Two robots explore the small world under one master, by the launch file that people use."""

import json
import os
import subprocess
import sys
from pathlib import Path

AREA = 50.0  # m^2 of the 64 m^2 of the world, without walls and furniture
HERE = Path(__file__).parent


def test_two_robots_explore_under_one_master(tmp_path: Path) -> None:
    names = {"ROS_MASTER_URI": "http://localhost:11311", "ROS_HOSTNAME": "localhost"}
    folders = {"ROS_HOME": str(tmp_path), "ROS_LOG_DIR": str(tmp_path / "log")}
    inside = f"ip link set lo up && exec {sys.executable} {HERE / 'one_master.py'}"
    run = subprocess.run(
        ["unshare", "--map-root-user", "--net", "sh", "-c", inside],
        env={**os.environ, **names, **folders},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    found = json.loads(run.stdout.splitlines()[-1])
    for name, other in (("robot_0", "robot_1"), ("robot_1", "robot_0")):
        robot = found[name]
        assert robot["text"] == "finished, at home" and robot["placed"] == [other], found
        assert robot["area"] >= AREA and robot["frame"].strip("/") == f"{name}/map", found
