"""Recorded missions: found, exported to MCAP, played back."""
