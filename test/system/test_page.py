"""The status page of a running team in a real browser: what it shows comes from the robots' nodes, and a radio that is
switched off there carries no frames until it is switched on again."""

import asyncio
import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Iterator

import pytest

from mr_launch.programs import free_ports
from mr_launch.soak.running import RunningMission
from mr_page.browser import Tab, browser, program

if program() is None and not os.environ.get("REQUIRE_BROWSER"):
    pytest.skip("no headless Chromium: run tools/install_dependencies browser", allow_module_level=True)

READY_S, SILENCE_S = 120.0, 2.0
(PORT,) = free_ports(1)
TEAM = ("--world", "small8x8", "--robots", "2", "--page", str(PORT), "--no-bag", "--rtf", "0.5", "--duration", "300")
# Share of the map's canvas on which something is drawn.
DRAWN = """(() => { const c = document.getElementById('map'); let drawn = 0;
  const data = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
  for (let i = 3; i < data.length; i += 4) if (data[i]) drawn++;
  return 4 * drawn / data.length; })()"""


@pytest.fixture
def team(tmp_path: Path) -> Iterator[RunningMission]:
    """That explores."""
    out, log = tmp_path / "out", tmp_path / "log"
    with log.open("wb") as output:
        process = subprocess.Popen(
            ["rosrun", "mr_launch", "team", *TEAM, "--out", str(out)], stdin=subprocess.DEVNULL, stdout=output,
            stderr=subprocess.STDOUT,
        )  # fmt: skip
    try:
        end = time.monotonic() + READY_S
        while "\nexploring" not in log.read_text(errors="replace"):
            assert process.poll() is None and time.monotonic() < end, log.read_text(errors="replace")
            time.sleep(0.1)
        yield RunningMission(process, out)
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(60)


def text(selector: str) -> str:
    return f"document.querySelector('{selector}').textContent"


def test_the_page_shows_the_team_and_switches_a_radio_off(team: RunningMission) -> None:
    async def run() -> None:
        async with browser() as one:
            tab = await one.open(f"http://localhost:{PORT}/", 1300, 850)
            await tab.wait_for("window.page.mapsAt && document.querySelectorAll('#robots tr').length === 2")
            await tab.wait_for(f"{text('#status')} === 'exploring'")
            await tab.wait_for(f"{DRAWN} > 0.1")
            await radio(tab, team)
            await pause(tab)
            assert tab.errors == []

    asyncio.run(run())


async def radio(tab: Tab, team: RunningMission) -> None:
    """Of robot_1."""
    await tab.click("#robots tr:nth-child(2)")
    await tab.wait_for("document.querySelector('#commands select').value === 'robot_1'")
    assert await heard(team), "it has a radio at first"
    await tab.click("#command-radio_off")
    await tab.wait_for(f"{text('#answer')} === 'robot_1: radio of robot_1 off'")
    assert not await heard(team)
    await tab.click("#command-radio_on")
    await tab.wait_for(f"{text('#answer')} === 'robot_1: radio of robot_1 on'")
    assert await heard(team)


async def heard(team: RunningMission) -> int:
    """Frames of robot_1 that robot_0 gets in a while; those that are in the air now are over."""
    await asyncio.sleep(0.2)
    before = team.delivered("robot_1")
    await asyncio.sleep(SILENCE_S)
    return team.delivered("robot_1") - before


async def pause(tab: Tab) -> None:
    """By the service of the robot's own explorer."""
    await tab.click("#command-pause")
    await tab.wait_for(f"{text('#answer')} === 'robot_1: paused'")
    await tab.wait_for(f"{text('#robots tr:nth-child(2) td:nth-child(2)')} === 'paused'")
