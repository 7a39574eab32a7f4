"""Sweeps: their files, their runs, and their results as labelled arrays."""
