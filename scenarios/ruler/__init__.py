"""The one ruler: exact values of steady states, and how far a number may be from them."""
