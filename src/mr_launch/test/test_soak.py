"""What a soak concludes from what it saw. The missions themselves run in `make soak`."""

import contextlib
import json
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from mr_launch.soak import command
from mr_launch.soak.command import main
from mr_launch.soak.faults import CLOCK_WRONG_S, NODES, disturbed, full_disk, partitions
from mr_launch.soak.leftovers import Leftovers
from mr_launch.soak.memory import Sample, Samples, cpu_share, memory_of, slope
from mr_launch.soak.missions import ROBOTS, Outcome
from mr_launch.soak.rows import ALL_NODES, LEAST_HOLD_S, OF_A_ROBOT, OWN_NODES, SETTLE_S, alone_rows, rows_of
from mr_launch.soak.running import CLOCK_OFFSET, Node, RunningMission, carried_out

SOURCES = Path(__file__).resolve().parents[2]
BEGIN, END = 100.0, 100.0 + LEAST_HOLD_S


def samples(rate, noise=0.0, first=50.0, settles=0.0):
    """From BEGIN to END; `rate` in MB per minute, `noise` in MB, `settles`: MB that are added in the first minutes."""

    def own(second):
        return first + rate * second / 60.0 + noise * (-1) ** second + settles * min(1.0, second / SETTLE_S)

    seconds = range(round(END - BEGIN) + 1)
    return [Sample(BEGIN + second, round(1e6 * first), round(1e6 * own(second)), 0.05 * second) for second in seconds]


ELSEWHERE = {"link", "mission_control", "velocity_override", "robot_state_publisher", "move_base_flex"}
"""Nodes of the launch files that a robot of a team does not start."""
AT_REST = dict.fromkeys(ALL_NODES, 0.0)


def outcome(rates, **changes):
    taken = Samples()
    for number, (name, rate) in enumerate(rates.items()):
        for robot in ROBOTS:
            taken.by_node[Node(robot, name, number)] = samples(rate if robot == "robot_1" else 0.0)
    values = {
        "name": "rest", "code": 0, "stuck": [], "left": [], "said": [], "faults": disturbed(ROBOTS, 0), "omitted": [],
        "restarts": {},
        "samples": taken, "exploring": (BEGIN, 220.0), "hold": (BEGIN, END), **changes,
    }  # fmt: skip
    return Outcome(**values)


def found(*outcomes, **options):
    return {row["what"]: row for row in rows_of(outcomes, **options)}


def test_slopes_and_shares():
    rate, error = slope(samples(3.0))
    assert rate == pytest.approx(3.0, abs=1e-4) and error < 1e-4
    rate, error = slope(samples(0.0, noise=1.0))
    assert abs(rate) < 2 * error < 0.6
    assert cpu_share(samples(0.0)) == pytest.approx(0.05)
    pss, own = memory_of(os.getpid())
    assert 1e6 < own < pss < 1e10


def test_a_leak_of_one_robot_is_seen():
    rows = found(outcome({**AT_REST, "explorer": 0.1, "map_merger": 0.5}))
    leak = rows["memory at rest: slope of map_merger, worst robot"]
    assert not leak["holds"] and leak["value"] == pytest.approx(0.5, abs=0.01)
    assert rows["memory at rest: slope of explorer, worst robot"]["holds"]


def test_what_settles_after_a_mission_is_no_leak_and_a_leak_is_not_hidden_by_it():
    taken = outcome(AT_REST)
    for node in list(taken.samples.by_node):
        taken.samples.by_node[node] = samples(0.0, settles=5.0)
    assert all(row["holds"] for row in found(taken).values())
    for node in list(taken.samples.by_node):
        taken.samples.by_node[node] = samples(0.3, settles=5.0)
    assert not found(taken)["memory at rest: slope of map_merger, worst robot"]["holds"]


def test_a_rest_that_is_cut_short_says_nothing():
    rows = found(outcome(AT_REST, hold=(BEGIN, END - 120.0)))
    short = rows["memory at rest: time to look at it"]
    assert not short["holds"] and short["value"] == 8.0 and not any("slope" in what for what in rows)


def test_a_short_soak_has_no_verdict_on_memory():
    short = (BEGIN, BEGIN + 150.0)
    rows = found(outcome({**AT_REST, "explorer": 3.0}, hold=short), long=False)
    leak = rows["memory at rest: slope of explorer, worst robot"]
    assert leak["bar"] == "no verdict" and leak["holds"] and leak["value"] == pytest.approx(3.0, abs=0.01)
    assert "2.5 min at rest; a verdict needs 15" in leak["detail"]
    without = {name: rate for name, rate in AT_REST.items() if name != "page"}
    assert not found(outcome(without, hold=short), long=False)["memory at rest: slope of page"]["holds"]


@pytest.mark.parametrize("name", ALL_NODES)
def test_a_node_whose_memory_was_not_seen_is_a_miss(name):
    """Once four had to be seen, and that of the page, which the mission at rest did not have, was none of them."""
    taken = outcome(AT_REST)
    (one,) = (node for node in taken.samples.by_node if (node.robot, node.name) == ("robot_2", name))
    del taken.samples.by_node[one]
    missed = found(taken)[f"memory at rest: slope of {name}"]
    assert not missed["holds"] and missed["detail"] == "not seen the whole time: robot_2"


def test_every_node_that_the_launch_files_start_has_to_be_seen():
    files = ("mr_launch/launch/robot", "mr_launch/launch/simulated_robot", "mr_launch/launch/recorder",
             "mr_page/launch/page", "mr_robot/launch/slam", "mr_robot/launch/move_base")  # fmt: skip
    roots = [ElementTree.parse(f"{SOURCES}/{name}.launch").getroot() for name in files]
    started = {node.get("name") for root in roots for node in root.iter("node")}
    assert started - ELSEWHERE | {"roslaunch", "master", "rosout", "monitor"} == set(ALL_NODES)


def test_what_one_robot_needs():
    rows = found(outcome({**AT_REST, "slam": 0.0}))
    cpu, memory = (rows[f"own nodes of a robot, R = 3: {what}, worst robot"] for what in ("CPU", "memory (PSS)"))
    assert cpu["value"] == pytest.approx(0.2) and memory["value"] == pytest.approx(200.0), "SLAM is not counted"
    assert cpu["holds"] and memory["holds"]
    rows = found(outcome(dict(list(AT_REST.items())[1:])))
    assert not any(rows[what]["holds"] for what in rows if what.startswith("own nodes"))
    assert not rows[f"memory at rest: slope of {OWN_NODES[0]}"]["holds"], "it was not seen"


def alone(**changes):
    (row,) = alone_rows(outcome(dict.fromkeys(OF_A_ROBOT, 0.0), **changes))
    return row


def test_what_a_robot_needs_alone():
    taken = Samples()
    for number, name in enumerate([*OF_A_ROBOT, "robot", "monitor"]):
        sizes = [40e6, 49e6, 41e6] if name == "slam" else [40e6] * 3
        taken.by_node[Node("robot_0", name, number)] = [Sample(t, size, 0, 0.0) for t, size in enumerate(sizes)]
    row = alone(samples=taken)
    assert row["holds"] and row["value"] == 329.0, "the most at a time, without simulator"
    assert "slam 49" in row["detail"] and "roslaunch 40" in row["detail"], "it was left out once"
    taken.by_node[Node("robot_0", "slam", 4)].append(Sample(4.0, int(1e9), 0, 0.0))
    assert alone(samples=taken)["value"] == 329.0, "a moment without the others says nothing"
    assert not alone(samples=taken, code=1)["holds"]
    taken.by_node[Node("robot_0", "slam", 4)][1] = Sample(1, int(111e6), 0, 0.0)
    assert not alone(samples=taken)["holds"]
    assert not alone(samples=Samples())["holds"]


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"stuck": ["robot_2"]}, "soak: robots stuck"),
        ({"left": ["process 7: sleep"]}, "soak: processes, namespaces, mounts left"),
        ({"code": 1}, "soak: missions survived"),
    ],
)
def test_what_was_not_survived(changes, what):
    rows = found(outcome(AT_REST), outcome(AT_REST, **changes))
    assert not rows[what]["holds"] and not rows["soak: missions survived"]["holds"]
    assert rows["survived: master restart"]["value"] == 1 and rows["survived: master restart"]["bar"] == "2 of 2"
    assert all(row["holds"] for row in found(outcome(AT_REST)).values())


def test_a_fault_that_could_not_be_done_is_no_fault_survived():
    done, omitted = disturbed(ROBOTS, 0)[:1], disturbed(ROBOTS, 0)[1:]
    rows = found(outcome(AT_REST, faults=done, omitted=omitted))
    assert not rows["faults that could not be done"]["holds"] and "survived: master restart" not in rows


@pytest.mark.parametrize(("lines", "holds"), [(1, True), (0, False), (2, False)])
def test_a_full_disk_is_one_line_of_each_robot(lines, holds):
    once = [f"team: {robot}: less than 200 MB are free in /x" for robot in ROBOTS]
    said = once * lines
    right = outcome(AT_REST, said=once, faults=full_disk(ROBOTS, 0))
    rows = found(right, outcome(AT_REST, said=said, faults=full_disk(ROBOTS, 1)))
    told = rows["full disk: one line of each robot"]
    assert (told["holds"], told["value"], told["bar"]) == (holds, 1 + holds, "2 of 2")


def test_only_what_hurts_is_an_event():
    """Robots that are back, room on the disk and the node that is killed on a full disk were counted as well."""
    rows = found(outcome(AT_REST), outcome(AT_REST, faults=full_disk(ROBOTS, 0)),
                 outcome(AT_REST, faults=partitions(ROBOTS, 80.0)))  # fmt: skip
    events = {what: row["detail"] for what, row in rows.items() if what.startswith("survived: ")}
    assert events == {
        "survived: partition": "3 events", "survived: node kill": f"{len(NODES) + 1} events",
        "survived: clock jump": "2 events", "survived: master restart": "1 events", "survived: full disk": "2 events",
    }  # fmt: skip


def test_clocks_are_wrong_for_a_while():
    jumps = [fault for fault in disturbed(ROBOTS, 0) if fault.kind == "clock jump"]
    for jump in (fault for fault in jumps if fault.hurts):
        robot = jump.what.split(": ")[0]
        assert jump.at + CLOCK_WRONG_S in {fault.at for fault in jumps if fault.what == f"{robot}: right"}


class Entered(RunningMission):
    """Robots whose clock goes on by a second whenever somebody enters; `obeys`: it can be set."""

    def __init__(self, obeys):
        super().__init__(None, Path("/none"))
        self.time, self.offset, self._obeys = 100.0, 0.0, obeys

    def enter(self, robot, *command):
        self.time += 1.0
        if CLOCK_OFFSET in command and self._obeys:
            self.offset = float(command[-1].split(": ")[1])
        now = self.time + self.offset
        return f"secs: {int(now)}\nnsecs:         0\n---\n" if "echo" in command else ""


def test_a_clock_that_cannot_be_set_is_no_jump(monkeypatch):
    """One wrong message was sent, and nobody looked what came of it."""
    mission = Entered(obeys=True)
    monkeypatch.setattr("mr_launch.soak.running.time.monotonic", lambda: mission.time)
    assert [mission.set_clock("robot_0", offset) for offset in (60.0, 0.0, -20.0, 0.0)] == [True] * 4
    mission = Entered(obeys=False)
    assert not mission.set_clock("robot_0", 60.0)


class Radio:
    """The radio daemon on the other end of its control socket."""

    def __init__(self):
        self._answers = []

    def send(self, lines):
        for line in lines.decode().split("\n")[:-1]:
            if line == "statistics":
                self._answers.append(b'{"frames": 0, "robots": {"robot_0": {}}}')
            elif line != "down robot_0":
                self._answers.append(f"command '{line}' is not one of".encode())

    def recv(self, _):
        return self._answers.pop(0)


def test_what_the_radio_has_not_done_is_no_partition():
    assert carried_out(Radio(), "down", "robot_0")
    assert not carried_out(Radio(), "down", "robot_9"), "whom it does not know it would take up"
    assert not carried_out(Radio(), "hide", "robot_0")


def test_everything_happens_to_everybody():
    for rotation in range(3):
        faults = disturbed(ROBOTS, rotation)
        assert [fault.at for fault in faults] == sorted(fault.at for fault in faults)
        assert {fault.kind for fault in faults} == {"partition", "node kill", "clock jump", "master restart"}
        assert {fault.what.split()[0] for fault in faults if fault.kind == "node kill"} == set(NODES)
    masters = {fault.what for turn in range(3) for fault in disturbed(ROBOTS, turn) if fault.kind == "master restart"}
    assert masters == {f"master of {robot} dies" for robot in ROBOTS}
    assert len(partitions(ROBOTS, 120.0)) == 6


def test_every_node_is_killed_that_a_robot_of_a_team_starts_again():
    files = ("mr_launch/launch/robot", "mr_page/launch/page", "mr_robot/launch/slam", "mr_robot/launch/move_base")
    roots = [ElementTree.parse(f"{SOURCES}/{name}.launch").getroot() for name in files]
    again = {node.get("name") for root in roots for node in root.iter("node") if node.get("respawn")}
    assert again - ELSEWHERE == set(NODES)


@contextlib.contextmanager
def process_with(word):
    """In whose command line this stands; it is there when it has said so."""
    words = [sys.executable, "-c", "print('up', flush=True); input()", word]
    process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert process.stdout.readline() == b"up\n"
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def test_processes_that_stay_are_found(tmp_path):
    with process_with(f"{tmp_path}/logs/robot_0/nodes/x") as process:
        leftovers = Leftovers(RunningMission(process, tmp_path))
        leftovers.look()
        assert any(str(process.pid) in entry for entry in leftovers._left())
    assert leftovers.found() == []


def test_nodes_are_told_by_their_logs(tmp_path):
    with process_with(f"__log:={tmp_path}/logs/robot_1/nodes/map_merger-3.log") as process:
        mission = RunningMission(process, tmp_path)
        assert mission.nodes() == [Node("robot_1", "map_merger", process.pid)]
        assert not mission.kill("robot_1", "explorer") and mission.kill("robot_1", "map_merger")
        assert process.wait(10) == -9


def test_roslaunch_is_told_by_what_it_is_given(tmp_path):
    words = f"/usr/bin/roslaunch -p 11311 mr_launch team_robot.launch x:=1 log_path:={tmp_path}/logs/robot_1 y:=2"
    with process_with(words) as process:
        assert RunningMission(process, tmp_path).nodes() == [Node("robot_1", "roslaunch", process.pid)]


def test_bad_options(capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["--minutes", "1"])
    assert stopped.value.code == 2 and "--minutes 1 is out of range: 10 to 1440" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--seed", "-1"], "--seed -1 is out of range: 0 to 2147473647"),
        (["--seed", "2147483647"], "--seed 2147483647 is out of range"),
        (["--world", "{tmp}/one.world"], "--robots 3, but {tmp}/one.world has 1: robot_0"),
        (["--world", "{tmp}/others.world"], "the first robots are a, b, c; a soak is of robot_0, robot_1, robot_2"),
        (["--out", "{tmp}"], "--out {tmp} is a folder; give a file"),
    ],
)
def test_what_every_mission_would_be_refused_for(arguments, said, tmp_path, capsys, monkeypatch):
    """Once a soak went on and on with missions that ended at once, or noticed at its end where its rows should go."""
    robot = 'position ( name "{}" pose [ {} 0 0 0 ] ranger ( sensor ( samples 181 ) ) )\n'
    (tmp_path / "one.world").write_text(robot.format("robot_0", 0))
    (tmp_path / "others.world").write_text("".join(robot.format(name, 2 * place) for place, name in enumerate("abc")))
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    monkeypatch.setattr(command, "soak", lambda *_: pytest.fail("it began"))
    with pytest.raises(SystemExit) as stopped:
        main([word.format(tmp=tmp_path) for word in arguments])
    assert stopped.value.code == 2 and said.format(tmp=tmp_path) in capsys.readouterr().err


class Missions:
    """In place of the real ones: with these exit codes, then Ctrl-C."""

    name = "rest"

    def __init__(self, *codes):
        self._codes = iter(codes)

    def __call__(self, *_, **__):
        return self

    def run(self, *_):
        for code in self._codes:
            return outcome(AT_REST, code=code)
        raise KeyboardInterrupt


def test_an_interrupted_soak_keeps_its_rows(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    monkeypatch.setattr(command, "SoakMission", Missions(0))
    assert main(["--world", "office26x15", "--out", str(tmp_path / "rows.json")]) == 130
    rows = {row["what"]: row for row in json.loads((tmp_path / "rows.json").read_text())}
    assert rows["soak: missions survived"]["value"] == 1
    assert capsys.readouterr().err.endswith("soak: interrupted; the rows are those of the missions before\n")


def test_a_soak_ends_with_a_mission_that_is_refused(monkeypatch):
    monkeypatch.setattr(command, "SoakMission", Missions(2))
    outcomes = []
    command.soak(command.Path("/none"), "office26x15", 1, 1e6, outcomes)
    assert [each.code for each in outcomes] == [2]


@pytest.mark.parametrize(("minutes", "hold"), [(10.0, 150.0), (30.0, LEAST_HOLD_S), (120.0, 1800.0)])
def test_the_mission_at_rest_is_watched_with_a_page(minutes, hold, monkeypatch):
    asked, held = [], []

    class Mission:
        name = "rest"

        def __init__(self, *_, **options):
            asked.append(options)

        def run(self, _, seconds):
            held.append(seconds)
            return outcome(AT_REST, code=2)

    monkeypatch.setattr(command, "SoakMission", Mission)
    command.soak(command.Path("/none"), "office26x15", 1, 60.0 * minutes, [])
    assert asked[0]["page"] and held == [hold]
