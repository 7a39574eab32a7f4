"""When the search for a steady state ends, unless other numbers are given."""

DEFAULT_RESIDUAL = 1e-8
"""Periodicity residual at which an orbit counts as found."""

DEFAULT_PERIODS = 400
"""Periods after which the search gives up."""

EXACT_RESIDUAL = 1e-11
"""Periodicity residual of an exact steady state, some hundred times what the event-driven period map can resolve."""
