#!/usr/bin/env python3
"""One end of a TCP or UDP transfer; says what happened as one line of JSON. Times are of the monotonic clock.

ip_peer.py tcp-receive PORT SECONDS               {"octets", "digest", "time"}
ip_peer.py tcp-send ADDRESS PORT OCTETS SECONDS   {"begin", "digest"}
ip_peer.py udp-receive PORT SECONDS               {"datagrams"}: until nothing has come for two seconds
ip_peer.py udp-send ADDRESS PORT OCTETS RATE      {"datagrams"}: RATE in bit/s
ip_peer.py udp-longest-gap PORT SECONDS           {"first"}, then {"gap"}: s without a datagram, once GAP or more
ip_peer.py udp-tick ADDRESS PORT SECONDS          sends a datagram each PERIOD
"""

import contextlib
import hashlib
import json
import os
import socket
import struct
import sys
import time

DATAGRAM = 1400
PERIOD = 0.01  # s
GAP = 0.2  # s, much longer than it takes to start or stop a program


def say(**values):
    print(json.dumps(values), flush=True)


def tcp_receive(port, seconds):
    end = time.monotonic() + seconds
    payload = b""
    with socket.create_server(("", port)) as server:
        server.settimeout(seconds)
        say(ready=True)
        try:
            connection, _ = server.accept()
            with connection:
                while time.monotonic() < end:
                    connection.settimeout(max(0.001, end - time.monotonic()))
                    part = connection.recv(1 << 16)
                    if not part:
                        break
                    payload += part
        except OSError:
            pass
    say(octets=len(payload), digest=hashlib.md5(payload).hexdigest(), time=time.monotonic())


def tcp_send(address, port, octets, seconds):
    payload = os.urandom(octets)
    begin = time.monotonic()
    try:
        with socket.create_connection((address, port), timeout=seconds) as connection:
            connection.sendall(payload)
    except OSError:
        pass
    say(begin=begin, digest=hashlib.md5(payload).hexdigest())


def udp_receive(port, seconds):
    numbers = set()
    end = time.monotonic() + seconds
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        receiver.bind(("", port))
        receiver.settimeout(seconds)
        say(ready=True)
        try:
            while time.monotonic() < end:
                numbers.add(struct.unpack_from("!I", receiver.recv(2 * DATAGRAM))[0])
                receiver.settimeout(2.0)
        except OSError:
            pass
    say(datagrams=len(numbers))


def udp_send(address, port, octets, rate):
    count = -(-octets // DATAGRAM)
    payload = os.urandom(DATAGRAM - 4)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        begin = time.monotonic()
        for number in range(count):
            time.sleep(max(0.0, begin + number * 8 * DATAGRAM / rate - time.monotonic()))
            sender.sendto(struct.pack("!I", number) + payload, (address, port))
    say(datagrams=count)


def udp_longest_gap(port, seconds):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("", port))
        receiver.settimeout(seconds)
        say(ready=True)
        last = None
        try:
            while True:
                receiver.recv(DATAGRAM)
                now = time.monotonic()
                if last is None:
                    say(first=now)
                elif now - last >= GAP:
                    say(gap=now - last)
                    return
                last = now
        except OSError:
            say(gap=seconds)


def udp_tick(address, port, seconds):
    end = time.monotonic() + seconds
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        while time.monotonic() < end:
            with contextlib.suppress(OSError):  # no route for the moment
                sender.sendto(b"tick", (address, port))
            time.sleep(PERIOD)


def main():
    role, *words = sys.argv[1:]
    if role == "tcp-receive":
        tcp_receive(int(words[0]), float(words[1]))
    elif role == "tcp-send":
        tcp_send(words[0], int(words[1]), int(words[2]), float(words[3]))
    elif role == "udp-receive":
        udp_receive(int(words[0]), float(words[1]))
    elif role == "udp-send":
        udp_send(words[0], int(words[1]), int(words[2]), float(words[3]))
    elif role == "udp-longest-gap":
        udp_longest_gap(int(words[0]), float(words[1]))
    elif role == "udp-tick":
        udp_tick(words[0], int(words[1]), float(words[2]))


if __name__ == "__main__":
    main()
