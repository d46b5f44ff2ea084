"""Everything that robots send to one another."""

from typing import Union

from .graph.edges import EdgeReport
from .meetings.values import TrackReport
from .messages import Anchor, Position, Request, Tile

Payload = Union[Anchor, Tile, Request, Position, TrackReport, EdgeReport]
