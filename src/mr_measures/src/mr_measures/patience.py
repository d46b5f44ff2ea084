"""How long a mission goes on once its figures stand."""

HOME_PATIENCE = 600.0
"""s of the mission from the end of exploration until all robots must be at rest. The way home alone takes 170 s on a
floor of 60 m x 60 m."""
