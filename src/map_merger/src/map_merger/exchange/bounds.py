"""Every bound of the exchange, and what happens beyond it."""

MOST_ROBOTS = 64
"""Other robots; further ones are ignored with a warning."""
MOST_STORED_CELLS = 40_000_000
"""Cells of the maps of all other robots together (200 MB); what goes beyond is not taken."""
MOST_MAP_CELLS = 8_000_000
"""Cells of the known region of one map (140 m x 140 m of 0.05 m); larger ones are not exchanged."""
MOST_WAITING_CELLS = 2_000_000
"""Cells of the tiles of one robot that wait for their anchor; the oldest are dropped."""
MOST_WAITING_TILES = 512
"""Tiles of one robot that wait for their anchor; the oldest are dropped."""
LONGEST_WAIT_S = 10.0
"""Tiles of a run other than the present one are dropped after this time. A robot that announces no anchor for so long
is taken for one that never does."""
MOST_FORMER_RUNS = 32
"""Former runs of a robot that are remembered; the oldest are forgotten."""
CLAIMS, CLAIM_S = 3, 10.0
"""A former run is the present one again when so many anchors of it and nothing else came, over at least this time."""

MOST_BOXES = 4096
"""Updates whose region is remembered; older ones are answered with everything."""
MOST_TILES = 512
"""Tiles in one go; the tile edge is doubled until they suffice, unless that is too large to be sent."""
SMALLEST_TILE = 16
"""Tiles are not halved below this edge in cells."""
MOST_RESENT = 100
"""Undelivered updates that are repeated to the group; of older ones the others have to ask, as their anchor shows."""
MOST_REQUESTED = 200
"""Numbers in one request; with more gaps everything is asked for."""
HIGHEST_NUMBER = 10_000_000
"""Larger update numbers can only be garbage."""
ANSWER_TRIES = 5
"""An answer ends when one of its payloads failed so often; the other robot has to ask again."""

HELD_S = 4.0
"""Changes are told this long after the last ones."""
MARGINAL_CELLS, MARGINAL_HELD_S = 50, 8.0
"""Fewer changed cells wait for more, so long at most."""
GROWN_SHARE = 0.3
"""Changes of such a share of the map are told at once."""
ANCHOR_REST, LONGEST_ANCHOR_REST = 2, 6
"""An anchor is not announced within so many periods after changes, which count the updates as well; but so many after
the last one."""

FULL_MAP_MARGIN = 5
"""Cells around the known region in the answer to a full request (contract 2.4)."""
REPAIR_PERIOD_S = 1.0
"""Gaps are looked for this often."""
FIRST_PAUSE_S, LONGEST_REQUEST_PAUSE_S, LONGEST_RESEND_PAUSE_S = 1.0, 30.0, 60.0
"""Pauses between requests to a robot that does not answer, and between repeated sends to the group, double up to
these."""
STEADY_REQUESTS = 4
"""So many requests follow one another with the first pause, since one of them may get lost."""
