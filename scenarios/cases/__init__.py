"""Cases that are run: chains in ratios, motions from a state, scenes."""
