"""Checks of what runs on the robot's master: nodes, parameters, topics, frames, time, radio."""

from __future__ import annotations

from typing import Iterator

from mr_launch.doctor.facts import Complaint, Facts, Finding, SetUp, Topic
from mr_launch.doctor.machine_checks import check_hub, check_interface, check_key, check_rights

SLOWEST_SCAN = 1.5  # Hz
SLOWEST_ODOMETRY = 4.0  # Hz
OLDEST = 0.5  # s between a stamp and now: navigation does not use older scans
LEAST_VALID = 0.01  # of the beams of a scan

_DRIVERS = {
    "scan": ("laser", "scan_topic", SLOWEST_SCAN),
    "odometry": ("base", "odometry_topic", SLOWEST_ODOMETRY),
}
"""What a topic is for: the device, the argument of robot.launch, the least rate in Hz."""


def check_master(facts: Facts) -> Iterator[Finding]:
    if facts.master is not None and facts.master.fault:
        remedy = "start robot.launch, or set ROS_MASTER_URI to its master"
        yield Finding("master", f"no ROS master answers at {facts.master.uri} ({facts.master.fault})", remedy)


def check_set_up(facts: Facts) -> Iterator[Finding]:
    if facts.set_up is not None and not facts.set_up.nodes:
        what = "nothing of robot.launch is known to the master"
        remedy = "roslaunch mr_launch robot.launch; with a namespace, set ROS_NAMESPACE for the doctor, too"
        yield Finding("nodes", what, remedy)


def check_parameters(facts: Facts) -> Iterator[Finding]:
    if facts.set_up is None:
        return
    for node, faults in facts.set_up.faults.items():
        for fault in faults:
            yield Finding("parameters", f"{node}: {fault}", "correct it in the launch file or in config/, start again")


def check_robot_names(facts: Facts) -> Iterator[Finding]:
    if facts.set_up is None:
        return
    names = {node: name or facts.computer.host_name for node, name in facts.set_up.names.items()}
    if len(set(names.values())) > 1:
        said = ", ".join(f"{name} in {node}" for node, name in names.items())
        yield Finding("name", f"the robot has several names: {said}", "give all nodes one robot_name")
    elif set(names.values()) == {"localhost"}:
        yield Finding("name", "the robot is called localhost, as others may be", "give it a name with robot_name:=")


def check_hosts(facts: Facts) -> Iterator[Finding]:
    """Nodes may have been started with another environment than the doctor."""
    for host in sorted(set(facts.astray.values())):
        nodes = ", ".join(node for node, place in facts.astray.items() if place == host)
        what = f"{nodes} cannot be reached at {host}, which does not lead to this computer"
        yield Finding("name", what, "unset ROS_IP and ROS_HOSTNAME or correct them, and start the nodes again")


def check_nodes(facts: Facts) -> Iterator[Finding]:
    """A node whose parameters are wrong is named by these."""
    if facts.set_up is None:
        return
    for node in facts.set_up.processes:
        if node not in facts.running and node not in facts.set_up.faults and not _explained(facts, node):
            words = facts.last_words.get(node, "")
            said = f"; it said: {words}" if words else ""
            remedy = f"see ~/.ros/log/latest/{node}*.log, mend what it says, start again"
            what = f"the node {node} does not run{said}"
            if node == facts.set_up.recorder:
                remedy = "see what roslaunch printed of it (a full disk, a full bag?), make room, start again"
                what = f"the recording has ended: {what}"
            yield Finding("nodes", what, remedy)


def _explained(facts: Facts, node: str) -> bool:
    """Something else that was found keeps the node from running, or from being reached."""
    if node in facts.astray:
        return True
    if node != "adhoc_communication":
        return False
    return any(list(check(facts)) for check in (check_interface, check_hub, check_rights, check_key))


def check_time(facts: Facts) -> Iterator[Finding]:
    clock = facts.clock
    if clock is None:
        return
    if clock.simulated and not clock.publishers:
        what = "nodes wait for simulated time, and nobody publishes /clock"
        yield Finding(
            "time", what, "rosparam set /use_sim_time false and start the nodes again, or start the simulation"
        )
    elif clock.simulated and not clock.runs:
        yield Finding(
            "time", f"simulated time stands still ({clock.publishers[0]})", "start or go on with the simulation"
        )
    elif not clock.simulated and clock.publishers:
        what = f"{clock.publishers[0]} publishes /clock, and the nodes do not use it"
        yield Finding("time", what, "rosparam set /use_sim_time true and start the nodes again, or end that node")


def check_clocks(facts: Facts) -> Iterator[Finding]:
    """A node looks only once, when it starts, whose time it has to take."""
    nodes = () if _time_stands(facts) else _by_another_clock(facts)
    if nodes:
        what = f"the computer's clock, not /clock, tells the time to {', '.join(nodes)}"
        yield Finding("time", what, "start again what began before /use_sim_time was true")
    waiting = _waiting(facts)
    if waiting:
        what = f"nobody publishes /clock, for which {', '.join(waiting)} wait{'s' if len(waiting) == 1 else ''}"
        yield Finding("time", what, "start again what began before /use_sim_time was false")


def _waiting(facts: Facts) -> tuple[str, ...]:
    """Full names of nodes whose time stands though it is not simulated: they hang."""
    if facts.clock is None or facts.clock.publishers:
        return ()
    return tuple(node for node in facts.clock.awaited_by if node not in _timely(facts))


def _waits(facts: Facts, name: str) -> bool:
    return any(node.rpartition("/")[2] == name for node in _waiting(facts))


def _by_another_clock(facts: Facts) -> tuple[str, ...]:
    """Full names."""
    if facts.clock is None:
        return ()
    return tuple(node for node in facts.clock.ignored_by if node not in _timely(facts))


def _timely(facts: Facts) -> set[str]:
    """Drivers whose stamps tell that they know the time, if from elsewhere, by full names."""
    drivers = _driver_topics(facts)
    return {node for topic in drivers if topic.heard and abs(topic.age) <= OLDEST for node in topic.publishers}


def _driver_topics(facts: Facts) -> list[Topic]:
    return [topic for purpose, topic in facts.topics.items() if purpose in _DRIVERS]


def check_drivers(facts: Facts) -> Iterator[Finding]:
    if _time_stands(facts):
        return
    by_another_clock = {*_by_another_clock(facts), *_waiting(facts)}
    for purpose, (device, argument, least) in _DRIVERS.items():
        topic = facts.topics.get(purpose)
        if topic is not None and not by_another_clock & set(topic.publishers):  # these are named themselves
            yield from _driver_findings(topic, device, argument, least)


def _driver_findings(topic: Topic, device: str, argument: str, least: float) -> Iterator[Finding]:
    if not topic.publishers:
        what = f"nobody publishes {topic.name} ({topic.wanted})"
        yield Finding("topics", what, f"start the driver of the {device}, or name its topic with {argument}:=")
    elif topic.kind != topic.wanted:
        what = f"{topic.name} carries {topic.kind}, not {topic.wanted}"
        yield Finding("topics", what, f"name the right topic with {argument}:=")
    elif not topic.heard:
        what = f"{topic.name} is silent, though {topic.publishers[0]} offers it"
        yield Finding("topics", what, f"look at the driver of the {device}: cable, power, its log")
    elif not topic.stamped:
        yield Finding("time", f"messages of {topic.name} have no time stamp", "let the driver stamp with ROS time")
    elif abs(topic.age) > OLDEST:
        how = f"{abs(topic.age):.1f} s {'old' if topic.age > 0 else 'ahead of time'} when they come"
        remedy = "let the driver stamp with ROS time; on another computer, set its clock (chrony)"
        yield Finding("time", f"messages of {topic.name} are {how}", remedy)
    elif topic.rate < least:
        what = f"{topic.name} comes at {topic.rate:.1f} Hz, at least {least:g} Hz are needed"
        yield Finding("topics", what, f"raise the rate of the driver of the {device}")
    elif topic.valid < LEAST_VALID:
        yield Finding(
            "topics", f"all beams of {topic.name} are blind", f"is the {device} covered, or does it not turn?"
        )


def check_velocity(facts: Facts) -> Iterator[Finding]:
    topic = facts.topics.get("velocity")
    if topic is None or "move_base" not in facts.running:
        return
    if not topic.subscribers:
        what = f"nobody listens to velocities on {topic.name}"
        yield Finding("topics", what, "start the driver of the base, or name its topic with velocity_topic:=")
    if len(topic.publishers) > 1:
        what = f"{' and '.join(topic.publishers)} both publish {topic.name} and contradict one another"
        yield Finding("topics", what, "let only one drive: a joystick belongs on teleop/cmd_vel, with teleop:=true")


def check_map(facts: Facts) -> Iterator[Finding]:
    """SLAM makes none without scans, odometry and frames, which are named themselves."""
    topic = facts.topics.get("map")
    if topic is None or _time_stands(facts) or list(check_clocks(facts)):
        return
    if list(check_drivers(facts)) or list(check_frames(facts)):
        return
    if topic.heard or "slam" in _missing(facts):
        return
    yield Finding("topics", f"no map has come on {topic.name}", "see the log of SLAM; with slam:=none start your own")


def check_frames(facts: Facts) -> Iterator[Finding]:
    yield from _doubled(facts)
    if facts.set_up is None or not facts.set_up.nodes or not facts.set_up.has_body:
        return
    if _time_stands(facts) or list(check_drivers(facts)) or _waits(facts, "slam"):
        return
    if any(set(topic.publishers) & set(_waiting(facts)) for topic in _driver_topics(facts)):
        return
    chain = _chain(facts, facts.set_up)
    parents: dict[str, set[str]] = {}
    for link in facts.links:
        parents.setdefault(link.child, set()).add(link.parent)
    for above, below, who in chain:
        if not _leads(parents, below, above):
            yield Finding("frames", f"there is no transform from {above} to {below}", who)
            return


def _chain(facts: Facts, set_up: SetUp) -> list[tuple[str, str, str]]:
    """Frames that have to be connected, from the laser up, and what to do about each gap. SLAM works only with the
    others, so its gap is the last."""
    driver = "the driver of the base has to publish it; name the frames with base_frame:= and odom_frame:="
    chain = []
    scan = facts.topics.get("scan")
    if scan is not None and scan.frame:
        static = f"rosrun tf2_ros static_transform_publisher X Y Z YAW PITCH ROLL {set_up.base_frame} {scan.frame}"
        chain.append((set_up.base_frame, scan.frame, static))
    chain.append((set_up.odom_frame, set_up.base_frame, driver))
    if "slam" in facts.running or "slam" not in set_up.nodes:
        chain.append((set_up.map_frame, set_up.odom_frame, "SLAM has to publish it; see its log"))
    return chain


def _leads(parents: dict[str, set[str]], below: str, above: str) -> bool:
    """True if `above` is an ancestor of `below`."""
    seen, open_frames = set(), [below]
    while open_frames:
        frame = open_frames.pop()
        if frame == above:
            return True
        if frame not in seen:
            seen.add(frame)
            open_frames += parents.get(frame, ())
    return False


def _doubled(facts: Facts) -> Iterator[Finding]:
    by_child: dict[str, set[tuple[str, str]]] = {}
    for link in facts.links:
        by_child.setdefault(link.child, set()).add((link.node, link.parent))
    for child, sources in by_child.items():
        if len(sources) > 1:
            said = ", ".join(f"{node} (from {parent})" for node, parent in sorted(sources))
            yield Finding("frames", f"the transform to {child} is published more than once: {said}", "end all but one")


def check_radio(facts: Facts) -> Iterator[Finding]:
    radio = facts.radio
    if radio is None or "adhoc_communication" not in facts.running:
        return
    waits = _waits(facts, "adhoc_communication")
    if not radio.answers and not waits:
        what = "adhoc_communication runs and does not answer"
        yield Finding("radio", what, "see its log; rosnode kill /adhoc_communication, it is started again")
        return
    for complaint in radio.complaints:
        yield Finding("radio", _without_remedy(complaint.text), _remedy_of(complaint))
    away = [peer for peer in facts.peers if peer not in radio.robots]
    if away and not waits:
        heard = f"heard: {', '.join(radio.robots)}" if radio.robots else "nobody is heard"
        remedy = "does it run there, on the same channel, in reach? docs/troubleshooting.md, No neighbours"
        yield Finding("peers", f"{', '.join(away)} cannot be reached ({heard})", remedy)


def _without_remedy(text: str) -> str:
    """The node's own is for who reads the diagnostics."""
    return text.replace(": give each its own ~robot_name", "").replace(": see the node's log", "")


def _remedy_of(complaint: Complaint) -> str:
    for words, remedy in _REMEDIES:
        if words in complaint.text:
            return remedy
    return "docs/troubleshooting.md"


_REMEDIES = (
    ("two robots are called", "give one of them another robot_name:="),
    ("hub:", "another node of this robot_name takes its place at the hub: give each robot its own robot_name:="),
    ("does not hear this robot", "look at antenna and transmit power (p_tx), and at sim_robot_macs there"),
    ("refused: unsealed", "key_file:= on all robots or on none"),
    ("refused: no key", "key_file:= on all robots or on none"),
    ("forged", "the same key on all robots: compare rosrun adhoc_communication team_key show FILE"),
    ("replayed", "somebody sends recorded frames again; the robot passes over them"),
    ("queue is nearly full", "send less: relays with a rate, fewer large messages"),
    ("cannot be published", "type, topic or inject_deny; the node's log says which"),
    ("rows of the logs are lost", "make room on the disk of log_path"),
    ("captured frames are lost", "make room on the disk of capture_file"),
    ("does not take all frames", "lower max_frame_size, or another driver of the interface"),
)


def check_navigation(facts: Facts) -> Iterator[Finding]:
    if not facts.offered and "explorer" in facts.running and "move_base" not in _missing(facts):
        what = "the explorer waits for the action move_base, which nobody offers"
        yield Finding("nodes", what, "start your own, or leave out navigation:=none")


def _missing(facts: Facts) -> set[str]:
    """Nodes that should run and do not."""
    return set() if facts.set_up is None else set(facts.set_up.nodes) - set(facts.running)


def _time_stands(facts: Facts) -> bool:
    return bool(list(check_time(facts)))
