"""``rosrun mr_page bench_page``: what the page of a team of eight on 2000 x 2000 cells takes, in a real browser.

The feeds come from a synthetic team that has explored most of the floor; the page's server is a process of its own.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import sys
from pathlib import Path
from typing import Any, AsyncIterator, Mapping, Sequence

from mr_page.browser import BrowserError, Tab, browser
from mr_page.played_team import PlayedTeam, played_team

OPENED = 5  # times that the page is opened
SETTLED = 3.0  # s after which the first maps are past
AT_MOST, AT_LEAST = "<=", ">="
Row = dict[str, Any]


class Counter:
    """Passes connections on to the server and counts the octets to the browser."""

    def __init__(self) -> None:
        self.octets = 0

    @contextlib.asynccontextmanager
    async def before(self, port: int) -> AsyncIterator[int]:
        """Gives the port at which it stands."""

        async def connected(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            from_server, to_server = await asyncio.open_connection("127.0.0.1", port)
            await asyncio.gather(self._pass(reader, to_server, False), self._pass(from_server, writer, True))

        server = await asyncio.start_server(connected, "127.0.0.1", 0)
        try:
            yield int(server.sockets[0].getsockname()[1])
        finally:
            server.close()

    async def _pass(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, counted: bool) -> None:
        with contextlib.suppress(ConnectionError):
            while data := await reader.read(1 << 16):
                self.octets += len(data) if counted else 0
                writer.write(data)
                await writer.drain()
        writer.close()


async def paints(port: int) -> list[tuple[float, float]]:
    """Times in s from the call of the page to its first paint, and until all maps in view are there."""
    found = []
    for _ in range(OPENED):
        async with browser() as one:
            tab = await one.open(f"http://localhost:{port}/")
            await tab.wait_for("window.page.mapsAt")
            paint = await tab.run("performance.getEntriesByName('first-contentful-paint')[0].startTime")
            found.append((0.001 * paint, 0.001 * await tab.run("window.page.mapsAt")))
    return found


async def steady(team: PlayedTeam, seconds: float, view: str) -> dict[str, float]:
    """Updates a second, share of a core, kbit/s after the first map, with one viewer of a view."""
    counter = Counter()
    async with counter.before(team.port) as port, browser() as one:
        tab = await one.open(f"http://localhost:{port}/")
        await tab.wait_for("window.page.mapsAt")
        await choose_view(tab, view)
        await asyncio.sleep(SETTLED)
        octets, updates, spent = counter.octets, await tab.run("window.page.updates"), team.server_seconds()
        await asyncio.sleep(seconds)
        return {
            "updates": (await tab.run("window.page.updates") - updates) / seconds,
            "cpu": 100.0 * (team.server_seconds() - spent) / seconds,
            "kbit": 0.008 * (counter.octets - octets) / seconds,
        }


async def choose_view(tab: Tab, name: str) -> None:
    """The map of a robot, or of the team with an empty name."""
    await tab.run(
        f"(() => {{ const s = document.getElementById('view'); s.value = {json.dumps(name)};"
        " s.dispatchEvent(new Event('change')); })()"
    )


async def measured(seconds: float) -> list[Row]:
    with played_team() as team:
        opened = await paints(team.port)
        views = {name: await steady(team, seconds, value) for name, value in (("team", ""), ("robot", "robot_2"))}
    return rows_of(opened, views, seconds)


def rows_of(
    opened: Sequence[tuple[float, float]], views: Mapping[str, Mapping[str, float]], seconds: float
) -> list[Row]:
    """Of what `paints` found, and `steady` for each view."""
    first, maps = max(paint for paint, _ in opened), max(at for _, at in opened)
    how = f"{seconds:g} s, 8 robots on 2000 x 2000 cells, one viewer of the "
    rows = [_row("first paint", AT_MOST, 1.0, first, "s", f"longest of {OPENED}; all maps in view after {maps:.2f} s")]
    for view, got in views.items():
        detail = f"{how}{view}"
        rows += [
            _row(f"updates, {view}", AT_LEAST, 5.0, got["updates"], "Hz", detail),
            _row(f"server, {view}", AT_MOST, 10.0, got["cpu"], "% of a core", detail),
            _row(f"transfer, {view}", AT_MOST, 300.0, got["kbit"], "kbit/s", f"{detail}, after the maps"),
        ]
    return rows


def _row(what: str, sense: str, bar: float, value: float, unit: str, detail: str) -> Row:
    """As those of the other benchmarks, for `rosrun mr_experiments publish bench`."""
    holds = value <= bar if sense == AT_MOST else value >= bar
    shown = {"bar": f"{sense} {bar:g}", "value": round(value, 2)}
    return {"what": f"status page: {what}", **shown, "unit": unit, "holds": holds, "detail": detail}


def main() -> int:
    parser = argparse.ArgumentParser(prog="bench_page", description="What the status page of a team takes.")
    parser.add_argument("--seconds", type=float, default=30.0, help="of each measurement (default: %(default)s)")
    parser.add_argument("--out", default="", metavar="FILE", help="JSON file for the rows")
    options = parser.parse_args()
    try:
        rows = asyncio.run(measured(options.seconds))
    except BrowserError as error:
        print(f"bench_page: {error}", file=sys.stderr)
        return 2
    for row in rows:
        mark = "ok  " if row["holds"] else "MISS"
        print(f"{mark} {row['what']:32} {row['value']:8.2f} {row['unit']:12} bar {row['bar']}: {row['detail']}")
    if options.out:
        Path(options.out).write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    return 0 if all(row["holds"] for row in rows) else 1
