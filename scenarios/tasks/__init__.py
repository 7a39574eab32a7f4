"""What is asked and what came out, as data."""
