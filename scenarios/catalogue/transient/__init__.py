"""Motions that do not repeat: one scenario a file, and what they share."""
