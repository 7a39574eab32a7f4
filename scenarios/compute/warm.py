"""Imported by the process from which workers are forked: kernels are compiled, or read, once for all of them."""

from multibody_xval.scenarios.compute.steady import steady_states
from multibody_xval.scenarios.model import REFERENCE, Case, Run
from reference_lcp.steady.neighbours import beside_euler

STEPS = 16
"""Fewest that are allowed."""

_CASE = Case(friction_ratio=0.3, frequency_ratio=0.9)
steady_states([Run(REFERENCE, _CASE, STEPS)])
beside_euler(REFERENCE.build([_CASE.lane(STEPS)]), STEPS, tolerance=1e-8, max_periods=1)
