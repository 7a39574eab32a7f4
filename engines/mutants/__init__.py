"""Engines that are wrong on purpose, each in one thing and by a number: what the suite should find out."""
