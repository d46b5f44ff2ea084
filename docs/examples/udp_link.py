"""A link of one's own: frames as UDP multicast over any interface with IP, such as a modem or a tunnel."""

import socket
import struct
from typing import List

GROUP, PORT = "239.255.136.181", 8853
MOST_AT_ONCE = 64  # frames of one call


class UdpLink:
    """`interface`: by name. All robots that it connects hear one another, and others on it may: have a team key."""

    def __init__(self, interface: str) -> None:
        place = struct.pack("4s4si", socket.inet_aton(GROUP), bytes(4), socket.if_nametoindex(interface))
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # several robots of one computer
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, place)
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, place)
        self._socket.bind((GROUP, PORT))

    def fileno(self) -> int:
        return self._socket.fileno()

    def send(self, frame: bytes) -> None:
        self._socket.sendto(frame, (GROUP, PORT))

    def receive(self) -> List[bytes]:
        frames: List[bytes] = []
        try:
            while len(frames) < MOST_AT_ONCE:
                frames.append(self._socket.recv(65535))
        except BlockingIOError:
            pass
        return frames
