"""What a test does with each command of the pages: how it is shortened, or why it is not run.

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
SYSTEM = "changes the user's system, as root"

NOT_RUN: Dict[Pattern[str], str] = {
    re.compile(words): reason
    for words, reason in {
        r"git (clone|worktree) ": "makes another checkout",
        r"cd (multi_robot_exploration|\.\./before)$": "goes into a checkout that is not made",
        r"(scp|ssh) ": "needs another computer",
        r"sudo docker ": "needs a container runtime, a network and a robot's serial port",
        r"sudo (nmcli|ip|iw) ": RADIO,
        r"iw (dev wlan0|list|phy)\b": "looks at a wireless card",
        r"sudo systemctl ": SYSTEM,
        r"sudo (setcap|apt|apt-get|cp|useradd|install) ": SYSTEM,
        r"(printf|echo) .*\| sudo tee ": SYSTEM,
        r"journalctl ": "needs the services of a real robot",
        r"(rosrun mr_launch enter (--team \S+ )?robot_0 )?rviz |wireshark ": "needs a display",
        r"rosrun adhoc_communication radio --interface ": "needs interfaces; as the runner starts it in each mission",
        r"source tools/environment.sh && tools/build |cmake --build ": "is the build, or its tests",
        r"source tools/environment.sh && test/playback/record": "a mission whose bags replace those stored",
        r"rosrun mr_experiments agreement ": "takes what tools/bench_missions writes",
        r"tools/bench_missions ": "whole missions in real time, a minute at least",
        r"rosrun mr_experiments reference ": "ten missions at least; test_map_reference makes one of shorter ones",
        r"python3 (-m pytest )?src/mr_experiments/test/test_guard.py": "a minute; is a test by itself",
    }.items()
}

MISSIONS = r"rosrun mr_launch team "
RUNS = r"rosrun mr_experiments run "

# What only names a program is asked what it does.
NAMED = (
    r"python3 -m (?:map_merger register|explorer)"
    r"|rosrun (?:mr_launch team|mr_sim (?:stageros|world)|adhoc_communication team_key|mr_experiments (?:run|publish))"
)
ENTER = "rosrun mr_launch enter"
IN_ROBOT_0, IN_ROBOT_1, IN_BASE = f"{ENTER} robot_0", f"{ENTER} robot_1", f"{ENTER} base"
UNTIL_CTRL_C = "timeout --preserve-status --signal INT"

# Each pattern is replaced in every command that it is found in, in this order.
SHORTENED: Dict[Pattern[str], str] = {
    re.compile(words): instead
    for words, instead in {
        # Targets are read to their last command, not made; but the demo, without the build that it begins with.
        r"^make -C ../before ": "make ",
        r"^make demo$": 'make -o build demo DEMO_ARGUMENTS="--no-bag --duration 1"',
        r"^make demo DEMO_ARGUMENTS=\"--wall":
            'make -o build demo DEMO_ARGUMENTS="--robots 1 --no-bag --duration 1 --wall',
        r"^make (?!-o build)": "make -n ",
        rf"^({NAMED}|rosbag reindex|roscore|rostopic hz)$": r"\1 --help",
        r"^(rosrun mr_launch enter) robot_0$": r"\1 --help",
        r"^(rosrun mr_sim stageros) worlds/\S+$": r"\1 --help",
        # The mission of all others: the one with a page, of three robots and a base station, on a port that is free;
        # slow, so that the robots still explore when the last command comes.
        r"^rosrun mr_launch team --page$":
            "rosrun mr_launch team --robots 3 --topology centralized --page {port} --rtf 0.3 --duration 3600",
        # Further missions begin, and end after a second.
        rf"^({MISSIONS}(?!--robots 3 --topology|--help).*?)( --robots \d)?$": r"\1 --robots 1 --no-bag --duration 1",
        # Missions in virtual time: one, of one robot, in the small world; fast ones where nothing else is asked for.
        rf"^({RUNS}(?!--help).*)--trials \d+": r"\1--trials 1",
        rf"^({RUNS}(?!--help|.*--trials).*)$": r"\1 --trials 1",
        rf"^({RUNS}.*)--robots [\d ]*\d": r"\1--robots 1",
        rf"^({RUNS}(?!--help|.*--world).*)$": r"\1 --world small8x8 --scenario fast",
        rf"^({RUNS}.*my_flat.world)": r"\1 --robots 1",
        rf"^({RUNS}.*)--world (office26x15|generated:office:7)": r"\1--world small8x8 --scenario fast",
        rf"^({RUNS}.*hall:3:)40x25": r"\g<1>15x12",
        r"office26x15-r3-paper-7-s(5001|1)\b": r"small8x8-r1-fast-7-s\1",
        r"small8x8-r2-paper-7-s1": "small8x8-r1-paper-7-s1",
        r"^(rosrun mr_experiments scenes) --robots 3": r"\1 --world small8x8 --robots 1",
        # Tables and pages of the repository stay as they are.
        r"docs/results/data/": "out/data/",
        r"out/bench/navigation.json": "agreement.json",
        # Folders and files that other commands make, or the reader has.
        r"out/after --against out/before$": "out/experiments --against out/experiments",
        r"\.\./before/": "",
        r"out/bench/missions(/\$\(.*\))?$": "out/latest",
        r" RECORD$": " out/latest/record.json",
        r"^(rosrun mr_experiments movie \S+)$": r"\1 --seconds 1 --rate 2",
        r"^(python3 -m map_merger register) A.yaml B.yaml": r"\1" + 2 * " out/latest/robot_0/map.yaml",
        r"^(python3 -m map_merger merge) \*.yaml -o out": r"\1" + 2 * " out/latest/robot_0/map.yaml" + " -o out/merged",
        r" out/latest/robot_0/map.yaml --starts 0 0 0 ": " my_map.yaml --starts 2 2 0 ",
        r" map.yaml": " my_map.yaml",
        r"~/records": "records",
        r"^(rosrun mr_experiments publish pages) docs/results/README.md": r"\1 --check docs/results/README.md",
        # A real robot: no wlan0 here, so its nodes are read and named, not started.
        r"^roslaunch (.*interface:=wlan0.*|mr_launch .*|explorer .*|mr_sim .*|mr_page .*)$": r"roslaunch --nodes \1",
        # What goes on until Ctrl-C does not.
        r"^rosrun adhoc_communication radio --hub /tmp/hub":
            f"{UNTIL_CTRL_C} 2 rosrun adhoc_communication radio --hub out/hub",
        r"^rosrun mr_page team_page --feeds /tmp/page (.*)$":
            rf"{UNTIL_CTRL_C} 5 rosrun mr_page team_page --feeds out/page --port 0 \1",
        r"^rosrun explorer mission_control (.*)$":
            rf"{UNTIL_CTRL_C} 5 {IN_BASE} rosrun explorer mission_control __name:=another \1",
        r"^rostopic hz (?!--help)": f"{UNTIL_CTRL_C} 5 rostopic hz ",
        r"^((?:rosrun mr_launch enter \S+ )?rostopic echo) (?!-n1)": r"\1 -n1 ",
        r"^(rostopic echo -n1 (?:/greeting|/team/battery))$": rf"{IN_ROBOT_1} \1",  # as the page says, on bob
        r"^(rosrun tf2_tools echo.py) ": r"\1 -l 1 ",
        r"^(rosrun adhoc_communication adhoc_top)$": r"\1 --once",
        # Orders to all robots are for the mission's own base; those that would end the mission are only there.
        r"^(rostopic echo -n1 /mission_control/team|rosservice call /mission_control/set_limits .*)$": rf"{IN_BASE} \1",
        r"^(rosservice call /mission_control/order).*\[bob\].*$":
            rf'{IN_BASE} \1 "{{order: pause, robots: [robot_1]}}"',
        r"^rosservice call (/mission_control/(?:start|pause|resume|go_home))$": rf"{IN_BASE} rosservice info \1",
        rf"^{ENTER} --team out/again ": f"{ENTER} ",
        # What a page says of a robot that stands, waits, has another sensor, or is not simulated; robot_1 is held.
        r"^rostopic echo -n1 /cmd_vel$": "rostopic type /cmd_vel",
        r"^rosservice call /explorer/resume$":
            f"{IN_ROBOT_1} rosservice call /explorer/resume && {IN_ROBOT_1} rosservice call /explorer/pause",
        r"^rosservice call /explorer/start$": f"{IN_ROBOT_0} rosservice info /explorer/start",
        r"(?<= )/scan\b": "/base_scan",
        r"(?<=base_link )laser$": "base_laser_link",
        r"^rosparam set /use_sim_time false$": "rosparam get /use_sim_time",
        r"^(rosrun mr_launch doctor)(?: --interface wlan0)?(?= --peers|$)": rf"{IN_ROBOT_0} \1",
        # Files that pages take from the reader.
        r"(--robot) my_robot.yaml$": r"\1 docs/examples/my_robot.yaml",
        r"^(rosrun adhoc_communication team_key) show team.key$": r"\1 create team.key && \1 show team.key",
        r"\bOUT/": "out/latest/",
        # In a simulated team anna and bob are robot_0 and robot_1, as the tutorials say.
        r"^(rosservice call|rostopic (?!hz --help)|rosnode|rosparam|timeout .* rostopic|rosrun tf2_tools"
        r"|python3 docs/examples/send_battery.py|rosrun adhoc_communication adhoc_top)": rf"{IN_ROBOT_0} \1",
        r"\bbob\b(?= greeting|,|$)": "robot_1",
        r"^(rosrun mr_launch replay .*)--rate [24]\b": r"\1--rate 30",
        r"^(rosrun mr_launch replay (?!.*--rate).*)": r"\1 --rate 30",
    }.items()
}  # fmt: skip

DURING = re.compile(r"^(timeout .* )?rosrun mr_launch enter ")
AFTER = re.compile(
    r"^rosrun mr_(launch (export|replay)|experiments \w+ out/latest)|^python3 -m map_merger .*out/latest"
)
CHEAP = re.compile(r"^(make -n|roslaunch --(nodes|ros-args)) |.* --help$")


def reason_not_to_run(line: str) -> Optional[str]:
    return next((reason for words, reason in NOT_RUN.items() if words.match(line)), None)


def shortened(line: str) -> str:
    for words, instead in SHORTENED.items():
        line = words.sub(instead, line)
    return line


def is_cheap(line: str) -> bool:
    """Of a line that was shortened: it ends in a second, and starts nothing."""
    return CHEAP.match(line) is not None


def where(line: str) -> Where:
    """Of a line that was shortened."""
    if line.startswith("rosrun mr_launch team ") and "--page" in line:
        return Where.MISSION
    return Where.DURING if DURING.match(line) else Where.AFTER if AFTER.match(line) else Where.ALONE
