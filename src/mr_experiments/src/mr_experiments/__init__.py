"""Missions in virtual time: trials, records, reports."""
