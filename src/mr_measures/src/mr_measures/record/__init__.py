"""The record of a mission."""
