"""Studies over many points: figure 3, its band and map, accuracy, work and precision, cost."""

COST_SECONDS = 2.0
"""Length of a measurement of cost with one worker that is aimed at unless one is given."""
