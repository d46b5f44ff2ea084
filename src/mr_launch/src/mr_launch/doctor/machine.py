"""Looks at the computer: /sys, /proc, files. Knows no ROS but where its programs and files are."""

from __future__ import annotations

import contextlib
import fcntl
import os
import socket
import stat
import struct
import time
from pathlib import Path
from typing import Any, Iterable

import psutil

from mr_launch.doctor.facts import HOST_NAME, HUB, Computer, Hub, Interface, KeyFile, OwnName
from mr_launch.processor_shares import process_name
from mr_launch.programs import find_executable

CAP_NET_RAW = 13  # number of the capability, linux/capability.h
SIOCGIWMODE = 0x8B07  # linux/wireless.h
WIRELESS_MODES = {1: "IBSS", 2: "managed", 3: "AP", 4: "repeater", 5: "secondary", 6: "monitor", 7: "mesh point"}


def interface_of(name: str, frame_size: int) -> Interface:
    statistics = psutil.net_if_stats()
    found = statistics.get(name)
    existing = tuple(sorted(statistics))
    if found is None:
        return Interface(name, existing)
    wireless = Path(f"/sys/class/net/{name}/wireless").exists() or Path(f"/sys/class/net/{name}/phy80211").exists()
    mode = _wireless_mode(name) if wireless else ""
    return Interface(name, existing, _is_up(name, found.isup), wireless, mode, found.mtu, frame_size)


def _is_up(name: str, running: bool) -> bool:
    """As its owner has set it: a radio without a neighbour has no carrier, and nothing is wrong with it."""
    try:
        return bool(int(Path(f"/sys/class/net/{name}/flags").read_text(), 16) & 1)
    except (OSError, ValueError):
        return running


def _wireless_mode(name: str) -> str:
    request = struct.pack("16sI12x", name.encode(), 0)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        try:
            answer = fcntl.ioctl(any_socket, SIOCGIWMODE, request)
        except OSError:
            return ""
    return WIRELESS_MODES.get(struct.unpack("16sI12x", answer)[1], "")


def hub_of(interface: str) -> Hub:
    path = interface[len(HUB) :]
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as hub:
        hub.settimeout(1.0)
        try:
            hub.connect(path)
        except OSError as error:
            return Hub(path, error.strerror or str(error))
    return Hub(path)


def key_file_of(path: str) -> KeyFile:
    place = Path(os.path.expanduser(path))  # as the node takes it
    if not place.is_absolute():
        return KeyFile(path, absolute=False)
    try:
        status = place.stat()
        if not stat.S_ISREG(status.st_mode):
            return KeyFile(path, fault="is not a file")
        fault = _fault_in(place.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        reason = "it is no text" if isinstance(error, UnicodeDecodeError) else error.strerror
        return KeyFile(path, fault=f"cannot be read: {reason}", denied=isinstance(error, PermissionError))
    return KeyFile(path, fault=fault, mode=stat.S_IMODE(status.st_mode))


def _fault_in(text: str) -> str:
    """What is wrong with the content of a key file; as adhoc_communication reads it."""
    lines = [(number, line.strip()) for number, line in enumerate(text.splitlines(), start=1)]
    keys = [(number, line) for number, line in lines if line and not line.startswith("#")]
    for number, line in keys:
        if len(line) != 64 or set(line.lower()) - set("0123456789abcdef"):
            return f"is broken: line {number} is not a key of 64 hexadecimal digits"
    return "" if keys else "holds no key"


def computer_of(folders: Iterable[str], seconds: float) -> Computer:
    """Takes `seconds` to see how busy the computer is. `folders`: those that the robot writes to."""
    program = find_executable("adhoc_communication", "adhoc_communication") or ""
    program = os.path.realpath(program) if program else ""
    memory = psutil.virtual_memory()
    busy, busiest = _load(seconds)
    return Computer(
        host_name=socket.gethostname(),
        own_name=own_name(),
        raw_sockets=bool(program) and (_own_capability() or _file_capability(program)),
        program=program,
        busy=busy,
        load=os.getloadavg()[0] / (os.cpu_count() or 1),
        busiest=busiest,
        memory=memory.total,
        memory_available=memory.available,
        disks=_free_octets(folders),
        year=time.gmtime().tm_year,
    )


def own_name() -> OwnName:
    """Nodes tell one another the host name, unless the environment says another one."""
    for variable in ("ROS_HOSTNAME", "ROS_IP"):
        name = os.environ.get(variable)
        if name:
            return OwnName(name, variable, fault_of_name(name))
    name = socket.gethostname()
    return OwnName(name, HOST_NAME, fault_of_name(name))


def fault_of_name(name: str) -> str:
    """Why a host's name or address does not lead to this computer; empty if it does."""
    try:
        found = socket.getaddrinfo(name, None, type=socket.SOCK_DGRAM)
    except (OSError, UnicodeError) as error:
        return f"leads nowhere ({getattr(error, 'strerror', None) or error})"
    if any(_is_own(family, address) for family, _, _, _, address in found):
        return ""
    return "is not an address of this computer"


def _is_own(family: int, address: tuple[Any, ...]) -> bool:
    """Only an own address can be bound."""
    try:
        with socket.socket(family, socket.SOCK_DGRAM) as any_socket:
            any_socket.bind(address)
    except OSError:
        return False
    return True


def _own_capability() -> bool:
    """This process, and with it nodes of the same user, may open raw sockets."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("CapEff:"):
            return bool(int(line.split()[1], 16) >> CAP_NET_RAW & 1)
    return False


def _file_capability(program: str) -> bool:
    """The file gives the capability to whoever runs it (struct vfs_cap_data: revision and flags, permitted, ...)."""
    try:
        octets = os.getxattr(program, "security.capability")
    except OSError:
        return False
    return bool(struct.unpack_from("<I", octets, 4)[0] >> CAP_NET_RAW & 1)


def _load(seconds: float) -> tuple[float, str]:
    """Busy share of all cores within `seconds`, and the process with the largest share."""
    processes = list(psutil.process_iter(["cmdline"]))
    for process in processes:
        _share(process)
    busy = psutil.cpu_percent(seconds) / 100.0
    shares = [(_share(process), index) for index, process in enumerate(processes)]
    if not shares:
        return busy, ""
    command = processes[max(shares)[1]].info["cmdline"] or []
    return busy, process_name(" ".join(command))


def _share(process: psutil.Process) -> float:
    try:
        return float(process.cpu_percent())
    except psutil.Error:
        return 0.0


def _free_octets(folders: Iterable[str]) -> dict[str, int]:
    """Of the file system of each folder, or of the nearest one above it that is seen to exist; each file system once.
    Folders of the robot's user may be closed to others."""
    found: dict[int, tuple[str, int]] = {}
    for folder in folders:
        place = Path(folder).expanduser().absolute()
        while not os.path.exists(place):
            place = place.parent
        with contextlib.suppress(OSError):
            found.setdefault(place.stat().st_dev, (folder, psutil.disk_usage(str(place)).free))
    return dict(found.values())
