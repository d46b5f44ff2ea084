"""A link of one's own carries the frames of robots; the example of the documentation does."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from live_master import LiveMaster

from mr_launch.errors import UserError
from mr_launch.exit_codes import FAILED
from mr_launch.link import MOST_CLIENTS, Hub, link_at, main

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLE = PACKAGE.parents[1] / "docs" / "examples" / "udp_link.py"
PATIENCE = 20.0  # s


class Wire:
    """One end of a pair of sockets as a link."""

    def __init__(self, end):
        self._end = end
        self._end.setblocking(False)

    def fileno(self):
        return self._end.fileno()

    def send(self, frame):
        self._end.send(frame)

    def receive(self):
        return [self._end.recv(65536)]


@pytest.fixture
def wire():
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with ours, theirs:
        theirs.settimeout(PATIENCE)
        yield ours, theirs


@pytest.fixture
def hub(tmp_path, wire):
    made = Hub(tmp_path / "new" / "hub", Wire(wire[0]))
    yield made
    made.close()
    assert not (tmp_path / "new" / "hub").exists()


def client(path, name=b"anna"):
    one = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    one.settimeout(PATIENCE)
    one.connect(str(path))
    one.send(name)
    return one


def settle(hub, steps=20):
    for _ in range(steps):
        hub.step(0.0)


def test_only_sockets_are_removed(wire, tmp_path):
    """Once any file at the path of the hub was deleted."""
    path = tmp_path / "notes"
    path.write_text("mine")
    with pytest.raises(UserError, match=f"no hub socket at {path}: .* no socket"):
        Hub(path, Wire(wire[0]))
    assert path.read_text() == "mine"
    hub = Hub(tmp_path / "hub", Wire(wire[0]))
    (tmp_path / "hub").unlink()
    path.rename(tmp_path / "hub")
    hub.close()
    assert (tmp_path / "hub").read_text() == "mine"
    left = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with left:
        left.bind(str(tmp_path / "left"))
    Hub(tmp_path / "left", Wire(wire[0])).close()


def test_a_socket_that_is_there_listens(wire, tmp_path, monkeypatch):
    """Between the two a client was refused."""
    listen = socket.socket.listen

    def looks_first(one):
        assert not (tmp_path / "hub").exists()
        listen(one)

    monkeypatch.setattr(socket.socket, "listen", looks_first)
    hub = Hub(tmp_path / "hub", Wire(wire[0]))
    client(tmp_path / "hub").close()
    hub.close()
    assert not os.listdir(tmp_path)


def test_frames_pass_both_ways(hub, wire, tmp_path):
    with client(tmp_path / "new" / "hub") as anna:
        anna.send(b"\1" * 2318)
        settle(hub)
        assert wire[1].recv(9999) == b"\1" * 2318, "the name is no frame"
        wire[1].send(b"\2" * 60)
        settle(hub)
        assert anna.recv(9999) == b"\2" * 60


def test_clients_come_and_go_and_have_an_end(hub, wire, tmp_path):
    client(tmp_path / "new" / "hub").close()
    settle(hub)
    clients = [client(tmp_path / "new" / "hub") for _ in range(MOST_CLIENTS)]
    settle(hub)
    late = client(tmp_path / "new" / "hub")
    settle(hub)
    with pytest.raises(ConnectionResetError):
        late.recv(99)
    clients.pop().close()
    settle(hub)
    clients.append(client(tmp_path / "new" / "hub"))
    settle(hub)
    wire[1].send(b"\3" * 60)
    settle(hub)
    assert [one.recv(99) for one in clients] == [b"\3" * 60] * MOST_CLIENTS
    for one in (*clients, late):
        one.close()


def test_who_does_not_listen_holds_up_nobody(hub, wire, tmp_path):
    with client(tmp_path / "new" / "hub"), client(tmp_path / "new" / "hub") as listens:
        settle(hub)
        for number in range(2000):
            wire[1].send(number.to_bytes(2, "big") * 500)
            settle(hub, 2)
            assert listens.recv(9999)[:2] == number.to_bytes(2, "big")


def test_a_link_that_fails_loses_frames_and_goes_on(tmp_path, wire):
    class Bad(Wire):
        def send(self, frame):
            raise OSError("no route")

    hub = Hub(tmp_path / "hub", Bad(wire[0]))
    with client(tmp_path / "hub") as anna:
        anna.send(b"\1" * 60)
        settle(hub)
        wire[1].send(b"\2" * 60)
        settle(hub)
        assert anna.recv(99) == b"\2" * 60
    hub.close()


def test_a_link_that_is_gone_ends_the_program_with_words(tmp_path):
    """Its socket stayed readable, and the program turned in a circle without a word."""
    file = tmp_path / "gone.py"
    file.write_text(
        "import socket\nclass Gone:\n    def __init__(self, interface):\n        self.ends = socket.socketpair()\n"
        "        self.ends[1].close()\n    def fileno(self):\n        return self.ends[0].fileno()\n"
        "    def send(self, frame):\n        pass\n    def receive(self):\n        raise OSError('the modem is off')\n"
    )
    words = [sys.executable, str(PACKAGE / "nodes" / "link"), "--link", f"{file}:Gone", "--hub", str(tmp_path / "hub")]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert ended.returncode == FAILED and ended.stderr == f"link: {file}:Gone is gone: the modem is off\n"
    assert not (tmp_path / "hub").exists()


@pytest.mark.parametrize(
    ("place", "part"),
    [
        ("{file}:No", "has no No"),
        ("udp", "link 'udp' is no place: module:NAME or FILE.py:NAME"),
        ("{file}:Raises", "with the interface 'x0': ValueError: no x0 here"),
        ("{file}:Deaf", "it has no send, receive"),
        ("/nowhere.py:A", "FileNotFoundError"),
    ],
)
def test_what_is_no_link_is_named(tmp_path, capsys, place, part):
    file = tmp_path / "links.py"
    file.write_text(
        "class Raises:\n    def __init__(self, interface):\n        raise ValueError(f'no {interface} here')\n"
        "class Deaf:\n    def __init__(self, interface):\n        pass\n    def fileno(self):\n        return 0\n"
    )
    place = place.format(file=file)
    with pytest.raises(UserError) as error:
        link_at(place, "x0")
    assert part in str(error.value)
    assert main(["--link", place, "--hub", str(tmp_path / "hub"), "--interface", "x0", "__name:=link"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def free_udp_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@pytest.fixture
def example(tmp_path):
    """Place of the example's class, with a port of its own."""
    path = tmp_path / "own_link.py"
    path.write_text(EXAMPLE.read_text().replace("8853", str(free_udp_port())))
    return f"{path}:UdpLink"


def test_the_program_ends_when_it_is_asked_to(tmp_path, example):
    words = [sys.executable, PACKAGE / "nodes" / "link", "--link", example, "--interface", "lo"]
    programs = {name: subprocess.Popen([*map(str, words), "--hub", str(tmp_path / name)]) for name in "ab"}
    try:
        until(lambda: all((tmp_path / name).exists() for name in "ab"))
        with client(tmp_path / "a") as anna, client(tmp_path / "b", b"bob") as bob:
            anna.send(b"\7" * 1500)
            assert bob.recv(9999) == b"\7" * 1500
        for program in programs.values():
            program.send_signal(signal.SIGTERM)
            assert program.wait(PATIENCE) == 0
        assert not any((tmp_path / name).exists() for name in "ab")
    finally:
        for program in programs.values():
            program.kill()
            program.wait()


def until(done):
    end = time.monotonic() + PATIENCE
    while not done():
        assert time.monotonic() < end, "not ready"
        time.sleep(0.05)


def test_robots_hear_one_another_over_the_example(tmp_path, example):
    """As robot.launch starts them, each on a master of its own."""
    masters = {}
    try:
        for name in ("anna", "bob"):
            (tmp_path / name).mkdir()
            masters[name] = master = LiveMaster(tmp_path / name)
            hub = tmp_path / name / "hub"
            words = ("rosrun", "mr_launch", "link", "--link", example, "--interface", "lo", "--hub", hub)
            master.start("link", *words, "__name:=link")
            node = ("rosrun", "adhoc_communication", "adhoc_communication")
            master.start("node", *node, f"_interface:=hub:{hub}", f"_robot_name:={name}")
        question = ("rosservice", "call", "/adhoc_communication/get_neighbors")
        masters["anna"].wait_for(lambda: "bob" in masters["anna"].run(*question).stdout)
        masters["bob"].wait_for(lambda: "anna" in masters["bob"].run(*question).stdout)
    finally:
        for master in masters.values():
            master.close()
    assert os.listdir(tmp_path / "anna").count("hub") == 0
