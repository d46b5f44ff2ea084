"""What a test does with each command of the README and the tutorials: how it is shortened, or why it is not run.

A command that no row fits fails the test, and so does a row that no command fits.
"""

import re
from enum import Enum
from typing import Dict, Optional, Pattern


class Where(Enum):
    """`ALONE`: needs nothing. `MISSION`: is the mission of the others, until Ctrl-C. `DURING`, `AFTER`: needs that
    mission running, or its results."""

    ALONE = "alone"
    MISSION = "mission"
    DURING = "during"
    AFTER = "after"


RADIO = "sets up a wireless card, as root"
BUILDS = "installs and builds: what every test needs before it begins"
SYSTEM = "changes the user's system, as root"

NOT_RUN: Dict[Pattern[str], str] = {
    re.compile(words): reason
    for words, reason in {
        r"make (demo|build)\b": BUILDS,
        r"make test\b": "this test is a part of it",
        r"git stash\b": "changes the checkout",
        r"scp ": "needs another computer",
        r"sudo (nmcli|ip|iw) ": RADIO,
        r"sudo systemctl ": SYSTEM,
        r"sudo (setcap|apt|cp|useradd|install) ": SYSTEM,
        r"(printf|echo) .*\| sudo tee ": SYSTEM,
        r"journalctl ": "needs the services of a real robot",
        r"rosrun mr_launch enter robot_0 rviz ": "needs a display",
        r"tools/bench_missions ": "whole missions in real time, a minute at least",
        r"rosrun mr_experiments reference ": "ten missions at least; test_map_reference makes one of shorter ones",
        r"python3 -m pytest src/mr_experiments/test/test_guard.py": "a minute; is a test of mr_experiments by itself",
    }.items()
}

MISSIONS = r"rosrun mr_launch team "
RUNS = r"rosrun mr_experiments run "

# Each pattern is replaced in every command that it is found in, in this order.
SHORTENED: Dict[Pattern[str], str] = {
    re.compile(words): instead
    for words, instead in {
        # The mission of all others: the one with a page, of three robots, on a port that is free.
        r"^rosrun mr_launch team --page$": "rosrun mr_launch team --robots 3 --page {port}",
        # Further missions begin, and end after a second.
        rf"^({MISSIONS}(?!--robots 3 --page).*?)( --robots \d)?$": r"\1 --robots 1 --no-bag --duration 1",
        # Missions in virtual time: one, of one robot, in the small world; fast ones where nothing else is asked for.
        rf"^({RUNS}.*)--trials \d+": r"\1--trials 1",
        rf"^({RUNS}.*)--robots [\d ]*\d": r"\1--robots 1",
        rf"^({RUNS}(?!.*--world).*)$": r"\1 --world small8x8 --scenario fast",
        rf"^({RUNS}.*my_flat.world)": r"\1 --robots 1",
        rf"^({RUNS}.*hall:3:)40x25": r"\g<1>15x12",
        r"office26x15-r3-paper-7-s5001": "small8x8-r1-fast-7-s5001",
        r"small8x8-r2-paper-7-s1": "small8x8-r1-paper-7-s1",
        r"^(rosrun mr_experiments scenes) --robots 3": r"\1 --world small8x8 --robots 1",
        # Tables and pages of the repository stay as they are.
        r"docs/results/data/": "out/data/",
        r"out/bench/explore.json": "agreement.json",
        r"^(rosrun mr_experiments publish pages) docs/results/README.md": r"\1 --check docs/results/README.md",
        # A real robot: no wlan0 here, so its nodes are read and named, not started.
        r"^roslaunch (.*interface:=wlan0.*|mr_launch .*|explorer .*|mr_sim .*)$": r"roslaunch --nodes \1",
        # In a simulated team anna and bob are robot_0 and robot_1, as the tutorials say.
        r"^(rosservice call|rostopic|python3 docs/examples/send_battery.py|rosrun adhoc_communication adhoc_top)":
            r"rosrun mr_launch enter robot_0 \1",
        r"\bbob\b(?= greeting|,|$)": "robot_1",
        r"^(rosrun mr_launch replay .*)--rate 4": r"\1--rate 30",
        r"^(rosrun mr_launch replay records .*)": r"\1 --rate 30",
    }.items()
}  # fmt: skip

DURING = re.compile(r"^rosrun mr_launch enter ")
AFTER = re.compile(r"^rosrun mr_launch (export|replay) ")


def reason_not_to_run(line: str) -> Optional[str]:
    return next((reason for words, reason in NOT_RUN.items() if words.match(line)), None)


def shortened(line: str) -> str:
    for words, instead in SHORTENED.items():
        line = words.sub(instead, line)
    return line


def where(line: str) -> Where:
    """Of a line that was shortened."""
    if line.startswith("rosrun mr_launch team ") and "--page" in line:
        return Where.MISSION
    return Where.DURING if DURING.match(line) else Where.AFTER if AFTER.match(line) else Where.ALONE
