"""The world process: its protocol, its patience with bad and dead clients, its pace and its messages."""

import contextlib
import json
import os
import selectors
import signal
import socket
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import pytest

from mr_measures.motion import read_trace
from mr_sim import protocol as p
from mr_sim import world_server
from mr_sim.radio_control import RadioControl
from mr_sim.trace import TraceWriter
from mr_sim.world_client import ConnectionRefused, WorldClient
from mr_sim.world_server import MAX_LAG, SPARE_CONNECTIONS, ServerError, WorldServer, listen

TWO = 'rover ( name "a" pose [ 0 0 0 0 ] )\nrover ( name "b" pose [ 0 2 0 0 ] )\n'


class Running:
    """A server in a thread of its own."""

    def __init__(self, world, path, **options):
        self.path = str(path)
        self.said = []
        self.server = WorldServer(world, listen(self.path), say=self.said.append, **options)
        self._thread = threading.Thread(target=self.server.run)
        self._thread.start()

    def connect(self, name):
        return WorldClient.connect(self.path, name, timeout=5.0)

    def raw(self):
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        connection.settimeout(10.0)
        connection.connect(self.path)
        return connection

    def join(self):
        self._thread.join(20.0)
        assert not self._thread.is_alive()

    def stop(self):
        self.server.stop()
        self.join()


@pytest.fixture
def start(make_world, tmp_path):
    running = []

    def begin(text=TWO, **options):
        running.append(Running(make_world(text), tmp_path / f"socket{len(running)}", **options))
        return running[-1]

    yield begin
    for one in running:
        one.stop()


def states(client, until):
    """States up to a simulated time; the ranges between them are counted."""
    seen, ranges = [], 0
    while not seen or seen[-1].time < until - 1e-9:
        message = client.receive()
        assert message is not None, "the connection ended"
        if isinstance(message, p.State):
            seen.append(message)
        else:
            assert isinstance(message, p.Ranges) and message.time == seen[-1].time, "ranges follow their state"
            ranges += 1
    return seen, ranges


def test_a_world_takes_all_of_its_robots_and_a_bounded_number_of_others(start, monkeypatch):
    monkeypatch.setattr("mr_sim.world_server.HELLO_PATIENCE", 1000.0)
    names = [f"r{index}" for index in range(SPARE_CONNECTIONS + 6)]
    rovers = "".join(f'rover ( name "{name}" pose [ {index} 0 0 0 ] )\n' for index, name in enumerate(names))
    running = start(rovers, real_time_factor=0.0, duration=0.1)
    others = [running.raw() for _ in range(SPARE_CONNECTIONS)]
    clients = [running.connect(name) for name in names[:-1]]
    others.append(running.raw())
    one_more = running.raw()
    assert p.decode(one_more.recv(p.MAX_PACKET)).reason == "too many connections"
    for connection in (others.pop(), one_more):
        connection.close()
    clients.append(running.connect(names[-1]))
    running.join()
    for connection in [*others, *clients]:
        connection.close()


def test_a_robot_for_whom_there_is_no_room_is_told_so_whenever_it_speaks(start, monkeypatch):
    running = start()
    monkeypatch.setattr("mr_sim.world_server.SPARE_CONNECTIONS", 1)
    others = [running.raw() for _ in range(3)]
    for _ in range(20):
        with pytest.raises(ConnectionRefused, match="refuses a: too many connections"):
            running.connect("a")
    others.pop().close()
    running.connect("a").close()
    for connection in others:
        connection.close()


def test_time_begins_when_all_robots_are_there(start):
    running = start(real_time_factor=0.0, duration=2.0)
    first = running.connect("a")
    assert first.welcome.interval == 0.05 and first.welcome.start == (0, 0, 0)
    assert first.welcome.rangers[0].samples == 541
    assert running.server.world.steps == 0
    second = running.connect("b")
    for client in (first, second):
        seen, ranges = states(client, 2.0)
        assert [round(s.time / 0.05) for s in seen] == list(range(1, 41)), "every step from the first, none skipped"
        assert ranges == 19 or ranges == 20
    assert running.said == ["a connected, waiting for b", "b connected"]


def test_commands_move_the_robot_that_sends_them(start):
    running = start(real_time_factor=5.0)
    first = running.connect("a")
    first.command(0.5, 0.0)
    second = running.connect("b")
    moved = next(s for s in states(first, 1.0)[0] if s.pose[0] > 0.2)
    assert moved.wheels == (0.5, 0.0, 0.0) and moved.velocity[0] == pytest.approx(0.5)
    assert all(s.pose == (0, 2, 0) for s in states(second, 1.0)[0])


def test_commands_aside_reach_an_omnidirectional_robot(start):
    omnidirectional = 'rover ( name "a" drive "omni" velocity_bounds [ -1 1 -1 1 0 0 -90 90 ] )'
    running = start(f'{omnidirectional}\nrover ( name "b" pose [ 0 2 0 0 ] )', real_time_factor=5.0)
    client = running.connect("a")
    client.command(0.0, 0.0, lateral=0.4)
    running.connect("b")
    moved = next(s for s in states(client, 1.0)[0] if s.pose[1] > 0.1)
    assert moved.wheels == (0.0, 0.4, 0.0) and moved.odometry[1] == pytest.approx(moved.pose[1], rel=0.1)


def test_end_is_announced(start):
    running = start(TWO.splitlines()[0], real_time_factor=0.0, duration=0.5)
    client = running.connect("a")
    states(client, 0.5)
    message = client.receive()
    while isinstance(message, p.Ranges):
        message = client.receive()
    assert message == p.Bye()
    assert client.receive() is None
    running.join()
    assert not os.path.exists(running.path)


@pytest.mark.parametrize(
    ("packet", "reason"),
    [
        (b"?", "unknown kind of message"),
        (p.encode_command(1.0, 0.0, 0.0), "may not send Command now"),
        (p.encode_hello("nobody"), 'no robot "nobody" in this world; there are a, b'),
        (b"H\x07a", "protocol version 7"),
        (b"C123", "malformed message"),
    ],
)
def test_bad_client_is_told_why_and_nobody_else_suffers(start, packet, reason):
    running = start(real_time_factor=0.0, duration=1.0)
    bad = running.raw()
    bad.send(packet)
    refusal = p.decode(bad.recv(1000))
    assert isinstance(refusal, p.Refusal) and reason in refusal.reason
    assert bad.recv(1000) == b""
    client, _ = running.connect("a"), running.connect("b")
    assert states(client, 1.0)[0]


def test_name_in_use_is_refused(start):
    running = start()
    first = running.connect("a")
    with pytest.raises(ConnectionRefused, match="refuses a: a is connected already"):
        running.connect("a")
    first.close()


def test_bad_packet_of_a_robot_ends_only_that_robot(start):
    running = start(real_time_factor=0.0, duration=3.0)
    bad = running.raw()
    bad.send(p.encode_hello("a"))
    assert isinstance(p.decode(bad.recv(1000)), p.Welcome)
    bad.send(b"C\x00")
    good = running.connect("b")
    while bad.recv(10000):
        pass
    # The world had all robots for no time at all, or for some; either way it is waiting or going on, never dead.
    again = running.connect("a")
    assert states(good, 1.0)[0] and states(again, 1.0)[0]


def test_robots_go_back_to_their_starts_while_they_drive(start, monkeypatch):
    running = start(real_time_factor=0.0, duration=0.5)
    world, step = running.server.world, running.server.world.step

    def step_and_reset():
        step()
        if world.steps == 5:
            running.server.reset_positions()

    monkeypatch.setattr(world, "step", step_and_reset)
    first = running.connect("a")
    first.command(0.4, 0.0)
    second = running.connect("b")
    seen, _ = states(first, 0.5)
    assert [s.pose[0] for s in seen] == pytest.approx([0.02 * n for n in (1, 2, 3, 4, 5, 1, 2, 3, 4, 5)])
    assert [s.odometry[0] for s in seen] == pytest.approx([0.02 * n for n in range(1, 11)]), "its wheels count on"
    assert all(s.pose == (0, 2, 0) for s in states(second, 0.5)[0])


def test_intensities_come_before_their_ranges_if_the_world_tells_them(make_world, tmp_path):
    world = make_world(TWO.splitlines()[0], intensities=True)
    running = Running(world, tmp_path / "bright", real_time_factor=0.0, duration=0.5)
    client, told = running.connect("a"), []
    while not isinstance(message := client.receive(), p.Bye):
        told.append(message)
    sweeps = [message for message in told if not isinstance(message, p.State)]
    kinds = [type(message) for message in sweeps]
    running.join()
    assert kinds == [p.Intensities, p.Ranges] * 5
    assert (sweeps[0].intensities == (sweeps[1].ranges < 8.0)).all()


def test_dead_robot_stands_still_the_world_goes_on_and_it_may_return(start, monkeypatch):
    running = start(real_time_factor=5.0)
    world, step, dead = running.server.world, running.server.world.step, threading.Event()

    def step_until_it_dies():
        assert world.steps != 6 or dead.wait(20.0)
        step()

    monkeypatch.setattr(world, "step", step_until_it_dies)
    first = running.connect("a")
    first.command(0.5, 0.0)
    second = running.connect("b")
    states(first, 0.3)
    first.close()
    dead.set()
    later = states(second, 2.0)[0][-1].time
    again = running.connect("a")
    seen = states(again, later + 1.0)[0]
    assert 0.15 <= seen[0].pose[0] <= 0.2, "0.5 m/s for the six steps of 0.05 s and those until it is missed"
    assert len({s.pose for s in seen}) == 1 and seen[0].wheels == (0, 0, 0)
    assert any(line.startswith("a is gone (") for line in running.said)


def test_robot_that_does_not_read_holds_time_and_is_then_given_up(make_world, tmp_path, monkeypatch):
    """The other one reads whenever the server looks for messages, so that only the silent one is waited for."""
    monkeypatch.setattr("mr_sim.world_server.CLIENT_PATIENCE", 0.3)
    select, path, said, seen = selectors.DefaultSelector.select, str(tmp_path / "socket"), [], []
    server = WorldServer(make_world(TWO), listen(path), real_time_factor=0.0, duration=60.0, say=said.append)
    with contextlib.ExitStack() as sockets:
        silent, reading = (sockets.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)) for _ in "ab")
        for robot, name in ((silent, "a"), (reading, "b")):
            robot.connect(path)
            robot.send(p.encode_hello(name))
        reading.setblocking(False)

        def read():
            with contextlib.suppress(BlockingIOError):
                while packet := reading.recv(p.MAX_PACKET):
                    seen.append(p.decode(packet))

        monkeypatch.setattr(selectors.DefaultSelector, "select", lambda *waiting: (read(), select(*waiting))[1])
        server.run()
        read()
    assert sum(isinstance(message, p.State) for message in seen) == 1200, "nothing skipped"
    assert any("did not read for 0.3 s" in line for line in said)


def test_connection_without_hello_is_closed(start, monkeypatch):
    monkeypatch.setattr("mr_sim.world_server.HELLO_PATIENCE", 0.1)
    running = start()
    silent = running.raw()
    assert p.decode(silent.recv(1000)) == p.Refusal("no hello")


@pytest.mark.parametrize(
    "busy, wall",
    [
        (0.0, 0.5),
        (0.01, 0.5 + 0.01),
        (0.02, 0.0125 + 40 * 0.02),
        ({9: 0.1}, 0.5),
        ({9: 1.0}, 0.5 + 1.0 - MAX_LAG),
    ],
    ids=["at once", "in time", "too slow", "a little late", "much too late"],
)
def test_pace_follows_the_real_time_factor(make_world, tmp_path, monkeypatch, busy, wall):
    """On a clock that goes on only while the server waits or its world steps; `busy`: s of each step, or of some."""
    clock = SimpleNamespace(now=100.0, monotonic=lambda: clock.now)
    select = selectors.DefaultSelector.select

    def wait(selector, timeout):
        ready = select(selector, 0.0)
        clock.now += 0.0 if ready else timeout
        return ready

    monkeypatch.setattr(world_server, "time", clock)
    monkeypatch.setattr(selectors.DefaultSelector, "select", wait)
    world = make_world('position ( name "a" )\n')
    step = world.step

    def step_slowly():
        clock.now += busy.get(world.steps, 0.0) if isinstance(busy, dict) else busy
        step()

    monkeypatch.setattr(world, "step", step_slowly)
    path = str(tmp_path / "socket")
    server = WorldServer(world, listen(path), real_time_factor=4.0, duration=2.0, say=lambda _: None)
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as robot:
        robot.connect(path)
        robot.send(p.encode_hello("a"))
        server.run()
    assert server.wall == pytest.approx(wall, abs=0.015)
    assert server.achieved_factor == pytest.approx(2.0 / server.wall)


def test_slow_world_slows_down_and_skips_nothing(start, monkeypatch):
    running = start(TWO.splitlines()[0], real_time_factor=10.0, duration=2.0)
    step = running.server.world.step
    monkeypatch.setattr(running.server.world, "step", lambda: (time.sleep(0.02), step()))
    seen, _ = states(running.connect("a"), 2.0)
    running.join()
    assert len(seen) == 40
    assert running.server.achieved_factor < 3.0, "the world takes 20 ms for a step of 50 ms: at most 2.5"


def test_trace_tells_the_truth(start, tmp_path):
    path = tmp_path / "trace.csv"
    running = start(real_time_factor=0.0, duration=1.0, trace=TraceWriter(path, "x.world", 3, 0.0))
    first, second = running.connect("a"), running.connect("b")
    seen, _ = states(first, 1.0)
    states(second, 1.0)
    running.join()
    trace = read_trace(path)
    assert set(trace.robots) == {"a", "b"}
    assert trace.robots["a"]["time"] == pytest.approx([s.time for s in seen])
    assert trace.robots["b"]["y"] == pytest.approx([2.0] * 20)
    assert trace.real_time_factor == pytest.approx(running.server.achieved_factor, rel=0.01)


def test_radio_daemon_learns_positions(start, tmp_path):
    path = str(tmp_path / "radio")
    daemon = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    daemon.bind(path)
    daemon.listen(1)
    daemon.settimeout(10.0)
    running = start(real_time_factor=0.0, duration=1.0, radio=RadioControl(path))
    connection, _ = daemon.accept()
    connection.settimeout(10.0)
    assert connection.recv(1000) == b"position a 0.000 0.000\nposition b 0.000 2.000\n", "known before time begins"
    clients = running.connect("a"), running.connect("b")
    for client in clients:
        states(client, 1.0)
    count = 0
    while connection.recv(1000):
        count += 1
    assert 9 <= count <= 11, "every 0.1 s of simulated time"


def test_radio_daemon_may_be_missing_or_die(tmp_path, make_world):
    said = []
    radio = RadioControl(str(tmp_path / "radio"), said.append)
    world = make_world(TWO)
    for wall in (0.0, 0.1, 2.0):
        radio.update(world.time, wall, world.names, world.states())
    assert len(said) == 1 and "no radio daemon" in said[0]
    daemon = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    daemon.bind(str(tmp_path / "radio"))
    daemon.listen(1)
    radio.update(1.0, 4.0, world.names, world.states())
    connection, _ = daemon.accept()
    assert connection.recv(1000).startswith(b"position a")
    connection.close()
    radio.update(2.0, 5.0, world.names, world.states())
    radio.update(3.0, 7.0, world.names, world.states())
    assert daemon.accept()[0].recv(1000).startswith(b"position a")


def test_socket_path_that_cannot_be_used(tmp_path):
    with pytest.raises(ServerError, match="longer than 107"):
        listen("/tmp/" + "x" * 110)
    with pytest.raises(ServerError, match="cannot listen on"):
        listen(str(tmp_path / "none" / "socket"))
    (tmp_path / "file").write_text("")
    with pytest.raises(ServerError, match="cannot listen on"):
        listen(str(tmp_path / "file"))
    first = listen(str(tmp_path / "socket"))
    with pytest.raises(ServerError, match="another world listens"):
        listen(str(tmp_path / "socket"))
    first.close()
    listen(str(tmp_path / "socket")).close()


# --- the program ---


def world_program(*arguments, **options):
    command = [sys.executable, "-c", "import sys; from mr_sim.world_process import main; sys.exit(main())", *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--world", "nowhere"], 'no world "nowhere"'),
        (["--world", "small8x8", "--robots", "9"], "defines 4 robots; asked for 9"),
        (["--world", "small8x8", "--robots", "0"], "asked for 0"),
        (["--world", "small8x8", "--rtf", "-1"], "--rtf must be a number >= 0"),
        (["--world", "small8x8", "--rtf", "nan"], "--rtf must be a number >= 0"),
        (["--world", "small8x8", "--seed", "-1"], "--seed must not be negative"),
        (["--world", "small8x8", "--trace", "/nonexistent/trace.csv"], "/nonexistent/trace.csv"),
        (["--world", "{broken}"], 'broken.world:2: unknown word "resolutoin"'),
        (["--world", "{bitmap}"], '"bitmap" names a file that does not exist'),
    ],
)
def test_bad_input_gives_one_line_and_a_non_zero_exit(tmp_path, arguments, message):
    (tmp_path / "broken.world").write_text("\nresolutoin 0.02\n")
    (tmp_path / "bitmap.world").write_text('model ( bitmap "plan.png" )\n')
    names = {"broken": tmp_path / "broken.world", "bitmap": tmp_path / "bitmap.world"}
    program = world_program(*(a.format(**names) for a in arguments), "--socket", str(tmp_path / "socket"))
    out, err = program.communicate(timeout=30)
    assert program.returncode == 1
    assert message in err and err.count("\n") == 1 and "Traceback" not in err + out
    assert not (tmp_path / "socket").exists(), "nothing half started"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_ends_the_program_in_order(tmp_path, number):
    path, trace = str(tmp_path / "socket"), tmp_path / "trace.csv"
    program = world_program(
        "--world", "small8x8", "--socket", path, "--robots", "1", "--rtf", "0", "--trace", str(trace), "__name:=world"
    )
    assert "ready" in program.stdout.readline()
    client = WorldClient.connect(path, "robot_0", timeout=5.0)
    states(client, 1.0)
    program.send_signal(number)
    while client.receive() not in (p.Bye(), None):
        pass
    out, err = program.communicate(timeout=10)
    assert program.returncode == 0 and err == ""
    summary = json.loads(out.splitlines()[-1])
    assert summary["simulated"] >= 1.0 and summary["real_time_factor"] > 0.0
    assert read_trace(trace).real_time_factor == pytest.approx(summary["real_time_factor"], rel=0.01)
    assert not os.path.exists(path)


def test_client_without_a_world(tmp_path):
    with pytest.raises(ConnectionRefused, match="no world listens on"):
        WorldClient.connect(str(tmp_path / "none"), "a", timeout=0.0)
