"""Sweeps over any parameters."""

UNCONFIRMED_POINTS = 1_000_000
"""Most points of a sweep that runs without a yes: about a quarter of an hour, and 2 GB in its store."""
