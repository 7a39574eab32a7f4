"""Steady states: fixed points of the period map."""
