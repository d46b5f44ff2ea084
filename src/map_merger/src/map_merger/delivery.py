"""Carrying out a Send: which payload is next, and what is reported at the end."""

from typing import List, Optional, Protocol, Sequence

from .effects import Send
from .messages import Tile
from .payload import Payload


class Sender(Protocol):
    """Who wanted the Send."""

    def on_sent(
        self, send: Send, delivered: bool, now: float, too_large: Optional[Tile], undelivered: Sequence[Payload]
    ) -> None:
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
        sender.on_sent(self.send, not self._undelivered, now, self._too_large, self._undelivered)

    def _proceed(self) -> None:
        self._index += 1
        self.next = self.send.payloads[self._index] if self._index < len(self.send.payloads) else None
