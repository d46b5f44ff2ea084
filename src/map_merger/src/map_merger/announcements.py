"""Short messages to the own group: one of each purpose at a time, the next when it has ended."""

from typing import Optional, Set

from .effects import GROUP_PREFIX, Purpose, Send
from .payload import Payload


class Announcements:
    """Owns what of it is under way. A message that comes while one of its purpose is under way is dropped: a newer one
    follows."""

    def __init__(self, robot: str) -> None:
        self._group = GROUP_PREFIX + robot
        self._number = 0
        self._outstanding: Set[Purpose] = set()

    def free(self, purpose: Purpose) -> bool:
        """True if nothing of the purpose is under way."""
        return purpose not in self._outstanding

    def send(self, purpose: Purpose, payload: Payload) -> Optional[Send]:
        """The Send for the host; None if one of the purpose is under way."""
        if not self.free(purpose):
            return None
        self._number += 1
        self._outstanding.add(purpose)
        return Send(self._number, purpose, self._group, (payload,))

    def ended(self, send: Send) -> bool:
        """The host finished a Send; True if it was one of these."""
        if send.purpose not in self._outstanding:
            return False
        self._outstanding.discard(send.purpose)
        return True
