"""Benchmarks of missions."""
