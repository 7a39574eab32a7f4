"""Steady states under a harmonic base motion: one scenario a file, and what they share."""
