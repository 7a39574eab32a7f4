"""The chain, what drives it, its states and trajectories, and its linear response."""
