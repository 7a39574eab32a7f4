"""Sweeps over any parameters."""
