"""How long measurements take."""

COST_SECONDS = 2.0
"""Length of a measurement of cost with one worker that is aimed at unless one is given."""
