"""Exchange of map changes: numbered updates, tiles counted from an anchor, and repair of what was lost."""

from .exchange import Exchange
from .peer_map import PeerMap
from .retry import Retry
from .sender import MapSender

__all__ = ["Exchange", "MapSender", "PeerMap", "Retry"]
