"""The web server: the page, viewers, orders, and who is turned away."""

import asyncio
import re
import socket
import time

import numpy as np
import pytest
from serving import Guest, served
from tornado.httpclient import AsyncHTTPClient, HTTPClientError

from mr_grid import OccupancyGrid
from mr_page.commands import Answer
from mr_page.server import MAX_ORDERS, MAX_VIEWERS, is_own_name, listening_sockets
from mr_page.state import PageState
from mr_page.tiles import TILE
from mr_page.update import Changes


def state_with_a_map(side=2 * TILE):
    state = PageState()
    state.put("a", "pose", [1.0, 2.0, 0.0])
    state.map("a", "local").take(OccupancyGrid.of(np.zeros((side, side), dtype=np.int8), 0.05))
    return state


async def fetch(address, path="/", **headers):
    return await AsyncHTTPClient().fetch(f"http://{address}{path}", headers=headers)


def test_the_page_is_one_file_that_asks_for_nothing_else():
    async def run():
        async with served(PageState(), title="<b>") as address:
            return await fetch(address)

    answer = asyncio.run(run())
    page = answer.body.decode()
    assert "&lt;b&gt;" in page and "@@" not in page
    assert not re.search(r"<link[^>]*href=\"(?!data:)|\bsrc=|@import|url\(|\bimport\b", page)
    assert "default-src 'none'" in answer.headers["Content-Security-Policy"]


def test_a_viewer_is_told_what_there_is_and_what_becomes_new():
    async def run():
        state = state_with_a_map()
        async with served(state) as address:
            guest = await Guest.at(address)
            first = await guest.hear()
            assert first.robots["a"].values == {"pose": [1.0, 2.0, 0.0]} and not first.tiles
            await guest.say(maps=[["a", "local"]])
            assert len((await guest.hear()).tiles) == 4
            state.put("a", "pose", [3.0, 2.0, 0.0])
            assert (await guest.hear()).robots["a"].values == {"pose": [3.0, 2.0, 0.0]}

    asyncio.run(run())


def test_a_viewer_hears_something_when_nothing_is_new():
    """By that its page knows that the connection is alive."""

    async def run():
        async with served(state_with_a_map()) as address:
            guest = await Guest.at(address)
            await guest.hear()
            begin = time.monotonic()
            for _ in range(2):
                assert not await guest.hear()
            assert 2.0 < time.monotonic() - begin < 4.0

    asyncio.run(run())


def test_orders_go_to_the_robot_and_answers_come_back():
    async def run():
        state, asked = state_with_a_map(), []

        async def command(robot, order):
            asked.append((robot, *order))
            return Answer(False, "is paused already")

        async with served(state, command) as address:
            guest = await Guest.at(address)
            await guest.say(robot="a", command="pause")
            assert await guest.hear_answer() == {
                "robot": "a", "command": "pause", "to": "", "done": False, "text": "is paused already",
            }  # fmt: skip
            await guest.say(robot="a", command="explode")
            assert "there is no command 'explode'" in (await guest.hear_answer())["text"]
            await guest.say(robot="b", command="pause")
            assert "there is no robot 'b'" in (await guest.hear_answer())["text"]
            await guest.say(robot="a", command="pass_on_stop")
            assert "needs a robot to pass it on to" in (await guest.hear_answer())["text"]
            await guest.say(robot="a", command="stop", to="c")
            assert "stop is not passed on" in (await guest.hear_answer())["text"]
            await guest.say(robot="a", command="pass_on_stop", to="c")
            assert (await guest.hear_answer())["to"] == "c"
            await guest.say(robot="a", command="set_limits", limits=[600])
            assert "needs a time in s and a way in m" in (await guest.hear_answer())["text"]
            await guest.say(robot="a", command="team_set_limits", limits=[])
            assert "needs a time in s and a way in m" in (await guest.hear_answer())["text"]
            await guest.say(robot="a", command="set_limits", limits=[600, 0])
            assert (await guest.hear_answer())["command"] == "set_limits"
        assert asked == [("a", "pause", "", ()), ("a", "pass_on_stop", "c", ()), ("a", "set_limits", "", (600.0, 0.0))]

    asyncio.run(run())


def test_an_order_that_waits_holds_up_nothing_else():
    async def run():
        state, answers = state_with_a_map(), asyncio.Event()

        async def command(robot, order):
            await answers.wait()
            return Answer(True, "at last")

        async with served(state, command) as address:
            guest = await Guest.at(address)
            for _ in range(MAX_ORDERS):
                await guest.say(robot="a", command="pause")
            assert (await asked_for_past(guest, 3.0)).moment == (None, 3.0)
            await guest.say(robot="a", command="stop")
            assert "16 orders wait" in (await guest.hear_answer())["text"]
            answers.set()
            assert [(await guest.hear_answer())["text"] for _ in range(MAX_ORDERS)] == ["at last"] * MAX_ORDERS

    asyncio.run(run())


def test_a_viewer_sees_what_was_and_still_what_becomes_new():
    async def run():
        state = state_with_a_map()
        async with served(state) as address:
            guest = await Guest.at(address)
            await guest.say(past=3.0)  # nobody has told the time, so there is no past
            assert (await guest.hear_past()).moment == (None, 3.0)
            state.put("a", "time", 100.0)
            while not (was := await asked_for_past(guest, 50.0)).anew:
                pass
            assert was.robots["a"].values["pose"] == [1.0, 2.0, 0.0] and not was.tiles
            await guest.say(maps=[["a", "local"]])
            state.put("a", "pose", [3.0, 2.0, 0.0])
            was = await asked_for_past(guest, 50.0)
            assert len(was.tiles) == 4 and was.robots["a"].values["pose"] == [1.0, 2.0, 0.0]
            state.put("a", "x", 1)
            while "x" not in (await guest.hear()).robots.get("a", Changes()).values:
                pass

    asyncio.run(run())


async def asked_for_past(guest, time):
    await guest.say(past=time)
    return await guest.hear_past()


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "{}", '{"maps": 3}', '{"maps": [[1, 2, 3]]}', '{"robot": "a"}', '{"past": "x"}', '{"past": NaN}'],
)
def test_who_sends_nonsense_is_closed_and_nobody_else(text):
    async def run():
        state = state_with_a_map()
        async with served(state) as address:
            good, bad = await Guest.at(address), await Guest.at(address)
            await bad.say_raw(text)
            while await bad.hear() is not None:
                pass
            assert bad.close_code == 1007
            await good.hear()
            state.put("a", "x", 1)
            assert (await good.hear()).robots["a"].values == {"x": 1}

    asyncio.run(run())


def test_there_is_an_end_of_viewers():
    async def run():
        async with served(state_with_a_map()) as address:
            guests = [await Guest.at(address) for _ in range(MAX_VIEWERS)]
            late = await Guest.at(address)
            assert await late.hear() is None and late.close_code == 1013
            guests[0].close()
            while await guests[0].hear() is not None:
                pass
            again = await Guest.at(address)
            assert await again.hear() is not None

    asyncio.run(run())


def test_other_sites_are_turned_away():
    async def run():
        async with served(state_with_a_map()) as address:
            for headers in ({"Host": "evil.example:8088"}, {"Origin": "http://evil.example"}):
                with pytest.raises(HTTPClientError) as error:
                    await Guest.at(address, **headers)
                assert error.value.code == 403
            with pytest.raises(HTTPClientError):
                await fetch(address, Host="evil.example")

    asyncio.run(run())


@pytest.mark.parametrize(
    ("host", "own"),
    [
        ("localhost:8088", True), ("127.0.0.1:8088", True), ("[::1]:8088", True), ("192.168.1.7", True),
        (socket.gethostname(), True), ("evil.example", False), ("evil.example:8088", False), ("", False),
    ],
)  # fmt: skip
def test_own_names(host, own):
    assert is_own_name(host) is own


def test_a_port_that_others_have_is_named():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(OSError, match=f"no page at 127.0.0.1, port {port}: .* give another port"):
            listening_sockets(port, "127.0.0.1")
