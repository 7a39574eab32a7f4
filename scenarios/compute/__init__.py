"""How results are computed: what is in this folder, with an engine's own, decides the numbers that are stored."""

SECONDS_A_RUN = 60.0
"""Time limit of a run; that of a batch is as many times longer as it has runs."""
