"""Checks of the computer: interface, rights, key, names, load, memory, disks, date."""

from __future__ import annotations

from typing import Iterator

from mr_launch.doctor.facts import HOST_NAME, Facts, Finding

AD_HOC_MODES = ("IBSS", "mesh point", "outside context of a BSS")
HEADER = 14  # octets of an Ethernet header
RADIO_NODE = "adhoc_communication"
LEAST_FRAME = 256  # octets, the smallest max_frame_size
MOST_BUSY = 0.95
MOST_LOAD = 1.0  # a moment of hard work is no fault, a minute is
LEAST_MEMORY = 200 << 20  # octets
LEAST_DISK = 500 << 20  # octets
FIRST_YEAR = 2020


def check_interface(facts: Facts) -> Iterator[Finding]:
    interface = facts.interface
    if interface is None:
        return
    name = interface.name
    if not interface.exists:
        there = ", ".join(interface.existing) or "none"
        yield Finding("interface", f"interface {name} does not exist (existing: {there})", "name one with interface:=")
        return
    if not interface.up:
        yield Finding("interface", f"interface {name} is down", f"sudo ip link set {name} up")
    if interface.wireless and interface.mode and interface.mode not in AD_HOC_MODES:
        remedy = f"sudo ip link set {name} down, sudo iw dev {name} set type ibss, up again, and join the team's cell"
        yield Finding("interface", f"interface {name} is in mode {interface.mode}, not ad hoc", remedy)
    room = interface.mtu + HEADER
    if room < LEAST_FRAME:
        yield Finding(
            "interface", f"interface {name} takes only {interface.mtu} octets", f"sudo ip link set {name} mtu 1500"
        )
    elif room < interface.frame_size:
        remedy = f"sudo ip link set {name} mtu {interface.frame_size - HEADER}, or max_frame_size: {room}"
        yield Finding("interface", f"frames of {interface.frame_size} octets do not fit interface {name}", remedy)


def check_hub(facts: Facts) -> Iterator[Finding]:
    if facts.hub is not None and facts.hub.fault:
        what = f"no radio answers at hub socket {facts.hub.path} ({facts.hub.fault})"
        remedy = f"rosrun adhoc_communication radio --hub {facts.hub.path}; with link:= see the log of the node link"
        yield Finding("interface", what, remedy)


def check_rights(facts: Facts) -> Iterator[Finding]:
    """A node that runs has them, perhaps from its service and not from its file."""
    if facts.interface is None or facts.computer.raw_sockets or RADIO_NODE in facts.running:
        return
    program = facts.computer.program
    if program:
        what = "adhoc_communication may not send raw frames: it lacks the capability cap_net_raw"
        yield Finding("rights", what, f"sudo setcap cap_net_raw+ep {program}")
    else:
        what = "the executable of adhoc_communication is not found"
        yield Finding("rights", what, "make build, then source tools/environment.sh")


def check_key(facts: Facts) -> Iterator[Finding]:
    """A key that only the robot's own user may read is as it should be, whoever the doctor runs as."""
    key = facts.key_file
    if key is None or (key.denied and RADIO_NODE in facts.running):
        return
    if not key.absolute:
        remedy = "give the whole path: nodes run in ~/.ros"
        yield Finding("key", f"key file {key.path} is a relative path", remedy)
    elif key.denied:
        yield Finding("key", f"key file {key.path} {key.fault}", "run the doctor as the robot's user")
    elif key.fault:
        remedy = f"rosrun adhoc_communication team_key create {key.path} on one robot, and copy it to the others"
        yield Finding("key", f"key file {key.path} {key.fault}", remedy)
    elif key.mode & 0o077:
        yield Finding("key", f"key file {key.path} can be read by others", f"chmod 600 {key.path}")


def check_host_name(facts: Facts) -> Iterator[Finding]:
    own = facts.computer.own_name
    if not own.fault:
        return
    if own.source == HOST_NAME:
        remedy = f"add '127.0.1.1 {own.name}' to /etc/hosts, or export ROS_HOSTNAME=localhost before roslaunch"
    else:
        remedy = f"unset {own.source} or correct it, and start the nodes again"
    yield Finding("name", f"{own.source} {own.name} {own.fault}, so nodes cannot reach one another", remedy)


def check_load(facts: Facts) -> Iterator[Finding]:
    """Of a running robot. Simulated time waits for the computer, so a robot in simulation is slow and not wrong."""
    computer = facts.computer
    if facts.clock is None or facts.clock.simulated:
        return
    if computer.busy > MOST_BUSY and computer.load > MOST_LOAD:
        by = f", most by {computer.busiest}" if computer.busiest else ""
        remedy = "end what is not needed, or lower the rate of the laser"
        yield Finding("cpu", f"all processor cores are busy (load {computer.load:.1f} for each{by})", remedy)


def check_memory(facts: Facts) -> Iterator[Finding]:
    computer = facts.computer
    if computer.memory_available < LEAST_MEMORY:
        what = f"memory is nearly full: {computer.memory_available >> 20} of {computer.memory >> 20} MB are left"
        yield Finding("memory", what, "end what is not needed")


def check_disks(facts: Facts) -> Iterator[Finding]:
    for folder, octets in facts.computer.disks.items():
        if octets < LEAST_DISK:
            what = f"the disk of {folder} is nearly full: {octets >> 20} MB are left"
            yield Finding("disk", what, "delete old logs and bags (rosclean purge), or give another folder")


def check_date(facts: Facts) -> Iterator[Finding]:
    if facts.computer.year < FIRST_YEAR:
        what = f"the computer's clock says the year {facts.computer.year}"
        yield Finding("time", what, "set it before the mission: sudo date -s 'YYYY-MM-DD hh:mm:ss'")
