"""The page of eight robots on 2000 x 2000 cells in a real browser: it is clicked through."""

import asyncio
import json
import os
import re

import pytest
from serving import served

from mr_page.browser import browser, program
from mr_page.commands import ORDERS, Answer, Order
from mr_page.played_team import played_team
from mr_page.state import PageState

if program() is None and not os.environ.get("REQUIRE_BROWSER"):
    pytest.skip("no headless Chromium: run tools/install_dependencies browser", allow_module_level=True)

# Share of the map's canvas on which something is drawn.
DRAWN = """(() => { const c = document.getElementById('map'); let drawn = 0;
  const data = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
  for (let i = 3; i < data.length; i += 4) if (data[i]) drawn++;
  return 4 * drawn / data.length; })()"""


@pytest.fixture(scope="module")
def team():
    with played_team(explored=300.0) as played:
        yield played


def text(selector):
    return f"document.querySelector('{selector}').textContent"


def test_the_page_is_clicked_through(team):
    async def run():
        async with browser() as one:
            tab = await one.open(f"http://localhost:{team.port}/", 1300, 850)
            await tab.wait_for("window.page.mapsAt && document.querySelectorAll('#robots tr').length === 8")
            await tab.wait_for(f"{DRAWN} > 0.3")
            await tab.wait_for(f"{text('#status')} === 'exploring'")
            await views(tab)
            await panels(tab)
            await auctions(tab)
            await orders(tab)
            await limits(tab)
            await orders_by_radio(tab)
            await the_past(tab)
            await looks(tab)
            assert tab.errors == []

    asyncio.run(run())


async def views(tab):
    """Until somebody chooses the map is a merged one, of a robot that has placed all that can be placed."""
    await tab.wait_for(f"{text('#source')}.endsWith('saw of it; not placed: robot_7')")
    first = await tab.run("document.getElementById('view').value")
    assert first in [f"robot_{number}" for number in range(7)]
    row = int(first[-1]) + 1
    await tab.click(f"#robots tr:nth-child({row})")  # chooses it, and does not lead away from it
    await tab.wait_for(f"document.querySelector('#commands select').value === '{first}'")
    assert await tab.run("document.getElementById('view').value") == first
    await tab.click(f"#robots tr:nth-child({row})")
    await tab.wait_for(f"{text('#source')}.includes('own maps')")
    await tab.click("#robots tr:nth-child(3)")
    # Where the others' maps lie comes with its own message, on a busy machine after the map.
    await tab.wait_for(f"{text('#source')}.startsWith('The map of robot_2')")
    await tab.wait_for(f"{text('#source')}.includes('not placed: robot_7')")
    await tab.click("#robots tr:nth-child(3)")
    await tab.wait_for(f"{text('#source')}.includes('own maps')")


async def panels(tab):
    shown = "[...document.querySelectorAll('#panels > *')].find((e) => !e.hidden).textContent"
    for name, part in (
        ("choices", "the lowest of 4 clusters"), ("places", "not placed: no wall in common yet"),
        ("radio", "mc_robot_3"), ("log", "robot_0 placed robot_1"), ("area", "Known area"),
    ):  # fmt: skip
        await tab.click(f"#tab-{name}")
        await tab.wait_for(f"({shown}).includes('{part}')")


LINES = "[...document.querySelectorAll('.auctions details')]"
TIMES = f"{LINES}.map((e) => e.querySelector('time').textContent.split(':').reduce((m, s) => 60 * m + +s))"


async def auctions(tab):
    """The newest of the team, those of one robot, and a line unfolded."""
    await tab.click("#tab-choices")
    await tab.wait_for(f"{LINES}.length === 50")
    times = await tab.run(TIMES)
    assert times == sorted(times, reverse=True) and times[0] > times[-1]
    await tab.click("#robots tr:nth-child(2)")
    await tab.wait_for(f"{LINES}.length > 5 && {LINES}.every((e) => e.querySelector('b').textContent === 'robot_1')")
    line = await tab.run(f"{LINES}[1].querySelector('summary').textContent")
    won = r"\(-?\d+\.\d, -?\d+\.\d\) at"
    assert re.fullmatch(rf"\d+:\d\drobot_1: robot_1 {won} 7\.2 · robot_2 {won} 3\.3 · 4 of 6 to nobody yet", line), line
    await tab.click(".auctions details:nth-child(2) summary")
    unfolded = "document.querySelector('.auctions details[open]')"
    await tab.wait_for(f"{unfolded}?.querySelector('table')")
    heads = await tab.run(f"[...{unfolded}.querySelectorAll('th')].map((e) => e.textContent)")
    assert heads == ["Cluster", "1", "0", *"234567"]
    row = "[r.cells[0].firstChild.title, ...[...r.cells].slice(1, 4).map((c) => c.innerHTML)]"
    rows = await tab.run(f"[...{unfolded}.querySelectorAll('tbody tr')].map((r) => {row})")
    none = "<span>\N{EN DASH}</span>"
    assert rows[:3] == [
        ["explored by robot_1", "<b>7.2</b>", none, "<span>9.1</span>"],
        ["explored by robot_2", "<span>12.4</span>", none, "<b>3.3</b>"],
        ["explored by nobody yet", "<span>20.5</span>", none, none],
    ]
    assert len(rows) == 6
    await tab.click(".auctions details[open] summary")
    await tab.click("#robots tr:nth-child(2)")


async def orders(tab):
    await tab.click("#robots tr:nth-child(1)")
    await tab.wait_for("document.querySelector('#commands select').value === 'robot_0'")
    await tab.click("#command-go_home")  # synthetic robot_0 has no such service
    assert await tab.run(text("#answer")) == "robot_0 offers no service explorer/go_home"
    await tab.click("#command-start")
    assert await tab.run(text("#answer")) == "robot_0 has begun already"
    await tab.click("#command-pause")
    await tab.wait_for(f"{text('#answer')} === 'robot_0: paused'")
    await tab.wait_for(f"{text('#robots tr:nth-child(1) td:nth-child(2)')} === 'paused'")
    await tab.click("#command-radio_off")  # there is no radio daemon here
    await tab.wait_for(f"{text('#answer')}.includes('radio daemon does not answer')")
    await address(tab, "team_robot_0")  # synthetic robot_0 passes orders on, to all only to pause
    await tab.click("#command-resume")
    assert await tab.run(text("#answer")) == "robot_0 offers no service mission_control/resume"
    await tab.click("#command-pause")
    await tab.wait_for(f"{text('#answer')} === 'robot_0: team_pause is not made up'")
    await tab.click("#robots tr:nth-child(1)")
    await tab.click("#robots tr:nth-child(1)")
    await tab.click("#command-resume")
    await tab.wait_for(f"{text('#robots tr:nth-child(1) td:nth-child(2)')} === 'exploring'")


async def limits(tab):
    """Of one robot, by the keyboard, then for all by the button; 0 and the arrows are keys of the page elsewhere."""
    await address(tab, "robot_1")
    assert await tab.run(f"[document.getElementById('limit-time').value, {text('#left')}]") == ["", ""]
    await write(tab, "#limit-time", "5000")
    await tab.press("Enter")
    await tab.wait_for(f"{text('#answer')} === 'robot_1: ends after 5000 s or 0 m'")
    await tab.wait_for(f"/^1:1\\d:\\d\\d left$/.test({text('#left')})")
    await address(tab, "")
    await tab.wait_for("document.getElementById('limit-time').value === ''")  # they have not all the same
    await write(tab, "#limit-way", "0900")
    await tab.click("#command-set_limits")
    await tab.wait_for(f"/^\\d+ m left$/.test({text('#left')})")
    await address(tab, "robot_1")
    await tab.wait_for("['time', 'way'].map((n) => document.getElementById(`limit-${n}`).value).join() === ',900'")
    await address(tab, "team_robot_0")
    await tab.click("#command-set_limits")
    assert await tab.run(text("#answer")) == "robot_0 offers no service mission_control/set_limits"
    await address(tab, "pass_on_robot_0 robot_1")  # by radio, so what is left is not known here
    await write(tab, "#limit-time", "700")
    await tab.press("Enter")
    await tab.wait_for(f"{text('#answer')} === 'robot_0: ends after 700 s or 0 m'")
    await address(tab, "robot_1")
    await tab.wait_for("document.getElementById('limit-time').value === '700'")


async def write(tab, selector, digits):
    await tab.click(selector)
    for digit in digits:
        await tab.press(digit)


async def address(tab, key):
    await tab.run(
        f"(() => {{ const s = document.querySelector('#commands select'); s.value = '{key}';"
        " s.dispatchEvent(new Event('change')); })()"
    )


async def orders_by_radio(tab):
    """To one robot, through another one."""
    groups = "[...document.querySelectorAll('#commands optgroup')].map((g) => [g.label, g.children.length])"
    assert await tab.run(groups) == [["by the radio of robot_0", 8]]
    await address(tab, "pass_on_robot_0 robot_4")
    await tab.click("#command-start")
    assert await tab.run(text("#answer")) == "robot_4 has begun already"
    await tab.click("#command-stop")
    assert await tab.run(text("#answer")) == "robot_0 offers no service mission_control/order"
    state = text("#robots tr:nth-child(5) td:nth-child(2)")
    for command, shown in (("pause", "paused"), ("resume", "exploring")):
        await tab.click(f"#command-{command}")
        await tab.wait_for(f"{text('#answer')} === 'robot_0: {command}: sent to robot_4'")
        await tab.wait_for(f"{state} === '{shown}'")
    await tab.click("#tab-log")
    await tab.wait_for(f"{text('#events')}.includes('robot_4: resume: done')")


async def the_past(tab):
    """Robot 3 drives; then it is seen where it was, while the mission goes on, and again where it is."""
    driven = "parseFloat(document.querySelector('#robots tr:nth-child(4) td:nth-child(3)').textContent)"
    time = f"{text('#clock')}.split(' / ')"
    assert (
        await tab.run(f"new Set({time}).size") == 1
        and await tab.run("document.getElementById('live').ariaPressed") == "true"
    )
    begin, then = await tab.run(f"[document.getElementById('slider').value, {driven}]")
    await tab.wait_for(f"{driven} > {then} + 3")
    slider = "const s = document.getElementById('slider');"
    await tab.click("#play")  # first: time that goes on may lead to the next moment that the server keeps
    await tab.run(f"(() => {{ {slider} s.value = {begin}; s.dispatchEvent(new Event('input')); }})()")
    await tab.wait_for(f"{text('#reason')}.includes('as it was at') && {driven} <= {then} && {DRAWN} > 0.3")
    await tab.click("#robots tr:nth-child(4)")
    await tab.wait_for(f"{text('#source')}.startsWith('The map of robot_3') && {DRAWN} > 0.3")
    was = await tab.run(f"[{driven}, {text('#reason')}, {time}[1]]")
    await tab.wait_for(f"{time}[1] !== '{was[2]}'")
    assert await tab.run(f"[{driven}, {text('#reason')}]") == was[:2]
    await tab.click("#robots tr:nth-child(4)")
    await tab.click("#command-pause")  # orders are for what is happening
    await tab.click("#live")
    await tab.wait_for(f"{driven} > {then} + 3 && !{text('#reason')}.includes('as it was')")
    await tab.click("#command-resume")
    await tab.run("document.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft' }))")
    await tab.wait_for(f"{text('#reason')}.includes('as it was at')")
    await tab.click("#speeds button:nth-child(3)")  # twenty seconds in one: soon there again
    await tab.wait_for(f"!{text('#reason')}.includes('as it was')")


async def looks(tab):
    """Layers, zoom and theme change the picture."""
    await tab.click("#theme")
    assert await tab.run("document.documentElement.dataset.theme") == "dark"
    before = await tab.run(text("#scale"))
    for _ in range(3):
        await tab.click("#closer")
    await tab.wait_for(f"{text('#scale')} !== '{before}'")
    await tab.click("#fit")
    await tab.wait_for(f"{text('#scale')} === '{before}'")
    for box in await tab.run("[...document.querySelectorAll('#layers label:not([hidden])')].map((e, i) => i)"):
        await tab.run(f"document.querySelectorAll('#layers label:not([hidden]) input')[{box}].click()")
    await tab.wait_for(f"{DRAWN} < 0.05")


# Boxes of tables that are wider than they may be: their last columns are cut.
CUT = """[...document.querySelectorAll('#tablebox, #panels > div:not([hidden])')]
  .filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.textContent)"""


def test_on_a_small_screen_tables_are_whole(team):
    async def run():
        async with browser() as one:
            tab = await one.open(f"http://localhost:{team.port}/", 1280, 800)
            await tab.wait_for("window.page.mapsAt && document.querySelectorAll('#robots tr').length === 8")
            await tab.click("#tab-radio")
            await tab.wait_for("document.getElementById('panels').textContent.includes('Waiting')")
            assert await tab.run(CUT) == []

    asyncio.run(run())


@pytest.mark.parametrize("dark", [False, True])
def test_a_phone_shows_everything_in_its_width(team, dark):
    async def run():
        async with browser() as one:
            tab = await one.open(f"http://localhost:{team.port}/", 390, 844, dark=dark, mobile=True)
            await tab.wait_for("window.page.mapsAt && document.querySelectorAll('#robots tr').length === 8")
            for name in ("area", "choices", "places", "radio", "log"):
                await tab.click(f"#tab-{name}")
                assert await tab.run("document.documentElement.scrollWidth") <= 390, name
                assert await tab.run(CUT) == [], name
            ends = "['map', 'source'].map((id) => document.getElementById(id).getBoundingClientRect())"
            assert await tab.run(f"(([map, source]) => source.top >= map.bottom - 1)({ends})")
            assert await tab.run("document.documentElement.dataset.theme") == ("dark" if dark else "light")
            assert tab.errors == []

    asyncio.run(run())


PICTURE = "document.getElementById('map').toDataURL()"


def test_an_auction_is_to_be_seen_on_the_map_while_somebody_points_at_it():
    """Or once it is unfolded, as long as it is in the list; new ones come on top of it, and fold nothing."""
    state = PageState()
    for name, x in (("anna", 0.0), ("bob", 3.0)):
        state.put(name, "about", {"start": [x, 0.0, 0.0]})
        state.put(name, "time", 70.0)
        state.put(name, "pose", [1.0, 1.0, 0.0])
        state.put(name, "decision", {"area": 5.0})
        state.append(name, "auctions", [5.0 + x, 1, 1, [[2.0, x, {"anna": 4.0, "bob": 2.5}, "bob"]]])

    async def run():
        async with served(state) as address, browser() as one:
            tab = await one.open(f"http://{address}/", 1300, 850)
            await tab.wait_for("document.querySelectorAll('#robots tr').length === 2")
            await tab.click("#tab-choices")
            await tab.wait_for(f"{LINES}.length === 2")
            assert await tab.run(f"{LINES}.map((e) => e.querySelector('summary').textContent)") == [
                "0:08bob: bob (2.0, 3.0) at 2.5 m²", "0:05anna: bob (2.0, 0.0) at 2.5 m²"
            ]  # fmt: skip
            plain = json.dumps(await tab.run(PICTURE))
            await tab.point_at(".auctions details:nth-child(1)")
            await tab.wait_for(f"{PICTURE} !== {plain}")
            pointed = json.dumps(await tab.run(PICTURE))
            await tab.point_at(".auctions details:nth-child(2)")
            await tab.wait_for(f"![{plain}, {pointed}].includes({PICTURE})")
            await tab.point_at("h1")
            await tab.wait_for(f"{PICTURE} === {plain}")
            await tab.click(".auctions summary")
            await tab.point_at("h1")
            await tab.wait_for(f"{PICTURE} === {pointed}")
            await tab.click("#tab-area")
            await tab.wait_for(f"{PICTURE} === {plain}")
            await tab.click("#tab-choices")
            for number in range(2, 80):
                state.append("anna", "auctions", [70.0 + number, number, 1, [[2.0, 0.0, {"anna": 4.0}, ""]]])
                if number == 3:
                    await tab.wait_for(f"{LINES}.length === 4")
                    assert await tab.run(f"{LINES}.map((e) => e.open)") == [False, False, True, False]
            await tab.wait_for(f"{LINES}.length === 50 && {LINES}[0].textContent.startsWith('2:29')")
            assert await tab.run(f"{LINES}.map((e) => e.querySelector('time').textContent).join()") == ",".join(
                f"{at // 60}:{at % 60:02}" for at in range(149, 99, -1)
            )
            await tab.wait_for(f"{PICTURE} === {plain}")
            assert tab.errors == []

    asyncio.run(run())


def test_a_base_station_orders_one_robot_by_its_radio():
    """Of the others it knows what they have told over the radio."""
    heard = {"state": "exploring", "text": "drives to a frontier", "merging": "", "area": 90, "in_reach": True,
             "age": 0, "order": "", "answered": True, "answer": "", "number": 0}  # fmt: skip
    state, asked = PageState(), []
    state.put("base", "about", {"base": True, "start": None})
    state.put("base", "time", 5.0)
    state.put("base", "services", {f"{way}{order}": True for way in ("team_", "pass_on_") for order in ORDERS})
    away = {**heard, "in_reach": False}
    state.put("base", "team", {"text": "", "robots": {"anna": heard, "bob": away}})

    async def command(robot, order):
        asked.append((robot, order))
        return Answer(False, "pause: no robot is in reach; bob get it when they are back")

    async def run():
        async with served(state, command) as address, browser() as one:
            tab = await one.open(f"http://{address}/", 1300, 850)
            await tab.wait_for("document.querySelectorAll('#robots tr').length === 3")
            await tab.click("#robots tr:nth-child(3)")
            await tab.wait_for("document.querySelector('#commands select').value === 'pass_on_base bob'")
            await tab.click("#command-start")
            assert await tab.run(text("#answer")) == "bob has begun already"
            await tab.click("#command-pause")
            await tab.wait_for(f"{text('#answer')}.includes('get it when they are back')")
            assert tab.errors == []

    asyncio.run(run())
    assert asked == [("base", Order("pass_on_pause", "bob"))]


def test_orders_that_a_robot_would_refuse_are_grey_and_no_others():
    """Once called back it could not be resumed here, not paused while it waited, not sent home once it was stopped."""
    state = PageState()
    state.put("anna", "about", {"start": None})
    state.put("anna", "services", {order: True for order in ORDERS})
    able = "[...document.querySelectorAll('#commands button[aria-disabled=false]')].map((b) => b.id.slice(8)).join()"

    async def run():
        async with served(state) as address, browser() as one:
            tab = await one.open(f"http://{address}/", 1300, 850)
            for stage, words, orders in (
                ("starting", "waits for the start", "start,pause,return_now,stop,go_home"),
                ("starting", "is paused, waits for the start", "start,resume,return_now,stop,go_home"),
                ("starting", "is called back, waits for the start", "start,pause,resume,stop,go_home"),
                ("exploring", "drives to (1.0, 2.0)", "pause,return_now,stop,go_home"),
                ("returning", "is called back, drives home", "pause,resume,stop,go_home"),
                ("waiting", "is called back, at home", "pause,resume,stop,go_home"),
                ("returning", "sent home, drives home", "pause,stop"),
                ("finished", "stopped", "go_home"),
                ("finished", "sent home, at home", ""),
            ):
                over = words.startswith(("sent home", "stopped"))
                told = {"state": stage, "text": words, "finished": over, "frontiers": 3, "clusters": 1}
                state.put("anna", "state", told)
                await tab.wait_for(f"{text('#reason')}.includes('{words}') && {able} === '{orders}'")
            assert tab.errors == []

    asyncio.run(run())


def test_grey_radio_buttons_switch_no_radio():
    """For all robots at once they are grey."""
    state, asked = PageState(), []
    for name in ("anna", "bob"):
        state.put(name, "about", {"start": None})
        state.put(name, "switchable", True)

    async def command(robot, order):
        asked.append((robot, order))
        return Answer(True, "off")

    async def run():
        async with served(state, command) as address, browser() as one:
            tab = await one.open(f"http://{address}/", 1300, 850)
            await tab.wait_for("document.querySelectorAll('#robots tr').length === 2")
            assert await tab.run("document.querySelector('#commands select').value") == ""
            for button in ("radio_off", "radio_on"):
                assert await tab.run(f"document.getElementById('command-{button}').ariaDisabled") == "true"
                await tab.click(f"#command-{button}")
                assert await tab.run(text("#answer")) == "choose a robot first"
            await tab.click("#robots tr:nth-child(2)")
            await tab.click("#command-radio_off")
            await tab.wait_for(f"{text('#answer')} === 'bob: off'")
            assert tab.errors == []

    asyncio.run(run())
    assert asked == [("bob", Order("radio_off"))]


def test_a_paused_team_is_not_told_when_it_will_be_done():
    state = PageState()
    state.put("anna", "about", {"start": None})
    state.put(
        "anna", "state", {"state": "waiting", "text": "is paused", "finished": False, "frontiers": 3, "clusters": 1}
    )
    state.put("anna", "decision", {"paused": True, "rest": 60.0, "area": 5.0})

    async def run():
        async with served(state) as address, browser() as one:
            tab = await one.open(f"http://{address}/", 1300, 850)
            await tab.wait_for(f"{text('#status')} === 'paused' && {text('#reason')} === 'is paused'")
            buttons = "[...document.querySelectorAll('button')].map((b) => b.textContent)"
            assert sum("Pause" in name for name in await tab.run(buttons)) == 1, "that of the robots"
            state.put("anna", "decision", {"paused": False, "rest": 60.0, "area": 5.0})
            await tab.wait_for(f"{text('#reason')}.startsWith('about 1:00 left')")
            assert tab.errors == []

    asyncio.run(run())


def test_before_the_first_answer_the_page_is_connecting():
    """The badge says that there is no connection only after a try."""

    async def run():
        async with served(PageState()) as address, browser() as one:
            tab = await one.open("data:text/html,nothing", 1300, 850)
            await tab.call("Page.enable")
            wait = "window.sockets = []; window.WebSocket = class { close() {} constructor() { sockets.push(this); } }"
            await tab.call("Page.addScriptToEvaluateOnNewDocument", {"source": wait})
            await tab.call("Page.navigate", {"url": f"http://{address}/"})
            await tab.wait_for(f"document.getElementById('status') && {text('#status')} === 'connecting'")
            await tab.run("window.sockets[0].onclose()")
            await tab.wait_for(f"{text('#status')} === 'no connection'")

    asyncio.run(run())


def test_orders_without_a_connection_are_said_not_to_be_sent():
    """The link goes dead: the server says nothing more, and the browser does not see it."""
    state, asked = PageState(), []
    state.put("anna", "about", {"start": None})
    state.put("anna", "state", {"state": "exploring"})
    state.put("anna", "services", {"pause": True})

    async def command(robot, order):
        asked.append(robot)
        await asyncio.sleep(60.0)

    async def run():
        async with served(state, command) as address, browser() as one:
            tab = await one.open("data:text/html,nothing", 1300, 850)
            await tab.call("Page.enable")
            kept = "window.sockets = []; window.WebSocket = class extends WebSocket {"
            kept += " constructor(place) { super(place); window.sockets.push(this); } }"
            await tab.call("Page.addScriptToEvaluateOnNewDocument", {"source": kept})
            await tab.call("Page.navigate", {"url": f"http://{address}/"})
            await tab.wait_for("document.querySelectorAll('#robots tr').length === 1")
            await tab.click("#command-pause")
            await tab.run("window.sockets[0].onmessage = null")
            await tab.wait_for(f"{text('#status')} === 'no connection'")
            assert await tab.run(text("#answer")) == "no connection: Pause may not have arrived"
            await tab.click("#command-pause")
            assert await tab.run(text("#answer")) == "no connection: Pause was not sent"
            await tab.wait_for(f"window.sockets.length === 2 && {text('#status')} === 'exploring'")
            assert tab.errors == []

    asyncio.run(run())
    assert asked == ["anna"]
