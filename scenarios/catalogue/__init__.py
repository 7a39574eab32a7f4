"""Named experiments, one a file."""
