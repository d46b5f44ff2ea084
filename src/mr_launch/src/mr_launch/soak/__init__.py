"""Missions one after the other, with all that goes wrong in the field, and what is left afterwards."""
