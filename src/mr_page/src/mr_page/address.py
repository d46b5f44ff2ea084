"""Where a page is served, if nobody says another place."""

PORT = 8088
ADDRESS = "localhost"
