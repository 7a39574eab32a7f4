"""Cards: what a maintainer would quote of one engine."""
