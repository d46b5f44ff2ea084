"""The doctor names the cause of each of many broken set-ups, and nothing on healthy ones."""

import json
import os
from dataclasses import replace

import pytest

from mr_launch.doctor import command, machine
from mr_launch.doctor.diagnosis import diagnose
from mr_launch.doctor.facts import (
    Clock,
    Complaint,
    Computer,
    Facts,
    Finding,
    Hub,
    Interface,
    KeyFile,
    Link,
    Master,
    OwnName,
    Radio,
    Topic,
)
from mr_launch.doctor.set_up import folders_of, set_up_of, topics_of

NODES = ("adhoc_communication", "map_merger", "explorer", "slam", "move_base")
PARAMETERS = {
    "adhoc_communication": {"robot_name": "", "interface": "wlan0", "key_file": "/team.key"},
    "map_merger": {"robot_name": "", "scan_topic": "scan", "position_local_robot_topic": "odom"},
    "explorer": {"robot_name": "", "base_link": "base_footprint"},
    "slam": {"base_frame": "base_footprint", "odom_frame": "odom", "scan_topic": "scan"},
    "move_base": {"robot_name": "", "velocity_topic": "cmd_vel"},
}
TOPICS = {
    "scan": Topic(
        "/scan", "sensor_msgs/LaserScan", "sensor_msgs/LaserScan", ("/laser",), ("/slam",), 10.0, 0.05, "laser"
    ),
    "odometry": Topic("/odom", "nav_msgs/Odometry", "nav_msgs/Odometry", ("/base",), ("/slam",), 20.0, 0.01, "odom"),
    "velocity": Topic("/cmd_vel", "geometry_msgs/Twist", "geometry_msgs/Twist", ("/move_base",), ("/base",)),
    "map": Topic("/map", "nav_msgs/OccupancyGrid", "nav_msgs/OccupancyGrid", ("/slam",), ("/map_merger",), 0.5),
}
LINKS = (
    Link("map", "odom", "/slam"), Link("odom", "base_footprint", "/base"), Link("base_footprint", "base_link", "/base"),
    Link("base_link", "laser", "/base"), Link("map", "bob/map", "/map_merger"),
)  # fmt: skip
UNKNOWN, ELSEWHERE = "leads nowhere (Name or service not known)", "is not an address of this computer"
HEALTHY = Facts(
    Computer(program="/adhoc_communication", disks={"~/.ros": 50 << 30}),
    Interface("wlan0", ("eth0", "lo", "wlan0"), wireless=True, mode="IBSS"),
    key_file=KeyFile("/team.key"),
    master=Master("http://localhost:11311"),
    set_up=set_up_of(PARAMETERS),
    running=NODES,
    clock=Clock(),
    topics=TOPICS,
    links=LINKS,
    radio=Radio(robots=("bob",)),
    peers=("bob",),
)


def with_parameters(node, **words):
    return replace(HEALTHY, set_up=set_up_of({**PARAMETERS, node: {**PARAMETERS[node], **words}}))


def with_topic(purpose, **words):
    return replace(HEALTHY, topics={**TOPICS, purpose: replace(TOPICS[purpose], **words)})


def with_interface(**words):
    return replace(HEALTHY, interface=replace(HEALTHY.interface, **words))


def with_computer(**words):
    return replace(HEALTHY, computer=replace(HEALTHY.computer, **words))


def with_own_name(name="anna", source="host name", fault=""):
    """As it is then: no node answers, and nothing is heard."""
    computer = replace(HEALTHY.computer, own_name=OwnName(name, source, fault))
    silent = {purpose: replace(topic, rate=0.0) for purpose, topic in TOPICS.items()}
    return replace(HEALTHY, computer=computer, running=(), topics=silent, links=(), radio=None, offered=False)


def without_radio(facts):
    return replace(facts, running=NODES[1:], radio=None)


def with_key(**words):
    return replace(HEALTHY, key_file=replace(HEALTHY.key_file, **words))


def without(*frames):
    return replace(HEALTHY, links=tuple(link for link in LINKS if link.child not in frames))


def complaining(text, level=1):
    return replace(HEALTHY, radio=Radio(robots=("bob",), complaints=(Complaint("neighbors", level, text),)))


HEALTHY_ROBOTS = {
    "a robot": HEALTHY,
    "alone, open frames": replace(HEALTHY, key_file=None, peers=(), radio=Radio()),
    "a cable for a radio": with_interface(wireless=False, mode=""),
    "a driver that does not tell its mode": with_interface(mode=""),
    "a moment of hard work": with_computer(busy=1.0),
    "a mesh": with_interface(mode="mesh point"),
    "a service with rights and a key of its own": replace(
        with_key(fault="cannot be read: Permission denied", denied=True),
        computer=replace(HEALTHY.computer, raw_sockets=False),
    ),
    "own SLAM and navigation": replace(
        HEALTHY,
        set_up=set_up_of({node: PARAMETERS[node] for node in NODES[:3]}),
        running=NODES[:3],
        topics={**TOPICS, "map": replace(TOPICS["map"], publishers=("/gmapping",))},
    ),
    "in simulation, on a busy computer": replace(
        HEALTHY,
        computer=replace(HEALTHY.computer, busy=1.0, load=4.0),
        interface=None,
        hub=Hub("/tmp/hub"),
        clock=Clock(True, ("/robot",), True),
    ),
    "in simulation, a driver that stamps rightly by itself": replace(
        HEALTHY, clock=Clock(True, ("/gazebo",), ignored_by=("/laser",))
    ),
    "a driver that listens to /clock, which nobody publishes": replace(HEALTHY, clock=Clock(awaited_by=("/laser",))),
    "a base station": replace(
        HEALTHY,
        set_up=set_up_of({**{n: PARAMETERS[n] for n in NODES[:2]}, "map_merger": {"has_local_map": False}}),
        running=NODES[:2],
        topics={},
        links=(),
    ),
    "the radio alone": replace(
        HEALTHY,
        set_up=set_up_of({"adhoc_communication": PARAMETERS["adhoc_communication"]}),
        running=("adhoc_communication",),
        topics={},
        links=(),
    ),
    "before anything is started, but for the master": replace(
        HEALTHY, master=None, set_up=None, running=(), clock=None, topics={}, links=(), radio=None, peers=()
    ),
}
BROKEN = {  # cause: facts, words of the finding, words of the remedy
    "no such interface": (
        with_interface(name="wlan7"),
        "wlan7 does not exist (existing: eth0, lo, wlan0)",
        "interface:=",
    ),
    "interface down": (with_interface(up=False), "wlan0 is down", "ip link set wlan0 up"),
    "wireless interface not in ad hoc mode": (
        with_interface(mode="managed"),
        "mode managed, not ad hoc",
        "set type ibss",
    ),
    "frames larger than the interface": (with_interface(mtu=1000), "1500 octets do not fit", "max_frame_size: 1014"),
    "useless MTU": (with_interface(mtu=100), "takes only 100 octets", "mtu 1500"),
    "no radio daemon": (
        replace(HEALTHY, interface=None, hub=Hub("/tmp/hub", "No such file or directory")),
        "no radio answers at hub socket /tmp/hub",
        "radio --hub /tmp/hub",
    ),
    "no right to raw frames": (
        without_radio(with_computer(raw_sockets=False)),
        "cap_net_raw",
        "setcap cap_net_raw+ep /adhoc",
    ),
    "not built": (without_radio(with_computer(raw_sockets=False, program="")), "is not found", "make build"),
    "no key file": (with_key(fault="cannot be read: No such file or directory"), "/team.key cannot be read", "create"),
    "key of another user": (
        without_radio(with_key(fault="cannot be read: Permission denied", denied=True)),
        "cannot be read: Permission denied",
        "run the doctor as the robot's user",
    ),
    "key that others can read": (with_key(mode=0o644), "can be read by others", "chmod 600 /team.key"),
    "broken key": (with_key(fault="is broken: line 2 is not a key"), "is broken: line 2", "team_key create"),
    "relative path of the key": (with_key(path="team.key", absolute=False), "relative path", "whole path"),
    "host name without address": (with_own_name(fault=UNKNOWN), "host name anna leads nowhere", "/etc/hosts"),
    "host name of another computer": (with_own_name(fault=ELSEWHERE), "host name anna is not an", "/etc/hosts"),
    "unresolvable ROS_HOSTNAME": (
        with_own_name("anna.lab", "ROS_HOSTNAME", UNKNOWN),
        "ROS_HOSTNAME anna.lab leads nowhere (Name or service not known)",
        "unset ROS_HOSTNAME",
    ),
    "stale ROS_IP": (
        with_own_name("203.0.113.7", "ROS_IP", ELSEWHERE),
        "ROS_IP 203.0.113.7 is not an address of this computer",
        "unset ROS_IP or correct it",
    ),
    "nodes that were started with a stale ROS_IP": (
        replace(without_radio(HEALTHY), running=NODES[2:], astray=dict.fromkeys(NODES[:2], "203.0.113.7")),
        "adhoc_communication, map_merger cannot be reached at 203.0.113.7, which does not lead to this computer",
        "unset ROS_IP",
    ),
    "disk full": (with_computer(disks={"~/.ros": 1 << 20}), "disk of ~/.ros is nearly full: 1 MB", "rosclean purge"),
    "no memory": (with_computer(memory_available=50 << 20), "50 of 8192 MB are left", "end what"),
    "busy computer": (
        with_computer(busy=0.99, load=2.0, busiest="chrome"),
        "busy (load 2.0 for each, most by chrome)",
        "end what",
    ),
    "clock never set": (with_computer(year=1970), "the year 1970", "date -s"),
    "no master": (
        Facts(HEALTHY.computer, HEALTHY.interface, master=Master("http://localhost:11311", "Connection refused")),
        "no ROS master answers at http://localhost:11311 (Connection refused)",
        "ROS_MASTER_URI",
    ),
    "a master without the robot": (
        replace(HEALTHY, set_up=set_up_of({}), running=(), topics={}, links=(), radio=None),
        "nothing of robot.launch",
        "roslaunch mr_launch robot.launch",
    ),
    "a master with nothing but a simulated body": (
        replace(
            HEALTHY,
            set_up=set_up_of({"robot": {"socket": "/tmp/world"}}),
            running=("robot",),
            clock=Clock(True, ("/robot",)),
            topics={},
            links=(),
            radio=None,
        ),
        "nothing of robot.launch",
        "roslaunch mr_launch robot.launch",
    ),
    "misspelt parameter": (with_parameters("explorer", view_distanse=2.0), "is view_distance meant?", "correct it"),
    "misspelt parameter of navigation": (
        with_parameters("move_base", footprint_length=0.4, xy_goal_tolerence=0.3),
        "is xy_goal_tolerance meant?",
        "correct it",
    ),
    "misspelt parameter of SLAM": (
        with_parameters("slam", small_object_size=0.7, search_windw=0.3),
        "is search_window meant?",
        "correct it",
    ),
    "parameter out of range": (with_parameters("explorer", seed=-1), "~seed is -1, out of range", "correct it"),
    "parameter of the merger": (
        with_parameters("map_merger", split_size=4096),
        "split_size must be at most",
        "correct",
    ),
    "parameter of navigation": (
        with_parameters("move_base", footprint_length=0.4, inflation_radius=0.1),
        "inflation_radius must exceed",
        "correct",
    ),
    "two names of one robot": (with_parameters("explorer", robot_name="carl"), "carl in explorer", "one robot_name"),
    "a name that all have": (with_computer(host_name="localhost"), "is called localhost", "robot_name:="),
    "a node has died": (
        replace(HEALTHY, running=NODES[:4], last_words={"move_base": "out of memory"}),
        "the node move_base does not run; it said: out of memory",
        "see ~/.ros/log/latest/move_base*.log",
    ),
    "nobody publishes the time": (
        replace(HEALTHY, clock=Clock(True, (), False)),
        "nobody publishes /clock",
        "use_sim_time",
    ),
    "simulation paused": (replace(HEALTHY, clock=Clock(True, ("/robot",), False)), "time stands still", "simulation"),
    "simulated time unused": (
        replace(HEALTHY, clock=Clock(False, ("/player",))),
        "/player publishes /clock",
        "use_sim_time",
    ),
    "nodes that began before time was simulated": (
        replace(with_topic("map", rate=0.0), clock=Clock(True, ("/robot",), ignored_by=("/explorer", "/slam"))),
        "the computer's clock, not /clock, tells the time to /explorer, /slam",
        "start again what began before /use_sim_time",
    ),
    "a driver that began before time was simulated": (
        replace(with_topic("scan", age=-1.8e9), clock=Clock(True, ("/player",), ignored_by=("/laser",))),
        "the computer's clock, not /clock, tells the time to /laser",
        "start again what began before /use_sim_time",
    ),
    "nodes that began when time was simulated": (
        replace(
            with_topic("map", rate=0.0),
            clock=Clock(awaited_by=("/adhoc_communication", "/slam")),
            radio=Radio(False),
            links=LINKS[1:],
        ),
        "nobody publishes /clock, for which /adhoc_communication, /slam wait",
        "start again what began before /use_sim_time was false",
    ),
    "a driver that began when time was simulated": (
        replace(with_topic("scan", rate=0.0), clock=Clock(awaited_by=("/laser",)), links=LINKS[:3]),
        "nobody publishes /clock, for which /laser waits",
        "start again what began before /use_sim_time was false",
    ),
    "no laser": (with_topic("scan", publishers=(), kind="", rate=0.0), "nobody publishes /scan", "scan_topic:="),
    "wrong topic of the laser": (
        with_topic("scan", kind="sensor_msgs/PointCloud2"),
        "carries sensor_msgs/PointCloud2",
        "right",
    ),
    "silent laser": (with_topic("scan", rate=0.0), "/scan is silent, though /laser offers it", "cable"),
    "slow laser": (with_topic("scan", rate=0.5), "comes at 0.5 Hz", "raise the rate"),
    "covered laser": (with_topic("scan", valid=0.0), "all beams of /scan are blind", "covered"),
    "no odometry": (
        with_topic("odometry", publishers=(), kind="", rate=0.0),
        "nobody publishes /odom",
        "odometry_topic:=",
    ),
    "clock of the driver": (with_topic("scan", age=3.0), "/scan are 3.0 s old", "chrony"),
    "stamps from the future": (with_topic("odometry", age=-60.0), "60.0 s ahead of time", "stamp with ROS time"),
    "no stamps": (with_topic("scan", stamped=False, age=1.7e9), "have no time stamp", "stamp with ROS time"),
    "laser not mounted": (without("laser"), "no transform from base_footprint to laser", "static_transform_publisher"),
    "base without odometry's frame": (without("base_footprint"), "from odom to base_footprint", "base_frame:="),
    "SLAM does not find the frames": (without("odom"), "from map to odom", "SLAM"),
    "two SLAMs": (
        replace(HEALTHY, links=(*LINKS, Link("map", "odom", "/amcl"))),
        "/amcl (from map), /slam (from map)",
        "all but one",
    ),
    "two parents": (
        replace(HEALTHY, links=(*LINKS, Link("base_footprint", "laser", "/mount"))),
        "to laser is published more",
        "all but",
    ),
    "no map": (with_topic("map", rate=0.0), "no map has come on /map", "log of SLAM"),
    "nobody drives": (
        with_topic("velocity", subscribers=()),
        "nobody listens to velocities on /cmd_vel",
        "velocity_topic:=",
    ),
    "two who drive": (
        with_topic("velocity", publishers=("/joy", "/move_base")),
        "/joy and /move_base both publish",
        "one",
    ),
    "no navigation": (
        replace(HEALTHY, offered=False, running=NODES[:4], set_up=set_up_of({n: PARAMETERS[n] for n in NODES[:4]})),
        "move_base, which nobody offers",
        "navigation:=none",
    ),
    "radio hangs": (replace(HEALTHY, radio=Radio(answers=False), peers=()), "does not answer", "rosnode kill"),
    "a copied disk": (
        complaining("two robots are called anna: give each its own ~robot_name", 2),
        "two robots are called anna",
        "give one of them another robot_name:=",
    ),
    "two robots of one name at a hub": (
        complaining("hub:/tmp/hub is down", 2),
        "/tmp/hub is down",
        "each robot its own",
    ),
    "a type that nobody here has": (
        complaining("packets received cannot be published: see the node's log"),
        "packets received cannot be published",
        "the node's log says which",
    ),
    "another key": (complaining("frames are refused: forged"), "refused: forged", "team_key show"),
    "a key on one side only": (complaining("frames are refused: unsealed"), "unsealed", "all robots or on none"),
    "one-way link": (complaining("bob does not hear this robot"), "bob does not hear", "antenna"),
    "a robot is away": (replace(HEALTHY, peers=("bob", "carl")), "carl cannot be reached (heard: bob)", "channel"),
}


@pytest.mark.parametrize("facts", HEALTHY_ROBOTS.values(), ids=HEALTHY_ROBOTS)
def test_nothing_is_wrong_with_a_healthy_robot(facts):
    assert diagnose(facts) == []


@pytest.mark.parametrize(("facts", "what", "remedy"), BROKEN.values(), ids=BROKEN)
def test_the_cause_is_named_and_nothing_else(facts, what, remedy):
    findings = diagnose(facts)
    assert len(findings) == 1, [str(finding) for finding in findings]
    assert what in findings[0].what and remedy in findings[0].remedy, str(findings[0])
    assert "\n" not in str(findings[0])


@pytest.mark.parametrize(
    ("facts", "part", "count"),
    [
        # Without an interface adhoc_communication has ended, too.
        (replace(with_interface(up=True, name="wlan7"), running=NODES[1:], radio=None), "interface", 1),
        (replace(with_topic("scan", publishers=(), rate=0.0), links=()), "topics", 1),
        (replace(HEALTHY, clock=Clock(True, (), False), links=(), topics={**TOPICS, "map": Topic("/map")}), "time", 1),
        (
            replace(with_parameters("explorer", seed=-1), running=("adhoc_communication", *NODES[1:2], *NODES[3:])),
            "parameters",
            1,
        ),
        (
            replace(HEALTHY, running=NODES[:3] + NODES[4:], links=LINKS[1:], topics={**TOPICS, "map": Topic("/map")}),
            "nodes",
            1,
        ),
    ],
    ids=["interface", "laser", "time", "parameter", "slam"],
)
def test_consequences_are_not_named_beside_their_cause(facts, part, count):
    assert [finding.part for finding in diagnose(facts)] == [part] * count


def test_topics_and_frames_are_those_of_the_parameters():
    given = {"slam": {"scan_topic": "laser", "odom_frame": "wheels", "base_frame": "/base"}, "robot": {"color": "red"}}
    set_up, topics = set_up_of(given), topics_of(given)
    assert set_up.nodes == ("slam",) and (set_up.odom_frame, set_up.base_frame) == ("wheels", "base")
    assert [topics[purpose].name for purpose in ("scan", "odometry", "velocity", "map")] == [
        "laser",
        "odom",
        "cmd_vel",
        "map",
    ]
    given = {"move_base": {"velocity_topic": "navigation/cmd_vel"}, "velocity_override": {"velocity_topic": "base"}}
    assert topics_of(given)["velocity"].name == "base", "where a person may take over, that is what the base gets"
    assert folders_of({"explorer": {"log_path": "/logs", "scene_path": ""}}) == ["/logs"]


@pytest.mark.parametrize(
    ("text", "mode", "fault"),
    [
        ("# key\n" + "a" * 64, 0o600, ""),
        ("a" * 63, 0o600, "is broken: line 1"),
        ("#\n", 0o600, "holds no key"),
        ("a" * 64, 0o644, ""),
    ],
)
def test_key_files_are_read_as_the_radio_reads_them(tmp_path, text, mode, fault):
    path = tmp_path / "team.key"
    path.write_text(text)
    path.chmod(mode)
    key = machine.key_file_of(str(path))
    assert key.mode == mode and key.fault.startswith(fault) and bool(key.fault) == bool(fault)
    assert machine.key_file_of(str(tmp_path)).fault == "is not a file"
    assert machine.key_file_of(str(tmp_path / "none")).fault == "cannot be read: No such file or directory"
    assert not machine.key_file_of("team.key").absolute


def test_a_key_file_below_the_home_folder_is_found_as_by_the_node(tmp_path, monkeypatch):
    (tmp_path / "team.key").write_text("0f" * 32)
    monkeypatch.setenv("HOME", str(tmp_path))
    key = machine.key_file_of("~/team.key")
    assert key.absolute and not key.fault


def test_the_key_of_another_user_is_not_said_to_be_missing(tmp_path, monkeypatch):
    def denied(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(machine.Path, "stat", denied)
    key = machine.key_file_of(str(tmp_path / "team.key"))
    assert key.denied and key.fault == "cannot be read: Permission denied"


def test_folders_of_another_user_are_passed_over(tmp_path, monkeypatch):
    """Once the doctor ended with a PermissionError where the robot's user keeps records in a home of his own."""
    closed, real = tmp_path / "robot", os.stat

    def stat(path, *args, **words):
        if str(path).startswith(f"{closed}/"):
            raise PermissionError(13, "Permission denied")
        return real(path, *args, **words)

    closed.mkdir()
    monkeypatch.setattr(os, "stat", stat)
    assert machine.computer_of([str(closed / ".ros" / "records")], 0.0).disks
    monkeypatch.setattr(machine.psutil, "disk_usage", lambda _: real("/not/there"))
    assert machine.computer_of([str(closed)], 0.0).disks == {}


@pytest.mark.parametrize(
    ("variables", "source", "fault"),
    [
        ({"ROS_IP": "127.0.0.1"}, "ROS_IP", ""),
        ({"ROS_IP": "203.0.113.7"}, "ROS_IP", ELSEWHERE),
        ({"ROS_IP": "203.0.113.7", "ROS_HOSTNAME": "localhost"}, "ROS_HOSTNAME", ""),
        ({"ROS_HOSTNAME": "nobody.invalid"}, "ROS_HOSTNAME", "leads nowhere ("),
        ({"ROS_HOSTNAME": "a" * 70}, "ROS_HOSTNAME", "leads nowhere ("),
    ],
)
def test_the_name_that_nodes_tell_has_to_lead_here(variables, source, fault, monkeypatch):
    for variable in ("ROS_IP", "ROS_HOSTNAME"):
        monkeypatch.delenv(variable, raising=False)
    assert machine.own_name().source == "host name"
    for variable, name in variables.items():
        monkeypatch.setenv(variable, name)
    own = machine.own_name()
    assert (own.source, own.name) == (source, variables[source])
    assert own.fault.startswith(fault) and bool(own.fault) == bool(fault)


def test_the_computer_is_looked_at():
    loopback = machine.interface_of("lo", 1500)
    assert loopback.exists and loopback.up and not loopback.wireless and loopback.mtu > 1500
    assert not machine.interface_of("wlan77", 1500).exists
    assert machine.hub_of("hub:/nowhere").fault == "No such file or directory"
    computer = machine.computer_of(["/tmp/not/there/yet"], 0.1)
    assert computer.memory > computer.memory_available > 0 and 0.0 <= computer.busy <= 1.0 and computer.year > 2000
    assert computer.disks["/tmp/not/there/yet"] > 0


def test_output_is_one_line_for_each_finding_or_json(monkeypatch, capsys):
    examination = pytest.importorskip("mr_launch.doctor.examination")
    monkeypatch.setattr(examination, "examine", lambda wanted: with_interface(up=False))
    assert command.main([]) == 1
    assert capsys.readouterr().out == "interface wlan0 is down: sudo ip link set wlan0 up\n"
    assert command.main(["--json"]) == 1
    assert json.loads(capsys.readouterr().out) == [
        {"part": "interface", "what": "interface wlan0 is down", "remedy": "sudo ip link set wlan0 up"}
    ]
    monkeypatch.setattr(examination, "examine", lambda wanted: HEALTHY)
    assert command.main([]) == 0 and capsys.readouterr().out == ""
    assert command.main(["--verbose"]) == 0 and capsys.readouterr().out == "all well\n"
    assert str(Finding("cpu", "a", "b")) == "a: b"


@pytest.mark.parametrize(
    ("node", "words", "what"),
    [
        ("map_merger", 5, "map_merger: holds no parameters, but 5"),
        ("velocity_override", "x", "velocity_override: holds no parameters, but 'x'"),
        ("adhoc_communication", {"max_frame_size": "big"}, "parameter max_frame_size must be a number, not 'big'"),
        (
            "move_base",
            {"footprint_length": 0.4, "plan_period": "slow"},
            "move_base: parameter plan_period must be a number, not 'slow'",
        ),
    ],
)
def test_values_of_a_wrong_type_are_findings(node, words, what):
    """Once each of them was a traceback, or named no parameter."""
    given = {**PARAMETERS, node: words}
    assert topics_of(given) and folders_of(given) == []
    findings = diagnose(replace(HEALTHY, set_up=set_up_of(given)))
    assert any(what in finding.what for finding in findings), findings


def test_a_recorder_that_has_ended_is_named_where_one_is_wanted():
    wanted = replace(HEALTHY, set_up=set_up_of({**PARAMETERS, "bag": {"output": "--output-prefix=/records/topics"}}))
    (finding,) = diagnose(wanted)
    assert finding.what == "the recording has ended: the node bag does not run" and "make room" in finding.remedy
    assert diagnose(replace(wanted, running=(*NODES, "bag"))) == []
    assert diagnose(replace(HEALTHY, set_up=set_up_of({**PARAMETERS, "bag": {"colour": "red"}}))) == []


@pytest.mark.parametrize("uri", ["foo", "http://localhost:99999", "ftp://a:1"])
def test_a_master_that_cannot_be_is_a_finding(uri, monkeypatch):
    examination = pytest.importorskip("mr_launch.doctor.examination")
    monkeypatch.setenv("ROS_MASTER_URI", uri)
    facts = examination.examine(examination.Wanted())
    assert facts.master.uri == uri and facts.master.fault
    assert any(f"no ROS master answers at {uri}" in finding.what for finding in diagnose(facts))


def test_an_interrupted_doctor_ends_without_a_traceback(monkeypatch, capsys):
    examination = pytest.importorskip("mr_launch.doctor.examination")

    def interrupted(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(examination, "examine", interrupted)
    assert command.main([]) == 130 and capsys.readouterr().err == "doctor: interrupted\n"


@pytest.mark.parametrize("words", [["bob", "carl"], ["bob,carl"], ["bob,", "carl"]])
def test_peers_are_given_with_blanks_or_commas(words):
    assert command.names_of(command.make_parser().parse_args(["--peers", *words]).peers) == ("bob", "carl")
