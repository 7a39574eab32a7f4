"""Motion without a time step, and closed forms."""
