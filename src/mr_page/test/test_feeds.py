"""Feeds of a team: updates go up, commands go down, robots come and go; radios are switched."""

import asyncio
import socket
import sys
import threading

import numpy as np
import pytest

from mr_grid import OccupancyGrid
from mr_page import team_page
from mr_page.commands import Answer, Order
from mr_page.feeds import FeedLink, FeedServer
from mr_page.radio_switch import RadioSwitch
from mr_page.state import PageState
from mr_page.update import Update, encoded
from mr_page.viewer import Viewer

PATIENCE = 5.0  # s


async def until(condition):
    end = asyncio.get_running_loop().time() + PATIENCE
    while not condition():
        assert asyncio.get_running_loop().time() < end, "it does not come"
        await asyncio.sleep(0.005)


def told(state):
    update = Viewer(state).update(0.0)
    assert update is not None
    return encoded(update)


def robot_state(name, **values):
    state = PageState()
    for key, value in values.items():
        state.put(name, key, value)
    return state


def test_what_feeds_tell_is_there(tmp_path):
    async def run():
        state = PageState()
        server = FeedServer(state, str(tmp_path / "feeds"))
        mine = robot_state("a", pose=[1.0, 2.0, 0.0])
        mine.map("a", "local").take(OccupancyGrid.of(np.zeros((70, 70), dtype=np.int8), 0.05))
        link = FeedLink(str(tmp_path / "feeds"), "a")
        link.send(told(mine))
        await until(lambda: state.get("a", "pose") and len(state.map("a", "local")) == 4)
        assert state.get("a", "lost") is False
        link.close()
        await until(lambda: state.get("a", "lost"))
        again = FeedLink(str(tmp_path / "feeds"), "a")
        again.send(told(robot_state("a", x=1)))
        await until(lambda: state.get("a", "x") == 1)
        assert state.get("a", "pose") is None and state.get("a", "lost") is False
        again.close()
        server.close()

    asyncio.run(run())


def test_commands_reach_the_robot_and_answers_come_back(tmp_path):
    async def run():
        server = FeedServer(PageState(), str(tmp_path / "feeds"))
        assert "does not feed this page" in (await server.command("a", Order("pause"))).text
        link = FeedLink(str(tmp_path / "feeds"), "a")

        def robot():
            got = []
            while len(got) < 2:
                for order in link.orders(PATIENCE):
                    got.append(order)
                    link.answer(Answer(order.command == "pause", f"{order.command} {order.to}"))

        thread = threading.Thread(target=robot)
        thread.start()
        await until(lambda: server._feeds)
        answers = await asyncio.gather(
            server.command("a", Order("pause")), server.command("a", Order("pass_on_stop", "b"))
        )
        assert answers == [(True, "pause "), (False, "pass_on_stop b")]
        await asyncio.to_thread(thread.join)
        waiting = asyncio.ensure_future(server.command("a", Order("pause")))
        await asyncio.sleep(0)
        link.close()
        assert "gone" in (await waiting).text
        server.close()

    asyncio.run(run())


@pytest.mark.parametrize("message", [b"nonsense", b"{", encoded(Update()), told(robot_state("b", x=1))])
def test_a_feed_that_tells_nonsense_or_of_others_is_closed(tmp_path, message):
    async def run():
        state = PageState()
        server = FeedServer(state, str(tmp_path / "feeds"))
        link = FeedLink(str(tmp_path / "feeds"), "a")
        link.send(message)
        if message == encoded(Update()):  # nothing new is no nonsense
            link.send(told(robot_state("a", x=1)))
            await until(lambda: state.get("a", "x") == 1)
        else:
            await until(lambda: state.get("a", "lost"))
        assert "b" not in state.robots
        server.close()

    asyncio.run(run())


def test_radios_are_switched(tmp_path):
    path = str(tmp_path / "radio")
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as daemon:
        daemon.bind(path)
        daemon.listen()

        async def run():
            state = PageState()
            server = FeedServer(state, str(tmp_path / "feeds"), RadioSwitch(path))
            link = FeedLink(str(tmp_path / "feeds"), "robot_1")
            await until(lambda: state.get("robot_1", "switchable"))
            answer = await server.command("robot_1", Order("radio_off"))
            assert answer == (True, "radio of robot_1 off") and state.get("robot_1", "radio_off") is True
            link.close()
            await until(lambda: state.get("robot_1", "lost"))
            link = FeedLink(str(tmp_path / "feeds"), "robot_1")
            await until(lambda: state.get("robot_1", "lost") is False)
            assert state.get("robot_1", "radio_off") is True, "a feed that begins anew repairs no radio"
            link.close()
            server.close()

        asyncio.run(run())
        connection, _ = daemon.accept()
        with connection:
            assert connection.recv(100) == b"down robot_1\n"


def test_radios_that_cannot_be_switched(tmp_path):
    assert not RadioSwitch(str(tmp_path / "none")).switch("robot_1", "radio_off").done
    assert "no name of a robot" in RadioSwitch("x").switch("robot_1\nrange 3", "radio_off").text

    async def run():
        server = FeedServer(PageState(), str(tmp_path / "feeds"))
        assert "only radios of simulated robots" in (await server.command("a", Order("radio_off"))).text
        server.close()

    asyncio.run(run())


@pytest.mark.parametrize("port", ["0", "-1", "65536", "99999"])
def test_a_port_that_cannot_be_is_refused(tmp_path, monkeypatch, capsys, port):
    """Once 99999 was served at another port."""
    monkeypatch.setattr(sys, "argv", ["team_page", "--feeds", str(tmp_path / "feeds"), "--port", port])
    with pytest.raises(SystemExit) as stopped:
        team_page.main()
    assert stopped.value.code == 2 and f"--port {port} is out of range: 1 to 65535" in capsys.readouterr().err


def test_a_file_in_place_of_the_socket_of_feeds_is_one_sentence(tmp_path, monkeypatch, capsys):
    path = tmp_path / "feeds"
    path.write_text("mine")
    monkeypatch.setattr(sys, "argv", ["team_page", "--feeds", str(path)])
    assert team_page.main() == 1
    assert capsys.readouterr().err == f"team_page: --feeds {path} is there already, and no socket; give another path\n"
    assert path.read_text() == "mine"


@pytest.mark.parametrize(
    ("name", "why"), [("none/feeds", "No such file or directory"), ("x" * 120, "AF_UNIX path too long")]
)
def test_feeds_that_cannot_be_are_told_with_the_remedy(name, why, tmp_path, capsys, monkeypatch):
    path = tmp_path / name
    monkeypatch.setattr(sys, "argv", ["team_page", "--feeds", str(path)])
    assert team_page.main() == 1
    said = capsys.readouterr().err
    assert said == f"team_page: --feeds {path} cannot be made: {why}; give a path in a folder of yours\n"
