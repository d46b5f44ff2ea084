"""Carrying out a Send: which payload is next, what is reported at the end, and who takes a payload that arrived."""

from typing import Any, List, Optional, Protocol

from .effects import Outcome, Send
from .graph.edges import EdgeReport
from .meetings.values import TrackReport
from .messages import Anchor, Position, Request, Tile
from .payload import Payload

_METHODS = {
    Tile: "on_tile",
    Anchor: "on_anchor",
    Request: "on_request",
    Position: "on_position",
    TrackReport: "on_track",
    EdgeReport: "on_edges",
}


def take(receiver: Any, payload: Payload, now: float) -> None:
    """Hands a payload to the agent, or other owner, that received it. TypeError for a kind that it does not take."""
    method = getattr(receiver, _METHODS.get(type(payload), ""), None)
    if method is None:
        raise TypeError(f"{type(receiver).__name__} cannot take {type(payload).__name__}")
    method(payload, now)


class Sender(Protocol):
    """Who wanted the Send."""

    def on_sent(self, send: Send, outcome: Outcome, now: float) -> None:
        """The host finished the Send."""


class Delivery:
    """A host delivers `next` until that is None, tells each time how it `ended`, and then lets it `report`."""

    def __init__(self, send: Send) -> None:
        self.send = send
        self.next: Optional[Payload] = None
        self._index = -1
        self._undelivered: List[Payload] = []
        self._too_large: Optional[Tile] = None
        self._proceed()

    def ended(self, delivered: bool, too_large: bool = False) -> None:
        """Whether `next` was delivered; `too_large`: it was refused for its size."""
        payload = self.send.payloads[self._index]
        if not delivered and self.send.to_group:
            self._undelivered.append(payload)
        elif not delivered:
            self._undelivered.extend(self.send.payloads[self._index :])
            self._index = len(self.send.payloads)
        if too_large and self._too_large is None and isinstance(payload, Tile):
            self._too_large = payload
        self._proceed()

    def report(self, sender: Sender, now: float) -> None:
        """Tells the sender, at its end, what has become of the Send."""
        sender.on_sent(self.send, Outcome(tuple(self._undelivered), self._too_large), now)

    def _proceed(self) -> None:
        self._index += 1
        self.next = self.send.payloads[self._index] if self._index < len(self.send.payloads) else None
