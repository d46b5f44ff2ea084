"""A headless Chromium, driven over the DevTools protocol, for tests, measurements and pictures of pages."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import os
import re
import shutil
import signal
import tempfile
from pathlib import Path
from typing import Any, AsyncIterator

from tornado.websocket import WebSocketClientConnection, websocket_connect

PROGRAMS = ("chromium-headless-shell", "chromium")
OPTIONS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run", "--remote-debugging-port=0",
    "--disable-dev-shm-usage", "--disable-background-networking", "--disable-component-update",
)  # fmt: skip
PATIENCE = 15.0  # s for anything


class BrowserError(RuntimeError):
    """What a browser could not do; the text says why."""


def program() -> str | None:
    """Path of the browser, None if there is none."""
    return next((found for found in map(shutil.which, PROGRAMS) if found), None)


@contextlib.asynccontextmanager
async def browser() -> AsyncIterator[Browser]:
    """A browser with a profile of its own, which goes with it."""
    path = program()
    if path is None:
        raise BrowserError("no headless Chromium: run tools/install_dependencies browser")
    with tempfile.TemporaryDirectory(prefix="mr_page-", ignore_cleanup_errors=True) as profile:
        process = await asyncio.create_subprocess_exec(
            path, *OPTIONS, f"--user-data-dir={profile}", stderr=asyncio.subprocess.PIPE, start_new_session=True
        )
        try:
            connection = await websocket_connect(await _address(process), max_message_size=1 << 28)
            yield Browser(connection)
            connection.close()
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)  # it has processes of its own
            await process.wait()


async def _address(process: asyncio.subprocess.Process) -> str:
    """Where the browser is driven."""
    assert process.stderr is not None
    told = b""
    with contextlib.suppress(asyncio.TimeoutError):
        while line := await asyncio.wait_for(process.stderr.readline(), PATIENCE):
            told += line
            found = re.search(rb"DevTools listening on (ws://\S+)", line)
            if found:
                return found[1].decode()
    raise BrowserError(f"the browser does not start: {told.decode(errors='replace').strip()[-500:]}")


class Browser:
    """One connection for all tabs."""

    def __init__(self, connection: WebSocketClientConnection) -> None:
        self._connection = connection
        self._number = 0
        self._answers: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self._tabs: dict[str, Tab] = {}
        self._reader = asyncio.ensure_future(self._read())

    async def open(
        self, url: str, width: int = 1280, height: int = 800, dark: bool = False, mobile: bool = False
    ) -> Tab:
        """A new tab with a page, loaded. Sizes in pixels of the style sheet."""
        target = await self.call("Target.createTarget", {"url": "about:blank"})
        attached = await self.call("Target.attachToTarget", {"targetId": target["targetId"], "flatten": True})
        tab = self._tabs[attached["sessionId"]] = Tab(self, attached["sessionId"])
        for domain in ("Page", "Runtime", "Log", "Network"):
            await tab.call(f"{domain}.enable")
        size = {"width": width, "height": height, "deviceScaleFactor": 2 if mobile else 1, "mobile": mobile}
        await tab.call("Emulation.setDeviceMetricsOverride", size)
        scheme = {"features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]}
        await tab.call("Emulation.setEmulatedMedia", scheme)
        await tab.call("Page.navigate", {"url": url})
        await tab.wait_for("document.readyState === 'complete' && location.href !== 'about:blank'")
        return tab

    async def call(self, method: str, parameters: dict[str, Any] | None = None, session: str = "") -> dict[str, Any]:
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters or {}}
        if session:
            message["sessionId"] = session
        answer = self._answers[self._number] = asyncio.get_running_loop().create_future()
        await self._connection.write_message(json.dumps(message))
        told = await asyncio.wait_for(answer, PATIENCE)
        if "error" in told:
            raise BrowserError(f"{method}: {told['error']['message']}")
        return dict(told["result"])

    async def _read(self) -> None:
        while (text := await self._connection.read_message()) is not None:
            message = json.loads(text)
            if "id" in message:
                answer = self._answers.pop(message["id"], None)
                if answer is not None and not answer.done():
                    answer.set_result(message)
            elif message.get("sessionId") in self._tabs:
                self._tabs[message["sessionId"]].heard(message["method"], message["params"])


class Tab:
    """One page. `errors`: what it threw and what the browser refused; `received`: octets over web sockets, as sent."""

    def __init__(self, browser: Browser, session: str) -> None:
        self.errors: list[str] = []
        self._browser = browser
        self._session = session

    async def call(self, method: str, parameters: dict[str, Any] | None = None) -> dict[str, Any]:
        return await self._browser.call(method, parameters, self._session)

    async def run(self, script: str) -> Any:
        """Value of an expression of JavaScript, plain JSON. BrowserError when it throws."""
        told = await self.call("Runtime.evaluate", {"expression": script, "returnByValue": True, "awaitPromise": True})
        if "exceptionDetails" in told:
            details = told["exceptionDetails"]
            raise BrowserError(f"{script}: {details.get('exception', {}).get('description', details['text'])}")
        return told["result"].get("value")

    async def wait_for(self, condition: str) -> None:
        """Until an expression of JavaScript is true. BrowserError after PATIENCE."""
        end = asyncio.get_running_loop().time() + PATIENCE
        while not await self.run(f"Boolean({condition})"):
            if asyncio.get_running_loop().time() > end:
                raise BrowserError(f"not so within {PATIENCE:.0f} s: {condition}; errors: {self.errors}")
            await asyncio.sleep(0.02)

    async def point_at(self, selector: str) -> tuple[float, float]:
        """The mouse goes to the middle of an element, which is scrolled into view; where that is, pixels."""
        x, y = await self.run(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)}); "
            "e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect(); "
            "return [b.left + b.width / 2, b.top + b.height / 2]; })()"
        )
        await self.call("Input.dispatchMouseEvent", {"type": "mouseMoved", "x": x, "y": y})
        return x, y

    async def click(self, selector: str) -> None:
        """A real click in the middle of an element, which is scrolled into view."""
        x, y = await self.point_at(selector)
        for kind in ("mousePressed", "mouseReleased"):
            event = {"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1}
            await self.call("Input.dispatchMouseEvent", event)

    async def press(self, key: str) -> None:
        """A key, by its name or what it writes, where the focus is."""
        text = {"text": "\r" if key == "Enter" else key} if key == "Enter" or len(key) == 1 else {}
        for kind in ("keyDown", "keyUp"):
            await self.call("Input.dispatchKeyEvent", {"type": kind, "key": key, **(text if kind == "keyDown" else {})})

    async def picture(self, path: Path, whole: bool = False) -> None:
        """PNG of what is to be seen, or of the whole page, as a file."""
        path.write_bytes(await self.png(whole))

    async def png(self, whole: bool = False) -> bytes:
        """PNG of what is to be seen, or of the whole page."""
        told = await self.call("Page.captureScreenshot", {"format": "png", "captureBeyondViewport": whole})
        return base64.b64decode(told["data"])

    def heard(self, method: str, parameters: dict[str, Any]) -> None:
        if method == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.errors.append(f"{parameters['entry']['text']} {parameters['entry'].get('url', '')}")
