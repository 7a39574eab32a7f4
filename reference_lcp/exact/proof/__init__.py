"""Proofs of steady states in ball arithmetic: that there is one, that it is the only one, digits of what it gives."""
