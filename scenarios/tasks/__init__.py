"""Tasks and their results, as data."""
