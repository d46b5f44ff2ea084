"""Robots' protocol engines on a simulated radio, in virtual time. Times are int nanoseconds, places metres."""

import numpy as np

class PayloadError(ValueError): ...

class PacketReceived:
    source: str
    group: str  # empty unless sent to a group
    topic: str
    hops: int
    def message(self) -> tuple[str, bytes]:
        """Type and ROS serialisation, checked to the last octet, with the true sender. Raises PayloadError."""

class SendFinished:
    id: int
    delivered: bool
    reason: str

class RobotAppeared:
    robot: str

class RobotLost:
    robot: str

class GroupChangeFinished:
    group: str
    joined: bool
    succeeded: bool
    reason: str

Event = PacketReceived | SendFinished | RobotAppeared | RobotLost | GroupChangeFinished

class MediumOptions:
    range: float  # m
    loss: float  # per frame and receiver
    bit_rate: float  # bit/s
    shared: bool
    contention: bool
    wall_attenuation: float  # dB per wall
    def set_walls(self, cells: np.ndarray, resolution: float, origin: tuple[float, float]) -> None:
        """Occupied cells, uint8 (rows, columns) from the lower left; m per cell; lower left corner in m."""

class EngineOptions:
    robot_name: str
    num_link_retrans: int
    num_e2e_retrans: int
    max_frame_size: int
    max_packet_size: int
    join_groups_automatically: bool

class Team:
    def __init__(self, medium: MediumOptions, seed: int) -> None: ...
    def set_key(self, key: bytes) -> None:
        """32 octets, for the robots added from now on."""
    def add(self, options: EngineOptions, x: float, y: float) -> int:
        """Returns the robot's number."""
    def advance(self, until: int) -> list[tuple[int, Event]]:
        """Runs to `until`, or to the first moment at which robots report something."""
    def send(self, robot: int, service: str, destination: str, topic: str, message: bytes) -> int:
        """What a call of the node's service does with this serialised message; returns the id of its SendFinished."""
    def send_message(
        self, robot: int, destination: str, topic: str, type: str, md5sum: str, definition: str, data: bytes
    ) -> int:
        """What a call of the node's service send_message does; returns the id of its SendFinished. Raises PayloadError
        for a type or MD5 sum that is none."""
    def kill(self, robot: int) -> None: ...
    def restart(self, robot: int) -> None: ...
    def set_position(self, robot: int, x: float, y: float) -> None: ...
    def neighbors(self, robot: int) -> list[str]: ...
    def robots(self, robot: int) -> list[str]: ...
    def statistics(self, robot: int) -> dict[str, object]: ...
    @property
    def now(self) -> int: ...
    @property
    def trace_hash(self) -> int: ...
