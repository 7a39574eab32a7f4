"""What a number is compared with: its exact value, and what the reference at finer steps shows of the scheme."""

import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from multibody_xval.scenarios.catalogue.scenario import Exact, Number, Quantity, given, largest
from multibody_xval.scenarios.model import EXACT, REFERENCE, AnyCase, Config, Result, Run, Status
from multibody_xval.scenarios.ruler.exact_values import LADDER
from multibody_xval.scenarios.store import Stored
from reference_lcp.steady.richardson import ROUND_OFF, richardson

CLOSED_FORM = "closed form"

DONE = (Status.PERIODIC, Status.FINISHED)


class Known(NamedTuple):
    """What is known of a quantity at a case and a number of steps."""

    exact: Number = math.nan
    bar: float = math.nan
    kind: str = ""
    scheme_error: float = math.nan
    reference: Number = math.nan
    """Of the scheme itself with these steps."""
    over: float = 1.0
    """What a number is given over."""

    def over_exact(self) -> "Known":
        """Give all over the exact value."""
        unit: Any = self.exact
        size = abs(unit)
        return Known(unit / unit, self.bar / size, self.kind, self.scheme_error / size, self.reference / unit, unit)


class Ruler:
    """What is known of quantities, from stored results of the reference and the exact motion."""

    def __init__(self, stored: Iterable[Stored]):
        self._by_case: dict[tuple[Config, AnyCase], dict[int, Result]] = defaultdict(dict)
        for run, _, result in stored:
            if run.config in (REFERENCE, EXACT) and result.status in DONE:
                self._by_case[run.config, run.case][run.steps] = result
        self._cached = cache(self._known)

    def known(self, quantity: Quantity, run: Run) -> Known:
        """Give what is known of a quantity at the case and the steps of a run."""
        return self._cached(quantity, run if quantity.step_error is not None else replace(run, config=REFERENCE))

    def exact(self, case: AnyCase) -> tuple[Run, Result] | None:
        """Give the exact motion of a case."""
        found = self._by_case[EXACT, case]
        return next(((Run(EXACT, case, steps), result) for steps, result in found.items()), None)

    def ladder(self, run: Run) -> dict[int, Result]:
        """Give the reference at the steps of a run and at finer ones; nothing where one is missing."""
        found = self._by_case[REFERENCE, run.case]
        wanted = [run.steps * factor for factor in LADDER]
        return {steps: found[steps] for steps in wanted} if all(steps in found for steps in wanted) else {}

    def _known(self, quantity: Quantity, run: Run) -> Known:
        known = self._as_read(quantity, run)
        return known.over_exact() if quantity.over_exact else known

    def _as_read(self, quantity: Quantity, run: Run) -> Known:
        if quantity.step_error is not None:
            return Known(*self._exact_value(quantity, run.case), given(quantity.step_error, run))
        assert quantity.read is not None, "it is read alone"
        ladder = self.ladder(run)
        counts = list(ladder)
        values = [quantity.read(own, Run(REFERENCE, run.case, steps)) for steps, own in ladder.items()]
        if not values:
            return Known()
        first, last = (richardson(counts, np.array(values), at=counts[place]) for place in (0, -1))
        scheme = largest(first.error), values[0]
        if quantity.exact is Exact.LADDER:
            extrapolated = last.extrapolated if np.ndim(last.extrapolated) else float(last.extrapolated)
            return Known(extrapolated, largest(last.error), str(Exact.LADDER), *scheme)
        return Known(*self._exact_value(quantity, run.case), *scheme)

    def _exact_value(self, quantity: Quantity, case: AnyCase) -> tuple[Number, float, str]:
        """Give the exact value, its bar and its kind, of a closed form or of the exact motion."""
        if not isinstance(quantity.exact, Exact):
            return given(quantity.exact, case), given(quantity.bar, case), CLOSED_FORM
        assert quantity.exact is Exact.MOTION, "a step's error in closed form needs no ladder"
        assert quantity.read is not None, "it is read alone"
        motion = self.exact(case)
        if motion is None:
            return math.nan, math.nan, ""
        return quantity.read(motion[1], motion[0]), ROUND_OFF * quantity.per_amplitude, str(Exact.MOTION)
