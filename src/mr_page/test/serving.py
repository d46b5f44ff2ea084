"""A server of a page on a free port of this computer, for tests."""

import asyncio
import contextlib
import json

from tornado.httpclient import HTTPRequest
from tornado.netutil import bind_sockets
from tornado.websocket import websocket_connect

from mr_page.commands import Answer
from mr_page.server import PageServer
from mr_page.update import decoded

PATIENCE = 5.0  # s


async def unasked(robot, order):
    return Answer(True, f"{order.command} of {robot}")


@contextlib.asynccontextmanager
async def served(state, command=unasked, title="a page"):
    """Gives the address, host and port."""
    sockets = bind_sockets(0, "127.0.0.1")
    server = PageServer(state, title, command)
    server.add_sockets(sockets)
    try:
        yield f"127.0.0.1:{sockets[0].getsockname()[1]}"
    finally:
        server.close()


class Guest:
    """A viewer without a browser."""

    def __init__(self, connection):
        self._connection = connection

    @classmethod
    async def at(cls, address, **headers):
        request = HTTPRequest(f"ws://{address}/live", headers=headers)
        return cls(await websocket_connect(request, compression_options={}))

    async def say(self, **request):
        await self._connection.write_message(json.dumps(request))

    async def say_raw(self, text):
        await self._connection.write_message(text)

    async def hear(self):
        """The next update, or answer as a dictionary; None when the connection is closed."""
        message = await asyncio.wait_for(self._connection.read_message(), PATIENCE)
        if message is None:
            return None
        return json.loads(message) if isinstance(message, str) else decoded(message)

    async def hear_past(self):
        while (message := await self.hear()).moment is None:
            pass
        return message

    async def hear_answer(self):
        while not isinstance(message := await self.hear(), dict):
            assert message is not None
        return message

    @property
    def close_code(self):
        return self._connection.close_code

    def close(self):
        self._connection.close()
